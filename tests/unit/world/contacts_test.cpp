#include "tests/support/code_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

double value(Real real) {
    return static_cast<double>(real.raw()) * 0x1p-32;
}

/// Forces bear the weights above them, by Newton's third law.
TEST(Contacts, OfAStackBearItsWeight) {
    WorldDefinition scene;
    scene.bodies = {ground(1)};
    const double masses[] = {2, 1, 3};
    for (int index = 0; index < 3; ++index) {
        BodyDefinition body =
            box(static_cast<BodyId>(2 + index), {0, Real(index) + Real(0.5), 0}, {0.5, 0.5, 0.5});
        body.mass = Real(static_cast<int>(masses[index]));
        scene.bodies.push_back(body);
    }
    const WorldPtr world = make_world(scene);
    step_idle(*world, 240);
    const std::vector<ContactView> contacts = world->contacts();
    ASSERT_EQ(contacts.size(), 3U);
    double above = 6;
    for (std::size_t index = 0; index < 3; ++index) {
        const ContactView& contact = contacts[index];
        EXPECT_EQ(contact.body_a, index + 1);
        EXPECT_EQ(contact.body_b, index + 2);
        EXPECT_FALSE(contact.sensor);
        EXPECT_NEAR(value(contact.normal.y), 1, 1e-6);
        ASSERT_EQ(contact.point_count, 4U);
        double force = 0;
        for (std::uint32_t point = 0; point < 4; ++point) {
            force += value(contact.points[point].normal_force);
            EXPECT_NEAR(value(contact.points[point].position.y), static_cast<double>(index), 4e-3);
            EXPECT_NEAR(std::abs(value(contact.points[point].position.x)), 0.5, 1e-2);
            EXPECT_NEAR(value(contact.points[point].separation), 0, 2e-3);
        }
        EXPECT_NEAR(force, above * 9.81, 0.01 * above * 9.81) << index;
        above -= masses[index];
    }
}

/// From the tick of contact_begin to that before contact_end, and of a sensor without a force.
TEST(Contacts, PersistBetweenBeginAndEnd) {
    WorldDefinition scene;
    BodyDefinition ball = sphere(2, {0, 1, 0}, 0.5);
    ball.restitution = 0.8;
    BodyDefinition gate = box(3, {0, 1, 0}, {0.3, 0.3, 0.3});
    gate.mode = BodyMode::fixed;
    gate.sensor = true;
    scene.bodies = {ground(1), ball, gate};
    const WorldPtr world = make_world(scene);
    bool on_ground = false;
    bool in_gate = false;
    int ticks_on_ground = 0;
    int ticks_in_gate = 0;
    int begins = 0;
    for (int tick = 0; tick < 300; ++tick) {
        step_idle(*world, 1);
        for (const Event& event : world->events()) {
            begins += event.type == EventType::contact_begin ? 1 : 0;
            on_ground = event.type == EventType::contact_begin ||
                        (on_ground && event.type != EventType::contact_end);
            in_gate = event.type == EventType::sensor_begin ||
                      (in_gate && event.type != EventType::sensor_end);
        }
        bool ground_seen = false;
        bool gate_seen = false;
        for (const ContactView& contact : world->contacts()) {
            ground_seen = ground_seen || contact.body_a == 1;
            gate_seen = gate_seen || contact.sensor;
            if (contact.sensor) {
                EXPECT_EQ(contact.points[0].normal_force, Real(0));
            }
        }
        ASSERT_EQ(ground_seen, on_ground) << tick;
        ASSERT_EQ(gate_seen, in_gate) << tick;
        ticks_on_ground += ground_seen ? 1 : 0;
        ticks_in_gate += gate_seen ? 1 : 0;
    }
    EXPECT_GT(begins, 2); // it bounced
    EXPECT_GT(ticks_on_ground, 10);
    EXPECT_GT(ticks_in_gate, 10);
}

} // namespace
} // namespace lockwind::test
