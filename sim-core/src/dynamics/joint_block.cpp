#include "dynamics/joint_block.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr std::int64_t kOne = std::int64_t{1} << kResponseFraction;

constexpr std::int64_t kResponseMin = 1 << 8; // 2^-28

/// value - factor x other, the factor Q.36.
std::int64_t less_product(std::int64_t value, std::int64_t factor, std::int64_t other) {
    const std::int64_t product =
        round_exact(wide_product<Int128>(factor, other), kResponseFraction);
    return raw_saturate<std::int64_t>(raw_subtract(Int128(value), Int128(product)));
}

} // namespace

std::int64_t impulse_for(std::int64_t speed, std::int64_t response) {
    return response < kResponseMin ? 0
                                   : std::clamp(multiply_divide(speed, kOne, response),
                                                -kJointImpulseMax,
                                                kJointImpulseMax);
}

void JointBlock::reset(int held, int free) {
    held_ = held;
    count_ = held + free;
}

void JointBlock::factor(int angles, std::int64_t of_angles, std::int64_t of_places) {
    for (int row = 0; row < count_; ++row) {
        std::copy(entry_[row], entry_[row] + row + 1, left_[row]);
        if (row < held_) {
            left_[row][row] += row < angles ? of_angles : of_places;
        }
    }
    for (int column = 0; column < held_; ++column) {
        const std::int64_t pivot = left_[column][column];
        for (int row = column + 1; row < count_; ++row) {
            factor_[row][column] =
                pivot < kResponseMin ? 0 : multiply_divide(left_[row][column], kOne, pivot);
        }
        for (int row = column + 1; row < count_; ++row) {
            for (int other = column + 1; other <= row; ++other) {
                left_[row][other] =
                    less_product(left_[row][other], factor_[row][column], left_[other][column]);
            }
        }
    }
}

void JointBlock::eliminate(std::int64_t lacking[kJointRowsMax]) const {
    for (int row = 1; row < count_; ++row) {
        for (int column = 0; column < std::min(row, held_); ++column) {
            lacking[row] = less_product(lacking[row], factor_[row][column], lacking[column]);
        }
    }
}

void JointBlock::substitute(std::int64_t rows[kJointRowsMax]) const {
    for (int row = held_ - 1; row >= 0; --row) {
        rows[row] = impulse_for(rows[row], left_[row][row]);
        for (int later = row + 1; later < count_; ++later) {
            rows[row] = less_product(rows[row], factor_[later][row], rows[later]);
        }
    }
}

} // namespace lockwind
