#include "measured_world.h"

#include "bench_scene.h"
#include "dynamics/body.h"
#include "dynamics/contact.h"

#include "lockwind/player_input.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace lockwind::bench {
namespace {

std::uint32_t section_index(std::string_view name) {
    const StateSchema schema = World::schema();
    for (std::uint32_t index = 0; index < schema.size(); ++index) {
        if (schema[index].name == name) {
            return index;
        }
    }
    give_up("no section " + std::string(name));
}

using Vector = std::array<double, 3>;

/// Where a point of the body's principal frame, Q9.22 m, stands in the world.
Vector world_point(const BodyMotion& body, const std::int32_t local[3]) {
    const double scale = static_cast<double>(Length(1).raw());
    const Vector p{local[0] / scale, local[1] / scale, local[2] / scale};
    const auto unit = [&](int index) {
        return body.orientation[index] / static_cast<double>(Unit(1).raw());
    };
    const auto place = [&](int axis) {
        return static_cast<double>(body.position[axis]) / static_cast<double>(Real(1).raw());
    };
    const double x = unit(0);
    const double y = unit(1);
    const double z = unit(2);
    const double w = unit(3);
    // p + 2 w (q x p) + 2 q x (q x p)
    const Vector t{2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])};
    return {place(0) + p[0] + w * t[0] + y * t[2] - z * t[1],
            place(1) + p[1] + w * t[1] + z * t[0] - x * t[2],
            place(2) + p[2] + w * t[2] + x * t[1] - y * t[0]};
}

/// Now, m: as it was when the manifold was made, and how far its two anchors have drifted since.
double separation(World& world, const Manifold& manifold, std::uint32_t point) {
    const std::span<const std::byte> bodies = world.section_bytes(section_index("body"));
    const auto motion = [&](BodyRow row) {
        BodyMotion body{};
        std::memcpy(&body, bodies.data() + row * sizeof body, sizeof body);
        return body;
    };
    const Vector a = world_point(motion(manifold.row_a), manifold.local_a + 3 * point);
    const Vector b = world_point(motion(manifold.row_b), manifold.local_b + 3 * point);
    double drift = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        drift += (b[axis] - a[axis]) * manifold.normal[axis] / static_cast<double>(Unit(1).raw());
    }
    return manifold.separation[point] / static_cast<double>(Length(1).raw()) + drift;
}

} // namespace

MeasuredWorld::MeasuredWorld(const WorldDefinition& definition, Simd simd) {
    auto created = WorldSimulation::create(definition, simd);
    if (!created) {
        give_up(created.error().message);
    }
    simulation_ = std::move(created).value();
    PlayerInput input;
    input.thrust = 32767;
    input.turn = 8000;
    input.buttons = PlayerInput::kShoot;
    inputs_.resize(simulation_->slot_count());
    for (SlotInput& slot : inputs_) {
        encode(input, slot);
        slot.status = InputStatus::confirmed;
    }
}

void MeasuredWorld::step() {
    const Status status = simulation_->advance(inputs_);
    if (!status && error_.empty()) {
        error_ = status.error().message;
    }
}

void MeasuredWorld::run(std::uint32_t steps) {
    for (std::uint32_t step = 0; step < steps; ++step) {
        this->step();
    }
}

std::uint32_t MeasuredWorld::contact_count() const {
    return simulation_->world().counts().contacts;
}

std::uint32_t MeasuredWorld::awake_count() const {
    return simulation_->world().counts().awake;
}

double MeasuredWorld::penetration_mm() const {
    World& world = simulation_->world();
    const std::span<const std::byte> bytes = world.section_bytes(section_index("manifold"));
    double lowest = 0;
    for (std::size_t at = 0; at + sizeof(Manifold) <= bytes.size(); at += sizeof(Manifold)) {
        Manifold manifold{};
        std::memcpy(&manifold, bytes.data() + at, sizeof manifold);
        for (std::uint32_t point = 0; point < manifold.point_count; ++point) {
            lowest = std::min(lowest, separation(world, manifold, point));
        }
    }
    return 0.0 - 1000.0 * lowest;
}

std::string MeasuredWorld::hash_text() const {
    char text[17];
    std::snprintf(
        text, sizeof text, "%016llx", static_cast<unsigned long long>(simulation_->state_hash()));
    return text;
}

} // namespace lockwind::bench
