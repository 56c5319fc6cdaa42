#include "dynamics/block_layout.h"

#include "dynamics/pairing.h"

#include "lockwind/assert.h"
#include "lockwind/world_definition.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace lockwind {

namespace {

constexpr std::uint64_t kDynamicMask = (std::uint64_t{1} << kDynamicColours) - 1;
constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);

/// Of a colour's contacts: by points, and the central ones.
constexpr std::uint32_t kClasses = kBlockPoints + 1;

/// The lanes up to the end of the block in which `lanes` ends.
constexpr std::uint32_t whole_blocks(std::uint32_t lanes) {
    return (lanes + kBlockLanes - 1) / kBlockLanes * kBlockLanes;
}

/// Damaged rows must not lead outside the tables.
bool is_solvable(const Pair& pair, const DynamicsTables& tables) {
    return pair.point_count != 0 && pair.point_count <= kBlockPoints && pair.row_a < pair.row_b &&
           pair.row_b < tables.motion.count() && pair.manifold < tables.manifolds.count();
}

bool is_round(const BodyProperties& body) {
    return body.shape == static_cast<std::uint8_t>(ShapeType::sphere);
}

} // namespace

bool is_central(const BodyProperties& a, const BodyProperties& b) {
    return (is_round(a) || a.mode == kFixed) && (is_round(b) || b.mode == kFixed);
}

Colouring::Colouring(std::uint32_t body_capacity, std::uint32_t pair_capacity)
    : used_(body_capacity) {
    contacts_.reserve(pair_capacity);
}

void Colouring::run(const DynamicsTables& tables, const Activity& activity) {
    contacts_.clear();
    for (const BodyRow row : activity.rows()) {
        used_[row] = 0;
    }
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (!is_solvable(pair, tables)) {
            continue;
        }
        const BodyProperties& a = tables.properties[pair.row_a];
        const BodyProperties& b = tables.properties[pair.row_b];
        const bool a_moves = a.mode == kDynamic;
        const bool b_moves = b.mode == kDynamic;
        if ((!a_moves && !b_moves) || is_sensing(a, b)) {
            continue;
        }
        const std::uint64_t allowed = a_moves && b_moves ? kDynamicMask : ~kDynamicMask;
        const std::uint64_t used =
            (a_moves ? used_[pair.row_a] : 0) | (b_moves ? used_[pair.row_b] : 0);
        const std::uint64_t free = allowed & ~used;
        std::uint32_t colour = kColours;
        if (free != 0) {
            colour = static_cast<std::uint32_t>(std::countr_zero(free));
            const std::uint64_t bit = std::uint64_t{1} << colour;
            used_[pair.row_a] |= bit;
            used_[pair.row_b] |= bit;
        }
        contacts_.push_back({index,
                             static_cast<std::uint8_t>(colour),
                             pair.point_count,
                             pair.point_count == 1 && is_central(a, b)});
    }
}

BlockLayout::BlockLayout(std::uint32_t manifold_capacity)
    : blocks_(manifold_capacity / kBlockLanes + 2 * (kColours + 1)), inputs_(blocks_.size()) {}

void BlockLayout::run(const DynamicsTables& tables, std::span<const ColouredContact> contacts) {
    std::uint32_t place[(kColours + 1) * kClasses] = {};
    const auto class_of = [](const ColouredContact& contact) {
        return contact.colour * kClasses +
               (contact.is_central ? kClasses - 1 : kBlockPoints - contact.point_count);
    };
    for (const ColouredContact& contact : contacts) {
        ++place[class_of(contact)];
    }
    // Counts become the places of their first lanes.
    std::uint32_t end = 0;
    for (std::uint32_t colour = 0; colour <= kColours; ++colour) {
        if (colour == kColours) {
            overflow_first_ = end / kBlockLanes;
        }
        for (std::uint32_t entry = 0; entry < kClasses; ++entry) {
            if (entry == kClasses - 1) {
                end = whole_blocks(end);
            }
            end += std::exchange(place[colour * kClasses + entry], end);
        }
        end = whole_blocks(end);
    }
    count_ = end / kBlockLanes;
    LOCKWIND_ASSERT(count_ <= blocks_.size());
    for (ContactBlock& block : blocks()) {
        block.lane_count = 0;
        block.point_count_max = 0;
    }
    for (const ColouredContact& contact : contacts) {
        const Pair& pair = tables.pairs[contact.pair];
        const std::uint32_t index = place[class_of(contact)]++;
        const std::uint32_t lane = index % kBlockLanes;
        ContactBlock& block = blocks_[index / kBlockLanes];
        block.is_central = contact.is_central;
        block.row_a[lane] = pair.row_a;
        block.row_b[lane] = pair.row_b;
        block.pair[lane] = contact.pair;
        block.manifold[lane] = pair.manifold;
        block.point_count[lane] = contact.point_count;
        block.point_count_max = std::max(block.point_count_max, std::int32_t{contact.point_count});
        ++block.lane_count;
    }
}

} // namespace lockwind
