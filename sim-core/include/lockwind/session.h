#pragma once

// Sessions: pure state machines that play a match over any Simulation. See src/session/README.md.
#include "session/blob_transfer.h"
#include "session/histogram.h"
#include "session/lockstep_client.h"
#include "session/lockstep_server.h"
#include "session/match_config.h"
#include "session/messages.h"
#include "session/request.h"
#include "session/state_history.h"
#include "session/sync_test.h"
#include "session/violation.h"
