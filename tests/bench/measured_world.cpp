#include "measured_world.h"

#include "bench_scene.h"

#include "lockwind/player_input.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace lockwind::bench {
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
    double lowest = 0;
    for (const ContactView& contact : simulation_->world().contacts()) {
        for (std::uint32_t point = 0; point < contact.point_count; ++point) {
            lowest = std::min(lowest, static_cast<double>(contact.points[point].separation.raw()));
        }
    }
    return 0.0 - 1000.0 * lowest / static_cast<double>(Real(1).raw());
}

std::string MeasuredWorld::hash_text() const {
    char text[17];
    std::snprintf(
        text, sizeof text, "%016llx", static_cast<unsigned long long>(simulation_->state_hash()));
    return text;
}

} // namespace lockwind::bench
