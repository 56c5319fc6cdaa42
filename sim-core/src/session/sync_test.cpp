#include "session/sync_test.h"

#include "lockwind/assert.h"

#include <algorithm>

namespace lockwind {
namespace {

/// First index at which two lists differ, their lengths included; kNoIndex where they are equal.
std::uint32_t first_difference(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b) {
    const auto place = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
    if (place.first == a.end() && place.second == b.end()) {
        return kNoIndex;
    }
    return static_cast<std::uint32_t>(place.first - a.begin());
}

} // namespace

HashTreeDifference first_difference(const HashTree& a, const HashTree& b) {
    HashTreeDifference difference;
    difference.section = first_difference(std::span(a.sections), std::span(b.sections));
    if (difference.section < std::min(a.pages.size(), b.pages.size())) {
        difference.page = first_difference(std::span(a.pages[difference.section]),
                                           std::span(b.pages[difference.section]));
    }
    return difference;
}

SyncTestSession::SyncTestSession(Simulation& simulation, std::uint32_t check_distance_ticks)
    : simulation_(simulation), states_(std::size_t{check_distance_ticks} + 1) {
    LOCKWIND_ASSERT(check_distance_ticks >= 1);
    remember({});
}

void SyncTestSession::remember(std::span<const SlotInput> inputs) {
    if (steps_.size() == states_.capacity()) {
        steps_.erase(steps_.begin());
    }
    steps_.push_back(
        Step{simulation_.tick(), {inputs.begin(), inputs.end()}, simulation_.hash_tree()});
    states_.save(simulation_, steps_.back().tree.root);
}

void SyncTestSession::compare(const Step& step, Tick rolled_back_to) {
    if (mismatch_ || simulation_.state_hash() == step.tree.root) {
        return;
    }
    const HashTree tree = simulation_.hash_tree();
    const HashTreeDifference difference = first_difference(step.tree, tree);
    SyncMismatch mismatch;
    mismatch.tick = step.tick;
    mismatch.rolled_back_to = rolled_back_to;
    mismatch.hash = step.tree.root;
    mismatch.resimulated_hash = tree.root;
    mismatch.section = difference.section;
    mismatch.page = difference.page;
    std::uint32_t section = 0; // hash trees number the `state` sections of the schema alone
    for (const SectionDescriptor& descriptor : simulation_.schema()) {
        if (!descriptor.derived && section++ == difference.section) {
            mismatch.section_name = descriptor.name;
        }
    }
    mismatch_ = mismatch;
}

Status SyncTestSession::check() {
    const SavedState* start = states_.find(steps_.front().tick);
    Status loaded = simulation_.load(start->bytes);
    if (!loaded) {
        return loaded;
    }
    compare(steps_.front(), start->tick);
    for (std::size_t i = 1; i < steps_.size(); ++i) {
        Status stepped = simulation_.advance(steps_[i].inputs);
        if (!stepped) {
            return stepped;
        }
        ++ticks_resimulated_;
        compare(steps_[i], start->tick);
    }
    return Success{};
}

Result<std::optional<SyncMismatch>> SyncTestSession::advance(std::span<const SlotInput> inputs) {
    LOCKWIND_ASSERT(!mismatch_);
    const Status stepped = simulation_.advance(inputs);
    if (!stepped) {
        return stepped.error();
    }
    ++ticks_advanced_;
    remember(inputs);
    const Status checked = check();
    if (!checked) {
        return checked.error();
    }
    return mismatch_;
}

} // namespace lockwind
