#include "transport/dds/sender_registry.h"

#include <algorithm>

namespace lockwind {

bool SenderRegistry::admit(std::uint64_t writer, std::uint32_t sender, const Matched& matched) {
    const auto known = bindings_.find(writer);
    if (known != bindings_.end()) {
        return known->second.sender == sender;
    }
    const std::vector<Writer> writers = matched();
    forget_unmatched(writers);
    const auto self = std::find_if(
        writers.begin(), writers.end(), [&](const Writer& w) { return w.handle == writer; });
    for (const auto& [handle, binding] : bindings_) {
        const bool same_participant =
            self != writers.end() && binding.participant == self->participant;
        if (binding.sender == sender && !same_participant) {
            return false;
        }
    }
    // A writer that has gone meanwhile leaves samples behind: nothing to bind.
    if (self != writers.end()) {
        bindings_[writer] = Binding{sender, self->participant};
    }
    return true;
}

void SenderRegistry::forget_unmatched(const std::vector<Writer>& matched) {
    for (auto it = bindings_.begin(); it != bindings_.end();) {
        const bool alive = std::any_of(matched.begin(), matched.end(), [&](const Writer& writer) {
            return writer.handle == it->first;
        });
        it = alive ? std::next(it) : bindings_.erase(it);
    }
}

} // namespace lockwind
