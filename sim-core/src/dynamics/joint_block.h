#pragma once

#include "lockwind/int128.h"
#include "lockwind/integer.h"

#include <cstdint>

namespace lockwind {

// A joint's rows are few and its levers may be long, so that coefficients are not of order one as a
// contact's are: sums of products are exact in 128 bits and rounded once, to int64.
inline constexpr int kJointRowsMax = 6;
inline constexpr int kImpulseFraction = 32;  // speeds and impulses of rows, m/s
inline constexpr int kRowFraction = 30;      // coefficients of rows
inline constexpr int kShareFraction = 40;    // shares of 1/m_a + 1/m_b
inline constexpr int kResponseFraction = 36; // K, and its factors
inline constexpr std::int64_t kJointImpulseMax = std::int64_t{1} << 52; // 2^20 m/s

inline Int128 dot_exact(const std::int64_t a[3], const std::int64_t b[3]) {
    return raw_add(raw_add(wide_product<Int128>(a[0], b[0]), wide_product<Int128>(a[1], b[1])),
                   wide_product<Int128>(a[2], b[2]));
}

inline std::int64_t round_exact(Int128 sum, int shift) {
    return raw_saturate<std::int64_t>(round_shift(sum, shift));
}

/// The symmetric system K x = r of a joint's rows: the first `held` rows keep a speed and are
/// solved exactly and together; what stands behind them is up to two free axes, which springs,
/// motors and limits act on. Factored as L D L^T, so that a free axis sees its response while all
/// held rows hold. A row without response (D next to 0) gets no impulse.
class JointBlock {
public:
    void reset(int held, int free);
    int held() const { return held_; }
    int count() const { return count_; }
    /// Of the lower triangle, Q.36.
    void set_entry(int row, int column, std::int64_t value) { entry_[row][column] = value; }

    /// Compliances, Q.36, are added to the diagonal of the held rows: one to the first `angles`,
    /// one to the others.
    void factor(int angles, std::int64_t of_angles, std::int64_t of_places);
    /// Response of free axis i to an impulse on free axis k <= i while the held rows hold, Q.36.
    std::int64_t response(int i, int k) const { return left_[held_ + i][held_ + k]; }
    /// From the speeds that each row lacks (Q.32) to those that are lacking once the rows before
    /// have got theirs; of a free axis: once all held rows have.
    void eliminate(std::int64_t lacking[kJointRowsMax]) const;
    /// From eliminated speeds of the held rows and impulses of the free axes to all impulses, Q.32.
    void substitute(std::int64_t rows[kJointRowsMax]) const;

private:
    int held_ = 0;
    int count_ = 0;
    std::int64_t entry_[kJointRowsMax][kJointRowsMax];
    std::int64_t left_[kJointRowsMax][kJointRowsMax];   // of K, once earlier rows hold; D
    std::int64_t factor_[kJointRowsMax][kJointRowsMax]; // L, Q.36, of columns below held_
};

/// speed / response, Q.32; 0 where the response is below 2^-28.
std::int64_t impulse_for(std::int64_t speed, std::int64_t response);

} // namespace lockwind
