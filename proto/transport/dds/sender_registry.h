#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

namespace lockwind {

/// Who may speak as whom to one endpoint. The sender's address in an envelope is only claimed; the
/// writer it came from, and that writer's participant, are known. The first claim binds: a writer
/// speaks for one address, and an address belongs to one participant for as long as any of its
/// writers is matched.
class SenderRegistry {
public:
    struct Writer {
        std::uint64_t handle = 0;
        std::uint64_t participant = 0;
    };
    /// Writers matched now, on all channels.
    using Matched = std::function<std::vector<Writer>()>;

    /// Whether `writer` may speak as `sender`. `matched` is asked only about a writer not yet
    /// known.
    bool admit(std::uint64_t writer, std::uint32_t sender, const Matched& matched);

private:
    struct Binding {
        std::uint32_t sender = 0;
        std::uint64_t participant = 0;
    };

    void forget_unmatched(const std::vector<Writer>& matched);

    std::map<std::uint64_t, Binding> bindings_; // by writer
};

} // namespace lockwind
