#include "systems/pod.h"

#include "dynamics/definition_checker.h"
#include "dynamics/make_body.h"
#include "dynamics/pairing.h"
#include "systems/motion.h"

#include "lockwind/rng.h"

#include <algorithm>
#include <string>

namespace lockwind {

namespace {

// How a pod handles; the same for every pod.
constexpr Real kSteeringRate = 12.0;     // 1/s: the yaw rate closes in on the stick's
constexpr Real kUprightStiffness = 60.0; // 1/s^2: angular acceleration per sine of tilt
constexpr Real kUprightDamping = 10.0;   // 1/s: of pitch and roll; 0.65 of critical
constexpr Real kSupportCosine = 0.7;     // a contact within 45 degrees of straight below supports
constexpr Real kMuzzleGap = 0.05;        // m between the pod's bounding sphere and the ball
constexpr Real kSpread = 0.02;           // of a ball's direction, sideways and up
constexpr Real kBallFriction = 0.5;
constexpr Real kBallRestitution = 0.5;

constexpr Real kOne = 1;

Error pod_error(Slot slot, const std::string& what) {
    return Error{"pod of slot " + std::to_string(slot) + ": " + what};
}

Status check_pod(const PodDefinition& pod, Slot slot) {
    constexpr std::uint32_t kTicksMax = 1'000'000;
    DefinitionChecker checker("pod of slot", slot);
    checker.range("thrust_acceleration", pod.thrust_acceleration, 0, 1000, " m/s^2");
    checker.range("speed_max", pod.speed_max, 1, 400, " m/s");
    checker.range("turn_rate", pod.turn_rate, 0, 50, " rad/s");
    checker.range("jump_speed", pod.jump_speed, 0, 100, " m/s");
    checker.range("ball_speed", pod.ball_speed, 0, 1000, " m/s");
    checker.count("ball_cooldown_ticks", pod.ball_cooldown_ticks, 1, kTicksMax);
    checker.count("ball_lifetime_ticks", pod.ball_lifetime_ticks, 1, kTicksMax);
    if (checker.failed()) {
        return checker.error();
    }
    return Success{};
}

Status check_body(const WorldDefinition& definition, Slot slot) {
    const PodDefinition& pod = definition.pods[slot];
    const auto body =
        std::find_if(definition.bodies.begin(),
                     definition.bodies.end(),
                     [&](const BodyDefinition& other) { return other.id == pod.body; });
    if (body == definition.bodies.end() || body->mode != BodyMode::dynamic) {
        return pod_error(slot,
                         "body " + std::to_string(pod.body) + " is no dynamic body of the scene");
    }
    for (Slot other = 0; other < slot; ++other) {
        if (definition.pods[other].body == pod.body) {
            return pod_error(slot,
                             "body " + std::to_string(pod.body) + " is also the pod of slot " +
                                 std::to_string(other));
        }
    }
    return Success{};
}

Status make_ball(const WorldDefinition& definition,
                 const ShapeLibrary& shapes,
                 Slot slot,
                 BodyRecord& ball) {
    const PodDefinition& pod = definition.pods[slot];
    BodyDefinition body;
    body.id = pod.body;
    body.shape.type = ShapeType::sphere;
    body.shape.radius = pod.ball_radius;
    body.density = pod.ball_density;
    body.friction = kBallFriction;
    body.restitution = kBallRestitution;
    if (Status made = make_body(body, definition.settings, shapes, ball.motion, ball.properties);
        !made) {
        return pod_error(slot, "ball: " + made.error().message);
    }
    ball.motion.id = 0;
    return Success{};
}

/// See turn_to_given_frame; of a pod's body as it is defined.
Status read_turn(const WorldDefinition& definition,
                 const ShapeLibrary& shapes,
                 Slot slot,
                 RealQuat& turn) {
    const auto body = std::find_if(
        definition.bodies.begin(), definition.bodies.end(), [&](const BodyDefinition& other) {
            return other.id == definition.pods[slot].body;
        });
    BodyRecord made{};
    if (Status status = make_body(*body, definition.settings, shapes, made.motion, made.properties);
        !status) {
        return status;
    }
    turn = turn_to_given_frame(made.properties, shapes);
    return Success{};
}

Real stick(std::int16_t value) {
    return Real(std::clamp<std::int16_t>(value, -32767, 32767)) / Real(32767);
}

} // namespace

Result<PodSystem> PodSystem::create(const WorldDefinition& definition,
                                    const ShapeLibrary& shapes,
                                    std::uint32_t body_capacity) {
    PodSystem system;
    system.tick_seconds_ = kOne / Real(definition.settings.tick_rate_hz);
    system.supported_.resize(body_capacity);
    system.rows_.reserve(definition.pods.size());
    for (Slot slot = 0; slot < definition.pods.size(); ++slot) {
        const PodDefinition& pod = definition.pods[slot];
        if (Status status = check_body(definition, slot); !status) {
            return status.error();
        }
        if (Status status = check_pod(pod, slot); !status) {
            return status.error();
        }
        BodyRecord ball{};
        if (Status status = make_ball(definition, shapes, slot, ball); !status) {
            return status.error();
        }
        RealQuat to_given;
        if (Status status = read_turn(definition, shapes, slot, to_given); !status) {
            return status.error();
        }
        system.pods_.push_back({pod.body,
                                pod.thrust_acceleration * system.tick_seconds_,
                                pod.speed_max,
                                pod.turn_rate,
                                pod.jump_speed,
                                pod.ball_speed,
                                pod.ball_cooldown_ticks,
                                pod.ball_lifetime_ticks,
                                ball,
                                to_given});
    }
    return system;
}

std::vector<Player> PodSystem::initial_players() const {
    std::vector<Player> players;
    for (const Parameters& pod : pods_) {
        Player player{};
        player.body = pod.body;
        players.push_back(player);
    }
    return players;
}

std::span<const BodyRow> PodSystem::rows(const DynamicsTables& tables,
                                         const Table<Player>& players) {
    rows_.clear();
    for (const Player& player : players.rows()) {
        if (const BodyRow row = row_of(tables.motion, player.body); row != kNoIndex) {
            rows_.push_back(row);
        }
    }
    return rows_;
}

void PodSystem::mark_supported(const DynamicsTables& tables) {
    std::fill_n(supported_.begin(), tables.motion.count(), std::uint8_t{0});
    for (const Pair& pair : tables.pairs.rows()) {
        if (pair.manifold == kNoIndex ||
            is_sensing(tables.properties[pair.row_a], tables.properties[pair.row_b])) {
            continue;
        }
        // The normal points from A to B: upwards, A holds B.
        const Real up = convert<Real>(Unit::from_raw(tables.manifolds[pair.manifold].normal[1]));
        if (up >= kSupportCosine) {
            supported_[pair.row_b] = 1;
        } else if (up <= -kSupportCosine) {
            supported_[pair.row_a] = 1;
        }
    }
}

void PodSystem::apply_inputs(const DynamicsTables& tables,
                             const Table<Player>& players,
                             std::span<const SlotInput> inputs) {
    LOCKWIND_ASSERT(inputs.size() == pods_.size() && players.count() == pods_.size());
    bool is_marked = false; // looking at all pairs costs something, and jumps are rare
    for (Slot slot = 0; slot < players.count(); ++slot) {
        const Parameters& pod = pods_[slot];
        Player& player = players[slot];
        const PlayerInput input = decode_player_input(inputs[slot]);
        const BodyRow row = row_of(tables.motion, player.body);
        player.cooldown_ticks -= player.cooldown_ticks > 0 ? 1 : 0;
        if (row != kNoIndex) {
            BodyMotion& motion = tables.motion[row];
            drive(pod, input, motion);
            const auto gyration_radius = Length::from_raw(tables.properties[row].gyration_radius);
            balance(pod, input, convert<Real>(gyration_radius), motion);
            const bool pressed = (input.buttons & ~player.last_buttons & PlayerInput::kJump) != 0;
            if (pressed && !is_marked) {
                mark_supported(tables);
                is_marked = true;
            }
            if (pressed && supported_[row] != 0) {
                Vec3 velocity = read_velocity(motion.linear_velocity);
                velocity.y = std::max(velocity.y, Real(0)) + pod.jump_speed;
                write_velocity(velocity, motion.linear_velocity);
            }
            if ((input.buttons & PlayerInput::kShoot) != 0 && player.cooldown_ticks == 0) {
                player.shooting = 1;
                player.cooldown_ticks = pod.cooldown_ticks;
            }
        }
        player.last_buttons = input.buttons;
    }
}

void PodSystem::drive(const Parameters& pod, const PlayerInput& input, BodyMotion& motion) const {
    const Real thrust = stick(input.thrust);
    if (thrust == Real(0)) {
        return;
    }
    const Vec3 ahead = rotate(read_orientation(motion) * pod.to_given, Vec3{0, 0, 1});
    const Vec3 direction = Vec3{ahead.x, 0, ahead.z} * thrust;
    Vec3 velocity = read_velocity(motion.linear_velocity);
    const Real speed = dot(velocity, Vec3{ahead.x, 0, ahead.z}) * (thrust < Real(0) ? -1 : 1);
    const Real fade = std::clamp((pod.speed_max - speed) / pod.speed_max, Real(0), kOne);
    velocity += direction * (pod.thrust * fade);
    write_velocity(velocity, motion.linear_velocity);
}

/// Works on spin = angular velocity x gyration radius, as the state holds it, so that a pod that
/// neither tilts nor turns keeps its bits.
void PodSystem::balance(const Parameters& pod,
                        const PlayerInput& input,
                        Real gyration_radius,
                        BodyMotion& motion) const {
    const RealQuat orientation = read_orientation(motion) * pod.to_given;
    const Vec3 up = rotate(orientation, Vec3{0, 1, 0});
    Vec3 spin = read_velocity(motion.angular_velocity);
    // up x (world's up): its length is the sine of the tilt. Upside down: full strength, and about
    // the pod's own z where the tilt has no direction.
    Vec3 righting{-up.z, 0, up.x};
    if (up.y < Real(0)) {
        const Vec3 ahead = rotate(orientation, Vec3{0, 0, 1});
        const bool clear = abs(up.x) > Real(0.01) || abs(up.z) > Real(0.01);
        righting = normalized(clear ? righting : Vec3{ahead.x, 0, ahead.z});
    }
    const Real damping = std::min(kUprightDamping * tick_seconds_, kOne);
    const Real push = kUprightStiffness * tick_seconds_ * gyration_radius;
    spin.x += righting.x * push - spin.x * damping;
    spin.z += righting.z * push - spin.z * damping;
    const Real target = -(stick(input.turn) * pod.turn_rate) * gyration_radius;
    spin.y += (target - spin.y) * std::min(kSteeringRate * tick_seconds_, kOne);
    write_velocity(spin, motion.angular_velocity);
}

void PodSystem::spawn_balls(const DynamicsTables& tables,
                            const Table<Player>& players,
                            std::uint64_t seed,
                            Tick tick,
                            Spawner& spawner) const {
    for (Slot slot = 0; slot < players.count(); ++slot) {
        Player& player = players[slot];
        const BodyRow row = row_of(tables.motion, player.body);
        const bool shoots = player.shooting != 0 && row != kNoIndex;
        player.shooting = 0;
        if (!shoots || spawner.is_destroyed(row)) {
            continue;
        }
        const Parameters& pod = pods_[slot];
        const BodyMotion& motion = tables.motion[row];
        const BodyProperties& properties = tables.properties[row];
        BodyLife& life = tables.lives[row];
        const Real sideways = random_symmetric(seed, player.body, player.draw_count) * kSpread;
        const Real upwards = random_symmetric(seed, player.body, player.draw_count + 1) * kSpread;
        player.draw_count += 2;
        const Vec3 direction =
            normalized(rotate(read_orientation(motion) * pod.to_given, Vec3{sideways, upwards, 1}));
        const Real reach = convert<Real>(Length::from_raw(properties.bounding_radius)) +
                           convert<Real>(Length::from_raw(pod.ball.properties.bounding_radius)) +
                           kMuzzleGap;
        ++life.spawn_count;
        BodyRecord ball = pod.ball;
        ball.motion.id = spawned_id(player.body, life.spawn_count);
        write_position(read_position(motion) + direction * reach, ball.motion);
        write_velocity(read_velocity(motion.linear_velocity) + direction * pod.ball_speed,
                       ball.motion.linear_velocity);
        // 0 would be never; the tick after it is as good.
        const auto despawn_tick = static_cast<std::uint32_t>(tick + pod.lifetime_ticks);
        ball.life.despawn_tick = despawn_tick == 0 ? 1 : despawn_tick;
        spawner.create(ball);
    }
}

Slot slot_of(const Table<Player>& players, BodyId body) {
    for (Slot slot = 0; slot < players.count(); ++slot) {
        if (players[slot].body == body) {
            return slot;
        }
    }
    return kNoIndex;
}

bool is_goal(const DynamicsTables& tables,
             const Table<Player>& players,
             const ContactHit& hit,
             Goal& goal) {
    const BodyId a = tables.motion[hit.row_a].id;
    const BodyId b = tables.motion[hit.row_b].id;
    const bool a_is_ball = spawner_of(a) != 0;
    if (a_is_ball == (spawner_of(b) != 0)) {
        return false;
    }
    goal.by = slot_of(players, spawner_of(a_is_ball ? a : b));
    goal.victim = slot_of(players, a_is_ball ? b : a);
    goal.ball = a_is_ball ? hit.row_a : hit.row_b;
    return goal.by != kNoIndex && goal.victim != kNoIndex && goal.by != goal.victim;
}

} // namespace lockwind
