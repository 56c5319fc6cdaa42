#pragma once

#include "dynamics/dynamics.h"
#include "systems/player.h"
#include "systems/spawn.h"

#include "lockwind/player_input.h"
#include "lockwind/result.h"
#include "lockwind/slot_input.h"
#include "lockwind/world_definition.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// A ball that met another player's pod.
struct Goal {
    Slot by;     // whose ball it was
    Slot victim; // whose pod it met
    BodyRow ball;
};

/// Players' pods: pushed along their own +z (its shadow on the ground, so a tilted pod pushes
/// less), steered about y, kept upright, jumping off what supports them, shooting balls along +z.
///
/// Holds what follows from the definition, and scratch; all that changes lies in the tables.
class PodSystem {
public:
    /// The Error names the pod's slot and what is wrong. `body_capacity` sizes the scratch.
    static Result<PodSystem> create(const WorldDefinition& definition,
                                    const ShapeLibrary& shapes,
                                    std::uint32_t body_capacity);

    /// Rows of section "player" as a match begins.
    std::vector<Player> initial_players() const;

    /// Rows of the pods that there are, in slot order; until the next call.
    std::span<const BodyRow> rows(const DynamicsTables& tables, const Table<Player>& players);

    /// Phase apply_inputs: changes the pods' velocities, cooldowns and intents to shoot.
    void apply_inputs(const DynamicsTables& tables,
                      const Table<Player>& players,
                      std::span<const SlotInput> inputs);

    /// Queues the balls of the players that are shooting, from where their pods are now.
    void spawn_balls(const DynamicsTables& tables,
                     const Table<Player>& players,
                     std::uint64_t seed,
                     Tick tick,
                     Spawner& spawner) const;

private:
    struct Parameters {
        BodyId body;
        Real thrust; // m/s a tick at full stick
        Real speed_max;
        Real turn_rate; // rad/s at full stick
        Real jump_speed;
        Real ball_speed;
        std::uint32_t cooldown_ticks;
        std::uint32_t lifetime_ticks;
        BodyRecord ball;   // at the origin, at rest, without an id
        RealQuat to_given; // from the body's principal axes to the frame that its +z is of
    };

    PodSystem() = default;
    void mark_supported(const DynamicsTables& tables);
    void drive(const Parameters& pod, const PlayerInput& input, BodyMotion& motion) const;
    void balance(const Parameters& pod,
                 const PlayerInput& input,
                 Real gyration_radius,
                 BodyMotion& motion) const;

    std::vector<Parameters> pods_;        // by slot
    std::vector<BodyRow> rows_;           // scratch of rows()
    std::vector<std::uint8_t> supported_; // by row: something holds the body up
    Real tick_seconds_;
};

/// The slot whose pod that body is; kNoIndex for none.
Slot slot_of(const Table<Player>& players, BodyId body);

/// Whether the hit is a ball of one player on the pod of another.
bool is_goal(const DynamicsTables& tables,
             const Table<Player>& players,
             const ContactHit& hit,
             Goal& goal);

} // namespace lockwind
