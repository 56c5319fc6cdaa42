#include "base/arena.h"

#include <cstring>
#include <new>

namespace lockwind {

namespace {

std::size_t round_up(std::size_t size_bytes) {
    constexpr std::size_t kMask = StateArena::kAlignmentBytes - 1;
    return (size_bytes + kMask) & ~kMask;
}

} // namespace

void StateArena::Free::operator()(std::byte* buffer) const {
    ::operator delete (buffer, std::align_val_t{kAlignmentBytes});
}

StateArena::StateArena(StateSchema schema, std::span<const std::uint32_t> capacities)
    : schema_(schema) {
    LOCKWIND_ASSERT(!schema.empty() && schema.size() == capacities.size() && capacities[0] == 1);
    while (state_section_count_ < schema.size() && !schema[state_section_count_].derived) {
        ++state_section_count_;
    }
    LOCKWIND_ASSERT(schema[0].stride_bytes == state_section_count_ * sizeof(std::uint32_t));
    derived_counts_.resize(schema.size() - state_section_count_);
    for (std::size_t section = 0; section < schema.size(); ++section) {
        places_.push_back({size_bytes_, capacities[section]});
        size_bytes_ += round_up(std::size_t{schema[section].stride_bytes} * capacities[section]);
    }
    buffer_.reset(
        static_cast<std::byte*>(::operator new (size_bytes_, std::align_val_t{kAlignmentBytes})));
    clear();
}

void StateArena::clear() {
    std::memset(buffer_.get(), 0, size_bytes_);
    derived_counts_.assign(derived_counts_.size(), 0);
    *count(0) = 1;
}

void StateArena::set_row_count(std::uint32_t section, std::uint32_t new_count) {
    LOCKWIND_ASSERT(new_count <= places_[section].capacity);
    const std::uint32_t old_count = row_count(section);
    if (new_count < old_count) {
        const std::size_t stride = schema_[section].stride_bytes;
        std::memset(buffer_.get() + places_[section].offset_bytes + stride * new_count,
                    0,
                    stride * (old_count - new_count));
    }
    *count(section) = new_count;
}

std::span<std::byte> StateArena::live_bytes(std::uint32_t section) {
    return {buffer_.get() + places_[section].offset_bytes,
            std::size_t{schema_[section].stride_bytes} * row_count(section)};
}

std::span<const std::byte> StateArena::live_bytes(std::uint32_t section) const {
    return {buffer_.get() + places_[section].offset_bytes,
            std::size_t{schema_[section].stride_bytes} * row_count(section)};
}

} // namespace lockwind
