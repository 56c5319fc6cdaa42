#include "session/request.h"

namespace lockwind {

Delivery delivery_of(const Message& message) {
    const bool best_effort = std::holds_alternative<InputBatch>(message) ||
                             std::holds_alternative<Confirmation>(message);
    return best_effort ? Delivery::best_effort : Delivery::reliable;
}

std::string_view to_string(SessionEventKind kind) {
    switch (kind) {
    case SessionEventKind::synchronizing:
        return "synchronizing";
    case SessionEventKind::synchronized:
        return "synchronized";
    case SessionEventKind::started:
        return "started";
    case SessionEventKind::joined:
        return "joined";
    case SessionEventKind::reconnected:
        return "reconnected";
    case SessionEventKind::interrupted:
        return "interrupted";
    case SessionEventKind::resumed:
        return "resumed";
    case SessionEventKind::dropped:
        return "dropped";
    case SessionEventKind::left:
        return "left";
    case SessionEventKind::stalled:
        return "stalled";
    case SessionEventKind::paused:
        return "paused";
    case SessionEventKind::unpaused:
        return "unpaused";
    case SessionEventKind::desync_detected:
        return "desync_detected";
    case SessionEventKind::ended:
        return "ended";
    }
    return "unknown";
}

std::string_view to_string(EndReason reason) {
    switch (reason) {
    case EndReason::complete:
        return "complete";
    case EndReason::desync:
        return "desync";
    case EndReason::stopped:
        return "stopped";
    case EndReason::left:
        return "left";
    case EndReason::failed:
        return "failed";
    case EndReason::dropped:
        return "dropped";
    }
    return "unknown";
}

std::string_view to_string(RefuseReason reason) {
    switch (reason) {
    case RefuseReason::protocol_version:
        return "protocol_version";
    case RefuseReason::sim_version:
        return "sim_version";
    case RefuseReason::config:
        return "config";
    case RefuseReason::match_full:
        return "match_full";
    case RefuseReason::token_in_use:
        return "token_in_use";
    case RefuseReason::match_over:
        return "match_over";
    case RefuseReason::misconduct:
        return "misconduct";
    }
    return "unknown";
}

} // namespace lockwind
