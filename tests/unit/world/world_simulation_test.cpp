#include "tests/support/code_scenes.h"

#include "lockwind/world_simulation.h"

#include <cctype>
#include <gtest/gtest.h>
#include <string>

namespace lockwind::test {
namespace {

std::unique_ptr<WorldSimulation> make_simulation() {
    Result<std::unique_ptr<WorldSimulation>> simulation =
        WorldSimulation::create(busy_scene(30, 2));
    EXPECT_TRUE(simulation.ok());
    return std::move(simulation).value();
}

void advance(Simulation& simulation, int ticks = 1) {
    for (int tick = 0; tick < ticks; ++tick) {
        const Status status =
            simulation.advance(busy_inputs(simulation.tick() + 1, simulation.slot_count()));
        ASSERT_TRUE(status.ok()) << status.error().message;
    }
}

TEST(WorldSimulation, IsTheWorldBehindTheInterface) {
    const auto simulation = make_simulation();
    const WorldPtr world = make_world(busy_scene(30, 2));
    EXPECT_EQ(simulation->slot_count(), 2U);
    EXPECT_EQ(simulation->input_size_bytes(), kPlayerInputSizeBytes);
    for (int tick = 0; tick < 30; ++tick) {
        advance(*simulation);
        step_busy(*world);
        ASSERT_EQ(simulation->state_hash(), world->state_hash());
        ASSERT_EQ(simulation->tick(), world->tick());
    }
    EXPECT_EQ(simulation->hash_tree().root, simulation->state_hash());
    EXPECT_EQ(simulation->schema().size(), World::schema().size());
    EXPECT_EQ(simulation->phases().size(), World::phases().size());
}

TEST(WorldSimulation, RefusesWhatAWorldRefuses) {
    WorldDefinition scene = busy_scene(5, 1);
    scene.settings.substeps = 0;
    EXPECT_FALSE(WorldSimulation::create(scene).ok());
}

TEST(WorldSimulation, RollsBackAndRunsAgainToTheSameHash) {
    const auto simulation = make_simulation();
    advance(*simulation, 50);
    std::vector<std::byte> bytes;
    simulation->save(bytes);
    advance(*simulation, 8);
    const std::uint64_t hash = simulation->state_hash();
    ASSERT_TRUE(simulation->load(bytes).ok());
    advance(*simulation, 8);
    EXPECT_EQ(simulation->state_hash(), hash);
}

TEST(WorldSimulation, CorruptsTheFirstDynamicBodysVelocityByDefault) {
    const auto simulation = make_simulation();
    advance(*simulation, 5);
    const BodyId pod = 10; // bodies 1 .. 5 are fixed
    const Vec3 before = simulation->world().body(pod)->linear_velocity;
    const std::uint64_t hash = simulation->state_hash();
    EXPECT_TRUE(simulation->corrupt(""));
    const Vec3 after = simulation->world().body(pod)->linear_velocity;
    EXPECT_EQ(after.x - before.x, convert<Real>(Velocity::ulp()));
    EXPECT_EQ(after.y, before.y);
    EXPECT_NE(simulation->state_hash(), hash);
}

TEST(WorldSimulation, CorruptsEveryFieldOrSaysWhyNotAndStaysSteppable) {
    for (const SectionDescriptor& section : World::schema()) {
        for (const FieldDescriptor& field : section.fields) {
            const auto simulation = make_simulation();
            advance(*simulation, 40);
            const std::uint64_t hash = simulation->state_hash();
            const std::string name = std::string(section.name) + "." + std::string(field.name);
            const Status status = simulation->corrupt_field(name);
            EXPECT_EQ(status.ok(), simulation->state_hash() != hash) << name;
            if (!status) {
                EXPECT_NE(status.error().message.find(name), std::string::npos);
            }
            EXPECT_TRUE(simulation->world().check().ok()) << name;
            advance(*simulation, 3);
        }
    }
}

TEST(WorldSimulation, CorruptsWhatBenchmarksOfForensicsNeed) {
    for (const char* field : {"body.position",
                              "body.position.y",
                              "body.orientation",
                              "body.angular_velocity[2]",
                              "player.score",
                              "globals.seed",
                              "body_kind.friction",
                              "contact_impulse.normal"}) {
        const auto simulation = make_simulation();
        advance(*simulation, 60);
        EXPECT_TRUE(simulation->corrupt(field)) << field;
    }
}

TEST(WorldSimulation, NamesTheFieldsThereAre) {
    const auto simulation = make_simulation();
    const Status status = simulation->corrupt_field("body.velocity");
    ASSERT_FALSE(status.ok());
    EXPECT_NE(status.error().message.find("\"body.velocity\""), std::string::npos);
    EXPECT_NE(status.error().message.find("body.linear_velocity"), std::string::npos);
    EXPECT_FALSE(simulation->corrupt("body.velocity"));
    EXPECT_FALSE(simulation->corrupt("manifold.separation")) << "nothing touches yet";
}

class HashPerPhase final : public PhaseObserver {
public:
    explicit HashPerPhase(const Simulation& simulation) : simulation_(simulation) {}
    void after_phase(std::uint32_t phase) override {
        EXPECT_EQ(phase, hashes.size());
        hashes.push_back(simulation_.state_hash());
    }
    std::vector<std::uint64_t> hashes;

private:
    const Simulation& simulation_;
};

TEST(WorldSimulation, APhaseFaultShowsFromThatPhaseOn) {
    for (std::uint32_t fault = 0; fault < World::phases().size(); ++fault) {
        const auto sound = make_simulation();
        const auto faulty = make_simulation();
        ASSERT_TRUE(faulty->set_phase_fault(World::phases()[fault]).ok());
        HashPerPhase expected(*sound);
        HashPerPhase actual(*faulty);
        sound->observe(&expected);
        faulty->observe(&actual);
        advance(*sound);
        advance(*faulty);
        ASSERT_EQ(actual.hashes.size(), World::phases().size());
        for (std::uint32_t phase = 0; phase < actual.hashes.size(); ++phase) {
            EXPECT_EQ(actual.hashes[phase] == expected.hashes[phase], phase < fault)
                << World::phases()[fault] << " seen after " << World::phases()[phase];
        }
    }
}

TEST(WorldSimulation, APhaseFaultComesBackInEverySimulationOfTheTick) {
    const auto simulation = make_simulation();
    ASSERT_TRUE(simulation->set_phase_fault("solve").ok());
    advance(*simulation, 10);
    std::vector<std::byte> bytes;
    simulation->save(bytes);
    advance(*simulation, 5);
    const std::uint64_t hash = simulation->state_hash();
    ASSERT_TRUE(simulation->load(bytes).ok());
    advance(*simulation, 5);
    EXPECT_EQ(simulation->state_hash(), hash);
    // Ended, the same ticks go another way.
    ASSERT_TRUE(simulation->load(bytes).ok());
    ASSERT_TRUE(simulation->set_phase_fault("").ok());
    advance(*simulation, 5);
    EXPECT_NE(simulation->state_hash(), hash);
}

TEST(WorldSimulation, CorruptsABodyThatIsAwakeWhereOthersSleep) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(box(2, {0, 0.5, 0}, {0.5, 0.5, 0.5}));
    scene.bodies.push_back(box(3, {5, 0.5, 0}, {0.5, 0.5, 0.5}));
    scene.bodies[2].can_sleep = false;
    const auto simulation = WorldSimulation::create(scene).value();
    for (int tick = 0; tick < 120; ++tick) {
        ASSERT_TRUE(simulation->advance({}).ok());
    }
    ASSERT_TRUE(simulation->world().body(2)->asleep);
    const std::uint64_t hash = simulation->state_hash();
    EXPECT_TRUE(simulation->corrupt_field("").ok());
    EXPECT_NE(simulation->state_hash(), hash);
    EXPECT_TRUE(simulation->world().check().ok());
}

TEST(WorldSimulation, NamesThePhasesThereAre) {
    const auto simulation = make_simulation();
    const Status status = simulation->set_phase_fault("collide");
    ASSERT_FALSE(status.ok());
    EXPECT_NE(status.error().message.find("\"collide\""), std::string::npos);
    EXPECT_NE(status.error().message.find("narrow_phase, wake, solve, restitution"),
              std::string::npos);
}

TEST(SimVersion, IsSixteenHexDigits) {
    ASSERT_EQ(sim_version().size(), 16U);
    for (const char digit : sim_version()) {
        EXPECT_TRUE(std::isxdigit(static_cast<unsigned char>(digit)) != 0);
    }
}

TEST(BuildInfo, NamesCompilerFlagsArchitectureAndCommit) {
    const std::string info(build_info());
    EXPECT_TRUE(info.find("g++ ") == 0 || info.find("clang ") == 0) << info;
    EXPECT_NE(info.find("arithmetic"), std::string::npos) << info;
    EXPECT_NE(info.find("commit "), std::string::npos) << info;
    EXPECT_EQ(info.find('\n'), std::string::npos);
}

} // namespace
} // namespace lockwind::test
