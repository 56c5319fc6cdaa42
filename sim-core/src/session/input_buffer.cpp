#include "session/input_buffer.h"

#include <algorithm>

namespace lockwind {

void InputBuffer::reset() {
    entries_.fill(Entry{});
    late_after_tick_ = ~Tick{0};
}

bool InputBuffer::well_formed(const SlotInput& input) const {
    return std::all_of(input.bytes.begin() + input_size_bytes_,
                       input.bytes.end(),
                       [](std::uint8_t byte) { return byte == 0; });
}

std::uint32_t InputBuffer::receive(Tick first_tick,
                                   std::span<const SlotInput> inputs,
                                   Tick confirmed_tick,
                                   ViolationCounts& violations) {
    bool too_old = false;
    bool too_new = false;
    bool changed = false;
    bool malformed = false;
    std::uint32_t late = 0;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const Tick tick = first_tick + i; // may wrap to a small, hence too old, tick
        SlotInput input = inputs[i];
        input.status = InputStatus::confirmed;
        if (tick > confirmed_tick && tick - confirmed_tick > kInputWindowTicks) {
            too_new = true;
        } else if (tick == 0 || tick + kInputWindowTicks <= confirmed_tick) {
            too_old = true;
        } else if (!well_formed(input)) {
            malformed = true;
        } else if (Entry& entry = entries_[index_of(tick)]; entry.tick == tick) {
            changed = changed || entry.input != input;
        } else {
            entry = Entry{tick, input};
            late += tick <= confirmed_tick && tick > late_after_tick_ ? 1U : 0U;
        }
    }
    const auto count = [&violations](bool broken, Violation violation) {
        if (broken) {
            violations.add(violation);
        }
    };
    count(too_old, Violation::input_too_old);
    count(too_new, Violation::input_too_new);
    count(changed, Violation::input_changed);
    count(malformed, Violation::input_malformed);
    return late;
}

const SlotInput* InputBuffer::find(Tick tick) const {
    const Entry& entry = entries_[index_of(tick)];
    return tick != 0 && entry.tick == tick ? &entry.input : nullptr;
}

Tick InputBuffer::contiguous_tick(Tick confirmed_tick) const {
    Tick tick = confirmed_tick;
    while (find(tick + 1) != nullptr) {
        ++tick;
    }
    return tick;
}

} // namespace lockwind
