#include "forensics/replay.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace lockwind {

std::string replay_json(const ReplayResult& result) {
    nlohmann::ordered_json json;
    json["ticks"] = result.ticks;
    json["hashes_checked"] = result.hashes_checked;
    json["first_bad_tick"] = nullptr;
    if (result.first_bad_tick) {
        json["first_bad_tick"] = *result.first_bad_tick;
    }
    json["state_hash"] = hash_text(result.state_hash);
    json["ended"] = to_text(result.ended);
    json["valid_bytes"] = result.valid_bytes;
    json["verified_to_tick"] = result.verified_to_tick;
    json["realtime_factor"] = std::round(result.realtime_factor * 100) / 100;
    json["hashes_wrong"] = result.hashes_wrong;
    if (result.first_bad_tick && result.failure.empty()) {
        json["expected_hash"] = hash_text(result.expected_hash);
        json["actual_hash"] = hash_text(result.actual_hash);
    }
    json["failure"] =
        result.failure.empty() ? nlohmann::json(nullptr) : nlohmann::json(result.failure);
    json["damage"] =
        result.damage.empty() ? nlohmann::json(nullptr) : nlohmann::json(result.damage);
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string replay_text(const ReplayResult& result) {
    const double factor = std::round(result.realtime_factor * 10) / 10;
    std::string text = "replayed to tick " + std::to_string(result.ticks) + ", state hash " +
                       hash_text(result.state_hash) + ", " + nlohmann::json(factor).dump() +
                       " times as fast as real time\n";
    if (!result.failure.empty()) {
        text += "FAILED: " + result.failure + "\n";
    } else if (result.first_bad_tick) {
        text += "FAILED: tick " + std::to_string(*result.first_bad_tick) + " has hash " +
                hash_text(result.actual_hash) + ", the log says " +
                hash_text(result.expected_hash) + "; " + std::to_string(result.hashes_wrong) +
                " wrong in all\n";
    }
    if (result.hashes_checked > 0) {
        text += "verified to tick " + std::to_string(result.verified_to_tick) + ": " +
                std::to_string(result.hashes_checked) + " hashes checked\n";
    }
    text += "the log ends as " + std::string(to_text(result.ended)) + ", " +
            std::to_string(result.valid_bytes) + " valid bytes\n";
    text += result.damage.empty() ? "" : "damaged " + result.damage + "\n";
    return text;
}

} // namespace lockwind
