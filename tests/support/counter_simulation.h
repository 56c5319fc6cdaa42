#pragma once

#include "base/state_hash.h"

#include "lockwind/simulation.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lockwind::testing {

/// What a CounterSimulation does wrong, for tests that are to notice.
enum class CounterDefect : std::uint8_t {
    none = 0,
    save_omits_a_field = 1, // `memory`, which every step reads, is neither saved nor hashed
};

/// The smallest game worth a match: each slot's two input bytes add to its total, and everything is
/// mixed into one word, so that any other input on any tick gives other states from there on.
/// Sections: "mix" (tick, word) and "total" (one a slot).
class CounterSimulation final : public Simulation {
public:
    static constexpr std::uint32_t kInputSizeBytes = 2;

    explicit CounterSimulation(std::uint32_t slots, CounterDefect defect = CounterDefect::none)
        : defect_(defect), totals_(slots) {}

    std::uint32_t slot_count() const override { return static_cast<std::uint32_t>(totals_.size()); }
    std::uint32_t input_size_bytes() const override { return kInputSizeBytes; }
    Tick tick() const override { return tick_; }

    Status advance(std::span<const SlotInput> inputs) override {
        if (fails_at_ == tick_ + 1) {
            return Error{"counter: planted failure"};
        }
        for (std::size_t slot = 0; slot < totals_.size(); ++slot) {
            totals_[slot] += inputs[slot].bytes[0] + 256U * inputs[slot].bytes[1];
            word_ = mixed(word_ ^ (totals_[slot] + slot));
        }
        if (defect_ == CounterDefect::save_omits_a_field) {
            memory_ = mixed(memory_ + word_);
            totals_.back() += memory_ % 100 == 0 ? 1U : 0U;
        }
        if (observer_ != nullptr) {
            observer_->after_phase(0);
        }
        ++tick_;
        return Success{};
    }

    std::uint64_t state_hash() const override { return hash_tree().root; }

    HashTree hash_tree() const override {
        HashTree tree;
        for (const auto& section : sections()) {
            tree.pages.push_back({hash_bytes(section)});
            tree.sections.push_back(hash_of(tree.pages.back()));
        }
        tree.root = hash_of(tree.sections);
        return tree;
    }

    void save(std::vector<std::byte>& out) const override {
        out.clear();
        for (const auto& section : sections()) {
            out.insert(out.end(), section.begin(), section.end());
        }
        out.resize(out.size() + padding_bytes_);
    }

    Status load(std::span<const std::byte> bytes) override {
        if (bytes.size() < 8 * (2 + totals_.size())) {
            return Error{"counter: snapshot of " + std::to_string(bytes.size()) + " bytes"};
        }
        tick_ = word_at(bytes, 0);
        word_ = word_at(bytes, 1);
        for (std::size_t slot = 0; slot < totals_.size(); ++slot) {
            totals_[slot] = word_at(bytes, 2 + slot);
        }
        return Success{};
    }

    StateSchema schema() const override {
        static constexpr std::array<SectionDescriptor, 3> kSections = {
            SectionDescriptor{"mix", "test", 16, false, "", {}},
            SectionDescriptor{"cache", "test", 8, true, "", {}},
            SectionDescriptor{"total", "test", 8, false, "", {}},
        };
        return kSections;
    }

    std::span<const std::string_view> phases() const override {
        static constexpr std::array<std::string_view, 1> kPhases = {"count"};
        return kPhases;
    }

    void observe(PhaseObserver* observer) override { observer_ = observer; }

    bool corrupt(std::string_view /*field*/) override {
        ++totals_[0];
        return true;
    }

    /// Appends zeros to every snapshot, so that it takes several chunks; load() ignores them.
    void pad_snapshots(std::size_t bytes) { padding_bytes_ = bytes; }
    /// The advance to this tick gives an Error.
    void fail_at(Tick tick) { fails_at_ = tick; }

private:
    /// splitmix64's finalizer.
    static std::uint64_t mixed(std::uint64_t value) {
        value += 0x9e3779b97f4a7c15U;
        value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
        value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
        return value ^ (value >> 31U);
    }

    static void put(std::vector<std::byte>& out, std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte, value >>= 8U) {
            out.push_back(static_cast<std::byte>(value & 0xffU));
        }
    }

    static std::uint64_t word_at(std::span<const std::byte> bytes, std::size_t index) {
        std::uint64_t value = 0;
        for (std::size_t byte = 8; byte-- > 0;) {
            value = value << 8U | static_cast<std::uint64_t>(bytes[8 * index + byte]);
        }
        return value;
    }

    static std::uint64_t hash_of(std::span<const std::uint64_t> words) {
        std::vector<std::byte> bytes;
        for (const std::uint64_t word : words) {
            put(bytes, word);
        }
        return hash_bytes(bytes);
    }

    std::array<std::vector<std::byte>, 2> sections() const {
        std::array<std::vector<std::byte>, 2> sections;
        put(sections[0], tick_);
        put(sections[0], word_);
        for (const std::uint64_t total : totals_) {
            put(sections[1], total);
        }
        return sections;
    }

    CounterDefect defect_;
    Tick tick_ = 0;
    std::uint64_t word_ = 1;
    std::vector<std::uint64_t> totals_;
    std::uint64_t memory_ = 7;
    std::size_t padding_bytes_ = 0;
    Tick fails_at_ = 0;
    PhaseObserver* observer_ = nullptr;
};

} // namespace lockwind::testing
