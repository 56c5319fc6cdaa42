#include "bot/behaviour.h"

#include <array>
#include <cstdlib>
#include <optional>
#include <string>

namespace lockwind {

namespace {

constexpr std::array<std::string_view, 3> kNames{"fight", "wander", "idle"};

constexpr std::int16_t kFullStick = 32767;
constexpr Tick kWhimTicks = 45; // a whim lasts this long

/// SplitMix64 (Steele, Lea, Flood 2014): one draw per (seed, slot, counter).
std::uint64_t draw(std::uint64_t seed, Slot slot, std::uint64_t counter) {
    std::uint64_t state = seed + (counter * 64 + slot + 1) * 0x9e3779b97f4a7c15ULL;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9ULL;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebULL;
    return state ^ (state >> 31);
}

/// A direction in the ground plane; 2^-16 m or 2^-16 of a unit vector.
struct Flat {
    std::int64_t x;
    std::int64_t z;
};

Flat flat_delta(const Vec3& from, const Vec3& to) {
    return {(to.x.raw() - from.x.raw()) >> 16, (to.z.raw() - from.z.raw()) >> 16};
}

/// Local +z of the body, seen from above.
Flat heading(const RealQuat& q) {
    const std::int64_t x = q.x.raw() >> 16;
    const std::int64_t y = q.y.raw() >> 16;
    const std::int64_t z = q.z.raw() >> 16;
    const std::int64_t w = q.w.raw() >> 16;
    return {(2 * (x * z + w * y)) >> 16, (1 << 16) - ((2 * (x * x + y * y)) >> 16)};
}

/// |heading| |delta| sin and cos of the turn about +y that would face `delta`.
struct Bearing {
    std::int64_t sine;
    std::int64_t cosine;
};

Bearing bearing(const Flat& ahead, const Flat& delta) {
    return {ahead.z * delta.x - ahead.x * delta.z, ahead.x * delta.x + ahead.z * delta.z};
}

/// The stick turns right, which is about -y.
std::int16_t turn_towards(const Bearing& to) {
    // Full stick beyond ~30 degrees, proportional within.
    if (to.cosine <= 0 || std::llabs(to.sine) * 2 > to.cosine) {
        return to.sine >= 0 ? static_cast<std::int16_t>(-kFullStick) : kFullStick;
    }
    return static_cast<std::int16_t>(-to.sine * 2 * kFullStick / to.cosine);
}

class Idle final : public Behaviour {
public:
    PlayerInput decide(const World&, Slot, Tick) override { return {}; }
};

class Wander final : public Behaviour {
public:
    explicit Wander(std::uint64_t seed) : seed_(seed) {}

    PlayerInput decide(const World&, Slot slot, Tick tick) override {
        const std::uint64_t whim = draw(seed_, slot, tick / kWhimTicks);
        const std::uint64_t now = draw(~seed_, slot, tick);
        PlayerInput input;
        input.thrust = static_cast<std::int16_t>(static_cast<int>(whim % 40'000) - 8'000);
        input.turn = static_cast<std::int16_t>(static_cast<int>((whim >> 20) % 65'535) - 32'767);
        input.buttons = static_cast<std::uint16_t>((now % 60 == 0 ? PlayerInput::kJump : 0) |
                                                   (now % 20 == 1 ? PlayerInput::kShoot : 0));
        return input;
    }

private:
    std::uint64_t seed_;
};

/// Hunts the nearest other pod: drives at it, circles when close, shoots when it faces it, and
/// gives way to a whim now and then so that nobody pushes against a wall for ever.
class Fight final : public Behaviour {
public:
    explicit Fight(std::uint64_t seed) : seed_(seed), wander_(seed) {}

    PlayerInput decide(const World& world, Slot slot, Tick tick) override {
        const std::optional<BodyView> self = world.pod(slot);
        const std::optional<Flat> target = self ? nearest(world, slot, *self) : std::nullopt;
        if (!target || draw(seed_, slot, tick / kWhimTicks) % 6 == 0) {
            return wander_.decide(world, slot, tick);
        }
        const Bearing to = bearing(heading(self->orientation), *target);
        const std::int64_t distance_squared = target->x * target->x + target->z * target->z;
        const bool close = distance_squared < square_m(4);
        const bool aimed = to.cosine > 0 && std::llabs(to.sine) * 3 < to.cosine;
        PlayerInput input;
        input.turn = turn_towards(to);
        const bool stuck = is_stuck(*self);
        const bool backs_off = close || (stuck && draw(seed_, slot, tick / kWhimTicks) % 2 == 0);
        input.thrust = backs_off ? -kFullStick : kFullStick;
        if (aimed && distance_squared < square_m(40)) {
            input.buttons |= PlayerInput::kShoot;
        }
        if (draw(~seed_, slot, tick) % (stuck ? 20U : 120U) == 0) {
            input.buttons |= PlayerInput::kJump;
        }
        return input;
    }

private:
    /// Slower than 0.5 m/s.
    static bool is_stuck(const BodyView& self) {
        constexpr std::int64_t kSlow = std::int64_t{1} << 31U; // Q31.32
        return std::llabs(self.linear_velocity.x.raw()) < kSlow &&
               std::llabs(self.linear_velocity.z.raw()) < kSlow;
    }

    /// (metres)^2 in the unit of Flat, squared.
    static std::int64_t square_m(std::int64_t metres) { return (metres * metres) << 32; }

    static std::optional<Flat> nearest(const World& world, Slot slot, const BodyView& self) {
        std::optional<Flat> best;
        std::int64_t best_squared = 0;
        for (Slot other = 0; other < world.slot_count(); ++other) {
            const std::optional<BodyView> pod = other == slot ? std::nullopt : world.pod(other);
            if (!pod) {
                continue;
            }
            const Flat delta = flat_delta(self.position, pod->position);
            const std::int64_t squared = delta.x * delta.x + delta.z * delta.z;
            if (!best || squared < best_squared) {
                best = delta;
                best_squared = squared;
            }
        }
        return best;
    }

    std::uint64_t seed_;
    Wander wander_;
};

} // namespace

std::span<const std::string_view> behaviour_names() {
    return kNames;
}

Result<std::unique_ptr<Behaviour>> make_behaviour(std::string_view name, std::uint64_t seed) {
    if (name == "fight") {
        return std::unique_ptr<Behaviour>(std::make_unique<Fight>(seed));
    }
    if (name == "wander") {
        return std::unique_ptr<Behaviour>(std::make_unique<Wander>(seed));
    }
    if (name == "idle") {
        return std::unique_ptr<Behaviour>(std::make_unique<Idle>());
    }
    std::string message = "no behaviour is named '" + std::string(name) + "'; there are:";
    for (const std::string_view known : kNames) {
        message.append(" ").append(known);
    }
    return Error{message};
}

} // namespace lockwind
