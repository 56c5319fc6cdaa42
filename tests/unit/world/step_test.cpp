#include "tests/support/code_scenes.h"
#include "world/event_log.h"

#include "lockwind/hash_tree.h"
#include "lockwind/phase_observer.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tuple>
#include <vector>

namespace lockwind::test {
namespace {

TEST(WorldStep, FallsBySemiImplicitEuler) {
    WorldDefinition scene;
    scene.bodies.push_back(sphere(1, {0, 100, 0}, 0.5));
    const WorldPtr world = make_world(scene);
    step_idle(*world, 60);
    // n substeps of h: y = y0 - g h^2 n (n + 1) / 2; n = 240, h = 1/240.
    const double expected = 100 - 9.81 * 240 * 241 / 2 / (240.0 * 240.0);
    const BodyView body = *world->body(1);
    EXPECT_NEAR(to_double(body.position.y), expected, 1e-4);
    EXPECT_NEAR(to_double(body.linear_velocity.y), -9.81, 1e-4);
    EXPECT_EQ(world->tick(), 60U);
}

class PhaseList final : public PhaseObserver {
public:
    explicit PhaseList(const World& world) : world_(world) {}
    void after_phase(std::uint32_t phase) override {
        phases.push_back(phase);
        hashes.push_back(world_.state_hash());
        ticks.push_back(world_.tick());
        saved.emplace_back();
        world_.save(saved.back());
    }
    std::vector<std::uint32_t> phases;
    std::vector<std::uint64_t> hashes;
    std::vector<Tick> ticks;
    std::vector<std::vector<std::byte>> saved;

private:
    const World& world_;
};

TEST(WorldStep, RunsItsPhasesInOrder) {
    const std::vector<std::string_view> expected{"apply_inputs",
                                                 "broad_phase",
                                                 "narrow_phase",
                                                 "wake",
                                                 "solve",
                                                 "restitution",
                                                 "sleep",
                                                 "spawns_despawns",
                                                 "events",
                                                 "next_tick"};
    const auto phases = World::phases();
    EXPECT_EQ(std::vector(phases.begin(), phases.end()), expected);
    const WorldPtr world = make_world(busy_scene(10, 2));
    PhaseList observer(*world);
    ASSERT_TRUE(world->step(busy_inputs(1, 2), &observer).ok());
    EXPECT_EQ(observer.phases, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(observer.ticks, (std::vector<Tick>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1}));
    EXPECT_EQ(observer.hashes.back(), world->state_hash());
}

/// Notes the phases of some ticks that change the hash.
void note_changes(World& world, int ticks, std::vector<bool>& changed) {
    for (int tick = 0; tick < ticks; ++tick) {
        std::uint64_t hash = world.state_hash();
        PhaseList observer(world);
        ASSERT_TRUE(world.step(busy_inputs(world.tick() + 1, world.slot_count()), &observer).ok());
        for (std::size_t phase = 0; phase < changed.size(); ++phase) {
            changed[phase] = changed[phase] || observer.hashes[phase] != hash;
            hash = observer.hashes[phase];
        }
    }
}

TEST(WorldStep, EveryPhaseLeavesItsResultsInTheState) {
    std::vector<bool> changed(World::phases().size(), false);
    const WorldPtr world = make_world(busy_scene(30, 2));
    for (int tick = 0; tick < 90; ++tick) {
        step_busy(*world);
    }
    note_changes(*world, 60, changed);
    // A box that sleeps, and is woken.
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(box(2, {0, 0.5, 0}, {0.5, 0.5, 0.5}));
    const WorldPtr quiet = make_world(scene);
    note_changes(*quiet, 60, changed);
    ASSERT_TRUE(quiet->create_body(sphere(3, {0, 2, 0}, 0.5)).ok());
    note_changes(*quiet, 60, changed);
    for (std::size_t phase = 0; phase < changed.size(); ++phase) {
        EXPECT_TRUE(changed[phase]) << World::phases()[phase];
    }
}

TEST(WorldStep, StatesBetweenPhasesCanBeSavedAndLoaded) {
    const WorldPtr world = make_world(busy_scene(30, 2));
    for (int tick = 0; tick < 60; ++tick) {
        step_busy(*world);
    }
    PhaseList observer(*world);
    ASSERT_TRUE(world->step(busy_inputs(61, 2), &observer).ok());
    const WorldPtr other = make_world(busy_scene(30, 2));
    for (std::size_t phase = 0; phase < observer.saved.size(); ++phase) {
        const Status loaded = other->load(observer.saved[phase]);
        ASSERT_TRUE(loaded.ok()) << World::phases()[phase] << ": " << loaded.error().message;
        EXPECT_EQ(other->state_hash(), observer.hashes[phase]) << World::phases()[phase];
    }
}

TEST(WorldStep, EventsAreOrderedAndChained) {
    const WorldPtr world = make_world(busy_scene(60, 4));
    std::uint64_t chain = world->event_hash();
    std::uint64_t total = 0;
    std::vector<bool> seen(7, false);
    for (int tick = 0; tick < 400; ++tick) {
        step_busy(*world);
        const auto events = world->events();
        EXPECT_TRUE(
            std::is_sorted(events.begin(), events.end(), [](const Event& left, const Event& right) {
                return std::tie(left.type, left.a, left.b, left.value) <
                       std::tie(right.type, right.a, right.b, right.value);
            }));
        for (const Event& event : events) {
            chain = chain_event(chain, event);
            seen[static_cast<std::size_t>(event.type)] = true;
            if (event.type <= EventType::hit) {
                EXPECT_LT(event.a, event.b);
            }
            if (event.type == EventType::hit) {
                EXPECT_GT(event.value, std::int64_t{1} << 20U);
            }
        }
        total += events.size();
        ASSERT_EQ(world->event_hash(), chain);
    }
    EXPECT_EQ(world->counts().events_total, total);
    for (std::size_t type = 0; type <= 4; ++type) {
        EXPECT_TRUE(seen[type]) << "event type " << type << " never happened";
    }
}

TEST(WorldStep, AnEventsHashIsOfItsFiveWords) {
    const Event event{EventType::hit, 1, 2, -3};
    EXPECT_EQ(chain_event(7, event), chain_event(7, event));
    for (const Event& other : {Event{EventType::score, 1, 2, -3},
                               Event{EventType::hit, 3, 2, -3},
                               Event{EventType::hit, 1, 3, -3},
                               Event{EventType::hit, 1, 2, 3}}) {
        EXPECT_NE(chain_event(7, event), chain_event(7, other));
    }
    EXPECT_NE(chain_event(7, event), chain_event(8, event));
}

TEST(WorldStep, ABallThatLandsBeginsAContactAndHits) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(sphere(2, {0, 2, 0}, 0.5));
    scene.settings.sleep_seconds = 0;
    const WorldPtr world = make_world(scene);
    std::vector<Event> events;
    for (int tick = 0; tick < 120; ++tick) {
        step_idle(*world);
        events.insert(events.end(), world->events().begin(), world->events().end());
    }
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(events[0], (Event{EventType::contact_begin, 1, 2, 0}));
    EXPECT_EQ(events[1].type, EventType::hit);
    // It falls 1.5 m: 5.42 m/s.
    EXPECT_NEAR(static_cast<double>(events[1].value) / (1 << 20), 5.42, 0.3);
}

TEST(WorldStep, CountsWhatTouches) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(box(2, {0, 0.5, 0}, {0.5, 0.5, 0.5}));
    scene.bodies.push_back(sphere(3, {5, 3, 0}, 0.5));
    const WorldPtr world = make_world(scene);
    step_idle(*world, 10);
    const WorldCounts counts = world->counts();
    EXPECT_EQ(counts.bodies, 3U);
    EXPECT_EQ(counts.manifolds, 1U);
    EXPECT_EQ(counts.contacts, 4U);
    EXPECT_GE(counts.pairs, 2U);
}

