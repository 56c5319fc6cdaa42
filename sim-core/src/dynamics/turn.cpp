#include "dynamics/turn.h"

#include "lockwind/integer.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kFraction = 30;
constexpr std::int64_t kOne = std::int64_t{1} << kFraction;

std::int64_t round_product(std::int64_t sum) {
    return round_shift(sum, kFraction);
}

} // namespace

SincCos sinc_cos(std::int64_t square) {
    const std::int64_t x1 = square;
    const std::int64_t x2 = (x1 * x1) >> kFraction;
    const std::int64_t x3 = (x2 * x1) >> kFraction;
    const std::int64_t x4 = (x2 * x2) >> kFraction;
    return {kOne - x1 / 6 + x2 / 120 - x3 / 5040 + x4 / 362880,
            kOne - x1 / 2 + x2 / 24 - x3 / 720 + x4 / 40320};
}

SinCos sin_cos(std::int64_t angle) {
    int doublings = 0;
    while (angle > kOne / 2 || angle < -kOne / 2) {
        angle >>= 1;
        ++doublings;
    }
    const SincCos part = sinc_cos((angle * angle) >> kFraction);
    SinCos result{round_product(angle * part.sinc), part.cos};
    for (int index = 0; index < doublings; ++index) {
        const std::int64_t sin = result.sin;
        result.sin = round_product(2 * sin * result.cos);
        result.cos = kOne - round_product(2 * sin * sin);
    }
    return result;
}

void turn_quaternion(const std::int64_t half_angle[3], std::int64_t quaternion[4]) {
    const auto square_of = [&](int shift) {
        std::uint64_t sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t part = half_angle[axis] >> shift;
            sum += static_cast<std::uint64_t>(part * part);
        }
        return static_cast<std::int64_t>(sum >> kFraction);
    };
    int doublings = 0;
    while (square_of(doublings) > kOne / 4) {
        ++doublings;
    }
    const SincCos part = sinc_cos(square_of(doublings));
    for (int axis = 0; axis < 3; ++axis) {
        quaternion[axis] = round_product((half_angle[axis] >> doublings) * part.sinc);
    }
    quaternion[3] = part.cos;
    for (int index = 0; index < doublings; ++index) {
        multiply_quaternions(quaternion, quaternion, quaternion);
    }
}

void multiply_quaternions(const std::int64_t a[4], const std::int64_t b[4], std::int64_t out[4]) {
    const std::int64_t x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
    const std::int64_t y = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
    const std::int64_t z = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
    const std::int64_t w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
    out[0] = round_product(x);
    out[1] = round_product(y);
    out[2] = round_product(z);
    out[3] = round_product(w);
}

void normalize_quaternion(const std::int64_t quaternion[4], std::int32_t out[4]) {
    std::int64_t square = 0;
    for (int index = 0; index < 4; ++index) {
        square += quaternion[index] * quaternion[index];
    }
    // Newton's step for 1 / sqrt at 1: (3 - |q|^2) / 2.
    const std::int64_t scale = 3 * kOne - (square >> kFraction);
    for (int index = 0; index < 4; ++index) {
        out[index] =
            static_cast<std::int32_t>(round_shift(quaternion[index] * scale, kFraction + 1));
    }
}

void FreeTurn::turn_about(int axis, int halvings) {
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    const std::int64_t velocity =
        std::clamp(momentum[axis] * inertia[axis] / inertia_min, -velocity_max, velocity_max);
    const std::int64_t angle = raw_multiply(velocity, angle_of_velocity) >> (26 + halvings);
    const SinCos half = sin_cos(angle / 2);
    const std::int64_t sin = round_product(2 * half.sin * half.cos);
    const std::int64_t cos = kOne - round_product(2 * half.sin * half.sin);

    const std::int64_t across[2] = {momentum[next], momentum[last]};
    momentum[next] = round_product(across[0] * cos + across[1] * sin);
    momentum[last] = round_product(across[1] * cos - across[0] * sin);

    const std::int64_t q[4] = {
        orientation[axis], orientation[next], orientation[last], orientation[3]};
    orientation[axis] = round_product(q[0] * half.cos + q[3] * half.sin);
    orientation[next] = round_product(q[1] * half.cos + q[2] * half.sin);
    orientation[last] = round_product(q[2] * half.cos - q[1] * half.sin);
    orientation[3] = round_product(q[3] * half.cos - q[0] * half.sin);
}

void FreeTurn::run() {
    turn_about(0, 1);
    turn_about(1, 1);
    turn_about(2, 0);
    turn_about(1, 1);
    turn_about(0, 1);
}

} // namespace lockwind
