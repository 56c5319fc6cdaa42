#pragma once

#include "dynamics/activity.h"
#include "dynamics/contact_block.h"
#include "dynamics/dynamics.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Dynamic pairs take the first colours, contacts with a partner that does not move under forces
/// the last, so that what bodies stand on has the last word; what finds no colour is solved one by
/// one.
inline constexpr std::uint32_t kDynamicColours = 48;
inline constexpr std::uint32_t kColours = 64;

/// Whether the contact's normal passes through the centre of each of its bodies that can turn, so
/// that its force turns none.
bool is_central(const BodyProperties& a, const BodyProperties& b);

/// A touching pair and its colour; kColours for the overflow.
struct ColouredContact {
    std::uint32_t pair;
    std::uint8_t colour;
    std::uint8_t point_count;
    bool is_central;
};

/// Colours touching pairs greedily in pair order, so that no two of a colour share a dynamic body.
/// The colours of a group of bodies follow from that group alone.
class Colouring {
public:
    Colouring(std::uint32_t body_capacity, std::uint32_t pair_capacity);
    void run(const DynamicsTables& tables, const Activity& activity);
    std::span<const ColouredContact> contacts() const { return contacts_; }

private:
    std::vector<std::uint64_t> used_; // a bit for each colour, by body; of those that are awake
    std::vector<ColouredContact> contacts_;
};

/// Blocks of eight contacts in solving order: by colour, then points (most first, so that lanes
/// have equal work), then pair. Central contacts come last, and have blocks of their own.
class BlockLayout {
public:
    explicit BlockLayout(std::uint32_t manifold_capacity);
    void run(const DynamicsTables& tables, std::span<const ColouredContact> contacts);
    std::span<ContactBlock> blocks() { return {blocks_.data(), count_}; }
    /// What the blocks' rows were made from when they were last made, be it in an earlier tick.
    RowInputs& inputs(std::size_t block) { return inputs_[block]; }
    /// Blocks from this one on hold the overflow: only one lane at a time may be solved.
    std::uint32_t overflow_first() const { return overflow_first_; }

private:
    std::vector<ContactBlock> blocks_;
    std::vector<RowInputs> inputs_;
    std::uint32_t count_ = 0;
    std::uint32_t overflow_first_ = 0;
};

} // namespace lockwind
