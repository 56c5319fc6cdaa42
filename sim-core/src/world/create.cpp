#include "dynamics/make_body.h"
#include "dynamics/make_joint.h"
#include "systems/motion.h"
#include "systems/pod.h"
#include "world/definition.h"
#include "world/impl.h"

#include <algorithm>
#include <array>

namespace lockwind {

namespace {

/// One creation by the API, or for each pod a ball and the pod's own return.
std::uint32_t creations_max(std::size_t pods) {
    return static_cast<std::uint32_t>(std::max<std::size_t>(1, 2 * pods));
}

/// A pair changes once and hits once a tick; a body is created or destroyed once, wakes once and
/// falls asleep once, and a ball scores once; a joint breaks once.
std::size_t events_max(const DynamicsSettings& capacities) {
    return std::size_t{3} * capacities.pair_capacity + std::size_t{5} * capacities.body_capacity +
           capacities.joint_capacity;
}

std::array<std::uint32_t, section::kCount> capacities_of(const DynamicsSettings& capacities,
                                                         std::size_t pods) {
    std::array<std::uint32_t, section::kCount> rows{};
    rows[section::kArena] = 1;
    rows[section::kGlobals] = 1;
    rows[section::kBody] = capacities.body_capacity;
    rows[section::kBodyKind] = capacities.body_capacity;
    rows[section::kBodyLife] = capacities.body_capacity;
    rows[section::kBodySleep] = capacities.body_capacity;
    rows[section::kPair] = capacities.pair_capacity;
    rows[section::kManifold] = capacities.manifold_capacity;
    rows[section::kContactImpulse] = capacities.manifold_capacity;
    rows[section::kJoint] = capacities.joint_capacity;
    rows[section::kPlayer] = static_cast<std::uint32_t>(pods);
    return rows;
}

Status make_bodies(const WorldDefinition& definition,
                   const ShapeLibrary& shapes,
                   std::span<const Player> players,
                   const DynamicsTables& tables,
                   Spawner& spawner) {
    std::vector<const BodyDefinition*> sorted;
    for (const BodyDefinition& body : definition.bodies) {
        sorted.push_back(&body);
    }
    std::sort(sorted.begin(), sorted.end(), [](const BodyDefinition* a, const BodyDefinition* b) {
        return a->id < b->id;
    });
    tables.motion.set_count(static_cast<std::uint32_t>(sorted.size()));
    tables.lives.set_count(static_cast<std::uint32_t>(sorted.size()));
    tables.sleep.set_count(static_cast<std::uint32_t>(sorted.size()));
    spawner.begin_kinds();
    for (BodyRow row = 0; row < sorted.size(); ++row) {
        BodyProperties properties{};
        if (Status made = make_body(
                *sorted[row], definition.settings, shapes, tables.motion[row], properties);
            !made) {
            return made;
        }
        const bool is_pod = std::any_of(players.begin(), players.end(), [&](const Player& player) {
            return player.body == sorted[row]->id;
        });
        if (is_pod) {
            properties.can_sleep = 0; // its player may move at any tick
        }
        spawner.give_kind(tables, row, properties);
    }
    return Success{};
}

Status make_joints(const WorldDefinition& definition,
                   const ShapeLibrary& shapes,
                   const DynamicsTables& tables) {
    std::vector<const JointDefinition*> sorted;
    for (const JointDefinition& joint : definition.joints) {
        sorted.push_back(&joint);
    }
    std::sort(sorted.begin(), sorted.end(), [](const JointDefinition* a, const JointDefinition* b) {
        return a->id < b->id;
    });
    tables.joints.set_count(static_cast<std::uint32_t>(sorted.size()));
    for (std::uint32_t row = 0; row < sorted.size(); ++row) {
        const JointDefinition& joint = *sorted[row];
        if (Status made = make_joint(joint,
                                     tables,
                                     shapes,
                                     row_of(tables.motion, joint.body_a),
                                     row_of(tables.motion, joint.body_b),
                                     tables.joints[row]);
            !made) {
            return made;
        }
    }
    return Success{};
}

} // namespace

World::Impl::Impl(const WorldDefinition& definition,
                  const DynamicsSettings& dynamics_capacities,
                  Simd simd,
                  ShapeLibrary library,
                  PodSystem pod_system)
    : settings(definition.settings), capacities(dynamics_capacities), shapes(std::move(library)),
      arena(kWorldSections, capacities_of(capacities, definition.pods.size())),
      staging(kWorldSections, capacities_of(capacities, definition.pods.size())), versions(arena),
      hasher(arena), dynamics(capacities, &shapes, simd), pods(std::move(pod_system)),
      spawner(capacities.body_capacity, creations_max(definition.pods.size())),
      events(events_max(capacities)), query_index(capacities.body_capacity) {}

DynamicsTables World::Impl::tables_of(StateArena& arena) {
    return {arena.table<BodyMotion>(section::kBody),
            arena.table<BodyProperties>(section::kBodyKind),
            arena.table<BodyLife>(section::kBodyLife),
            arena.table<BodySleep>(section::kBodySleep),
            arena.table<Pair>(section::kPair),
            arena.table<Manifold>(section::kManifold),
            arena.table<ContactImpulse>(section::kContactImpulse),
            arena.table<Joint>(section::kJoint)};
}

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

World::~World() = default;

Result<WorldPtr> World::create(const WorldDefinition& definition, Simd simd) {
    if (Status status = check_definition(definition); !status) {
        return status.error();
    }
    const DynamicsSettings capacities = dynamics_settings(definition);
    Result<ShapeLibrary> shapes = ShapeLibrary::create(
        {definition.hulls, definition.compounds, definition.height_fields, definition.meshes});
    if (!shapes) {
        return shapes.error();
    }
    Result<PodSystem> pods =
        PodSystem::create(definition, shapes.value(), capacities.body_capacity);
    if (!pods) {
        return pods.error();
    }
    auto impl = std::make_unique<Impl>(
        definition, capacities, simd, std::move(shapes).value(), std::move(pods).value());
    const DynamicsTables tables = impl->tables();
    const std::vector<Player> players = impl->pods.initial_players();
    if (Status status = make_bodies(definition, impl->shapes, players, tables, impl->spawner);
        !status) {
        return status.error();
    }
    if (Status status = make_joints(definition, impl->shapes, tables); !status) {
        return status.error();
    }
    impl->arena.set_row_count(section::kGlobals, 1);
    impl->globals().seed = definition.settings.seed;
    impl->players().set_count(static_cast<std::uint32_t>(players.size()));
    for (Slot slot = 0; slot < players.size(); ++slot) {
        impl->players()[slot] = players[slot];
        const BodyRow row = row_of(tables.motion, players[slot].body);
        BodyRecord start{tables.motion[row], tables.properties[row], {}};
        write_velocity({}, start.motion.linear_velocity);
        write_velocity({}, start.motion.angular_velocity);
        impl->pod_starts.push_back(start);
        impl->pod_ids.push_back(players[slot].body);
    }
    return WorldPtr(new World(std::move(impl)));
}

} // namespace lockwind