TEST(WorldStep, DestroysBodiesThatLeaveTheBounds) {
    WorldDefinition scene;
    scene.settings.bounds = 10;
    scene.bodies.push_back(sphere(5, {0, -9, 0}, 0.5));
    scene.bodies.push_back(sphere(6, {0, 9, 0}, 0.5));
    const WorldPtr world = make_world(scene);
    step_idle(*world, 26); // g h^2 n (n + 1) / 2 passes 1 m at n = 108 substeps
    EXPECT_TRUE(world->body(5).has_value());
    step_idle(*world, 1);
    EXPECT_FALSE(world->body(5).has_value());
    EXPECT_TRUE(world->body(6).has_value());
    ASSERT_EQ(world->events().size(), 1U);
    EXPECT_EQ(world->events()[0], (Event{EventType::destroyed, 5, 0, 0}));
    EXPECT_EQ(world->counts().destroyed_total, 1U);
}

TEST(WorldStep, WrapsBodiesThatLeaveTheBounds) {
    WorldDefinition scene;
    scene.settings.bounds = 10;
    scene.settings.bounds_policy = BoundsPolicy::wrap;
    scene.settings.gravity = {0, 0, 0};
    scene.bodies.push_back(sphere(5, {9, 1, -9}, 0.5));
    scene.bodies[0].linear_velocity = {3, 0, -6};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 60);
    const BodyView body = *world->body(5);
    // 9 + 3 - 20 and -9 - 6 + 20
    EXPECT_NEAR(to_double(body.position.x), -8, 1e-5);
    EXPECT_NEAR(to_double(body.position.y), 1, 1e-5);
    EXPECT_NEAR(to_double(body.position.z), 5, 1e-5);
    EXPECT_NEAR(to_double(body.linear_velocity.x), 3, 1e-5);
    EXPECT_EQ(world->counts().destroyed_total, 0U);
    EXPECT_TRUE(world->check().ok());
}

