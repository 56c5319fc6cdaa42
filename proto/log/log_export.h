#pragma once

#include "log/log_reader.h"

#include "lockwind/result.h"

#include <string>

namespace lockwind {

/// Writes the log's whole records to `to` as one plain protobuf message (log.proto's Log),
/// keyframes unpacked; record by record, so that any size will do. `to` must not exist.
Status export_log(const std::string& path, const std::string& to);

} // namespace lockwind
