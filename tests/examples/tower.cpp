#include "tests/examples/example.h"

// Five boxes fall onto each other and rest. Prints where they lie, and what presses on what.

using namespace lockwind;

namespace {

WorldDefinition tower() {
    WorldDefinition definition;
    BodyDefinition ground;
    ground.id = 1;
    ground.mode = BodyMode::fixed;
    ground.shape.type = ShapeType::plane;
    definition.bodies.push_back(ground);
    for (int floor = 0; floor < 5; ++floor) {
        BodyDefinition box;
        box.id = static_cast<BodyId>(2 + floor);
        box.shape.type = ShapeType::box;
        box.shape.half_extents = {0.5, 0.25, 0.5};
        box.position = {0, Real(floor) * Real(0.6) + Real(0.3), 0};
        box.mass = 10;
        definition.bodies.push_back(box);
    }
    return definition;
}

} // namespace

int main() {
    const WorldPtr world = example::require(World::create(tower()));
    for (int tick = 0; tick < 180; ++tick) { // three seconds at 60 Hz
        example::require(world->step({}));
    }
    for (BodyRow row = 1; row < world->body_count(); ++row) {
        const BodyView box = world->body_at(row);
        std::printf("box %d lies at %.4f m%s\n",
                    static_cast<int>(box.id),
                    example::to_double(box.position.y),
                    box.asleep ? ", asleep" : "");
        example::require(box.asleep, "all rest after three seconds");
    }
    for (const ContactView& contact : world->contacts()) {
        double force = 0;
        for (std::uint32_t point = 0; point < contact.point_count; ++point) {
            force += example::to_double(contact.points[point].normal_force);
        }
        std::printf("%d bears %d with %.1f N\n",
                    static_cast<int>(contact.body_a),
                    static_cast<int>(contact.body_b),
                    force);
    }
    std::printf("state %016llx\n", static_cast<unsigned long long>(world->state_hash()));
    return 0;
}
