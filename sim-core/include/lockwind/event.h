#pragma once

#include "lockwind/types.h"

#include <cstdint>

namespace lockwind {

enum class EventType : std::uint8_t {
    contact_begin = 0, // a < b; value 0
    contact_end = 1,   // a < b; value 0
    hit = 2,           // a < b; value: normal impulse / reduced mass, Q11.20 m/s, above 1 m/s
    created = 3,       // a: the new body, b: its spawner or 0
    destroyed = 4,     // a: the body, b: 0
    score = 5,         // a: the scoring pod, b: the pod that was hit; value: a's score
    respawned = 6,     // a: a pod put back at its start because it left the bounds, b: 0
    fell_asleep = 7,   // a: the body, b: 0
    woke = 8,          // a: the body, b: 0
    sensor_begin = 9,  // a < b, one of them a sensor; value 0
    sensor_end = 10,   // a < b; value 0
    joint_break = 11,  // a, b: the joint's bodies, a is 0 of a grab; value: the joint's id
};

/// Something that happened in a tick. A tick's events are ordered by (type, a, b, value).
struct Event {
    EventType type;
    BodyId a;
    BodyId b;
    std::int64_t value;

    bool operator==(const Event&) const = default;
};

} // namespace lockwind
