#include "tests/examples/example.h"

// A crane carries a weight along a path of its own (kinematic), lets go of the path in mid-flight
// (dynamic), and the weight on its chain goes with it.

using namespace lockwind;

namespace {

WorldDefinition crane() {
    WorldDefinition definition;
    BodyDefinition trolley;
    trolley.id = 1;
    trolley.mode = BodyMode::kinematic;
    trolley.shape.type = ShapeType::box;
    trolley.shape.half_extents = {0.5, 0.1, 0.2};
    trolley.position = {0, 20, 0};
    trolley.linear_velocity = {2, 0, 0};
    definition.bodies.push_back(trolley);
    BodyDefinition weight;
    weight.id = 2;
    weight.position = {0, 17, 0};
    weight.mass = 50;
    definition.bodies.push_back(weight);
    JointDefinition chain;
    chain.id = 1;
    chain.kind = JointKind::distance;
    chain.body_a = 1;
    chain.body_b = 2;
    chain.has_limit = true;
    chain.length_max = 3;
    definition.joints.push_back(chain);
    return definition;
}

void step(World& world, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
        example::require(world.step({}));
    }
}

} // namespace

int main() {
    const WorldDefinition definition = crane();
    const WorldPtr world = example::require(World::create(definition));
    step(*world, 60);
    const BodyView carried = *world->body(1);
    std::printf("after a second the trolley is at %.3f m\n",
                example::to_double(carried.position.x));

    BodyDefinition loose = definition.bodies[0];
    loose.mode = BodyMode::dynamic;
    loose.mass = 20;
    loose.position = carried.position;
    example::require(world->redefine_body(loose));
    step(*world, 60);
    const Vec3 between = world->body(1)->position - world->body(2)->position;
    std::printf("a second later it is at %.3f m, %.3f m up, its weight %.3f m away\n",
                example::to_double(world->body(1)->position.x),
                example::to_double(world->body(1)->position.y),
                example::to_double(length(between)));
    example::require(world->body(1)->position.y < Real(18), "it falls");
    example::require(length(between) < Real(3.01), "the chain still holds");
    return 0;
}