TEST(WorldStep, WhatWrapsEndsItsContacts) {
    WorldDefinition scene;
    scene.settings.bounds = 10;
    scene.settings.bounds_policy = BoundsPolicy::wrap;
    scene.bodies.push_back(box(1, {9, -1, 0}, {4, 1, 4}));
    scene.bodies[0].mode = BodyMode::fixed;
    scene.bodies.push_back(box(2, {9.5, 0.5, 0}, {0.5, 0.5, 0.5}));
    scene.bodies[1].linear_velocity.x = 5;
    const WorldPtr world = make_world(scene);
    bool ended = false;
    for (int tick = 0; tick < 30; ++tick) {
        step_idle(*world);
        for (const Event& event : world->events()) {
            ended = ended || event == Event{EventType::contact_end, 1, 2, 0};
        }
    }
    EXPECT_TRUE(ended);
    EXPECT_LT(to_double(world->body(2)->position.x), 0);
    EXPECT_EQ(world->counts().contacts, 0U);
}

TEST(WorldStep, NamesABodyThatLeavesTheBoundsWhereThatIsAnError) {
    WorldDefinition scene;
    scene.settings.bounds = 10;
    scene.settings.bounds_policy = BoundsPolicy::error;
    scene.bodies.push_back(sphere(5, {0, -9, 0}, 0.5));
    const WorldPtr world = make_world(scene);
    step_idle(*world, 26);
    const Status status = world->step({});
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().message, "step to tick 27: body 5 has left settings.bounds");
    EXPECT_FALSE(world->step({}).ok()); // final
}

/// A fault says which setting to raise, and stays until another state is loaded.
void expect_fault(const WorldDefinition& scene, const char* setting) {
    const WorldPtr world = make_world(scene);
    std::vector<std::byte> start;
    world->save(start);
    Status status = Success{};
    for (int tick = 0; tick < 200 && status; ++tick) {
        status = world->step(busy_inputs(world->tick() + 1, world->slot_count()));
    }
    ASSERT_FALSE(status.ok()) << setting;
    EXPECT_NE(status.error().message.find(setting), std::string::npos) << status.error().message;
    EXPECT_NE(status.error().message.find("tick"), std::string::npos);
    EXPECT_FALSE(world->step(busy_inputs(1, world->slot_count())).ok());
    ASSERT_TRUE(world->load(start).ok());
    EXPECT_TRUE(world->step(busy_inputs(1, world->slot_count())).ok());
}

TEST(WorldStep, FullTablesNameTheSettingToRaise) {
    WorldDefinition scene = busy_scene(40, 2);
    scene.settings.body_capacity = static_cast<std::uint32_t>(scene.bodies.size()) + 1;
    expect_fault(scene, "settings.body_capacity");
    scene.settings.body_capacity = 0;
    scene.settings.pair_capacity = 60;
    expect_fault(scene, "settings.pair_capacity");
    scene.settings.pair_capacity = 0;
    scene.settings.manifold_capacity = 20;
    expect_fault(scene, "settings.manifold_capacity");
}

TEST(WorldStepDeathTest, AssertsOnAWrongNumberOfInputs) {
    const WorldPtr world = make_world(busy_scene(5, 2));
    const std::vector<SlotInput> inputs(1);
    EXPECT_DEATH(static_cast<void>(world->step(inputs)), "slot_count");
}

} // namespace
} // namespace lockwind::test
