#include "tests/examples/example.h"

// Steps eight ticks with a guess, goes back, steps them again with what really happened: the way of
// a rollback session. What was kept is the state's bytes, and nothing else.

using namespace lockwind;

namespace {

WorldPtr make_pool() {
    WorldDefinition definition;
    BodyDefinition table;
    table.id = 1;
    table.mode = BodyMode::fixed;
    table.shape.type = ShapeType::plane;
    definition.bodies.push_back(table);
    for (int index = 0; index < 10; ++index) {
        BodyDefinition ball;
        ball.id = static_cast<BodyId>(2 + index);
        ball.shape.radius = 0.03;
        ball.position = {Real(index) * Real(0.07), 0.03, 0};
        ball.restitution = 0.9;
        definition.bodies.push_back(ball);
    }
    return example::require(World::create(definition));
}

void strike(World& world, Real speed) {
    const BodyView ball = *world.body(2);
    world.apply_impulse(2, {speed * ball.mass, 0, 0}, ball.position);
}

void step(World& world, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
        example::require(world.step({}));
    }
}

} // namespace

int main() {
    const WorldPtr world = make_pool();
    step(*world, 30);
    KeptState kept;
    world->keep(kept);

    strike(*world, 1); // a guess
    step(*world, 8);
    const std::uint64_t guessed = world->state_hash();

    world->restore(kept);
    strike(*world, 3); // what the player did
    step(*world, 8);
    const std::uint64_t corrected = world->state_hash();

    const WorldPtr other = make_pool(); // a machine that never guessed
    step(*other, 30);
    strike(*other, 3);
    step(*other, 8);
    std::printf("kept %zu bytes; guessed %016llx, corrected %016llx, other machine %016llx\n",
                kept.bytes.size(),
                static_cast<unsigned long long>(guessed),
                static_cast<unsigned long long>(corrected),
                static_cast<unsigned long long>(other->state_hash()));
    example::require(guessed != corrected, "the guess was wrong");
    example::require(corrected == other->state_hash(), "going back leaves no trace");
    return 0;
}
