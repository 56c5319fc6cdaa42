#pragma once

#include "bot/behaviour.h"
#include "session/lockstep_client.h"
#include "session/state_history.h"
#include "transport/transport.h"

#include "lockwind/result.h"
#include "lockwind/world_simulation.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace lockwind {

/// Test tool: a bit of state changed once, after step `tick` and before its hash is taken. Ignored
/// by a bot in another slot.
struct Corruption {
    Slot slot = 0;
    Tick tick = 0;
    std::string field; // "section.field"; "" for the default
};

/// Reads "slot=S,tick=T[,field=NAME]".
Result<Corruption> parse_corruption(std::string_view text);

struct BotSettings {
    std::uint64_t token = 1;         // names the player: the same token gets its slot back; never 0
    std::string behaviour = "fight"; // or log:FILE, see log_behaviour.h
    std::uint64_t seed = 1;
    std::uint32_t connect_timeout_ms = 30'000;
    std::optional<Corruption> corruption;
    std::string corrupt_phase; // corrupts the state after every run of this phase; "" for none
};

/// A headless player: the lock-step client session's driver. Owns its world, borrows the transport.
class Bot {
public:
    using EventListener = std::function<void(const SessionEvent&)>;

    /// An Error where the behaviour or a phase has no such name.
    static Result<std::unique_ptr<Bot>> create(const BotSettings& settings, Transport& transport);

    /// Takes what has arrived, steps what is confirmed, decides and sends inputs.
    void poll();
    /// When poll() is next needed if nothing arrives.
    std::uint64_t next_deadline_us() const;
    void leave() { session_.leave(); }
    bool ended() const { return session_.ended(); }
    /// A server of the match was seen.
    bool found_server() const { return connected_; }
    void listen(EventListener listener) { listener_ = std::move(listener); }

    const LockstepClient& session() const { return session_; }
    /// nullptr before the match's scene is known.
    const WorldSimulation* simulation() const { return simulation_.get(); }
    const Transport& transport() const { return transport_; }
    std::uint64_t packets_malformed() const { return packets_malformed_; }

private:
    Bot(const BotSettings& settings, std::unique_ptr<Behaviour> behaviour, Transport& transport);

    void receive();
    void decide_inputs();
    void execute(const SendRequest& request);
    void execute(const AdvanceRequest& request);
    void execute(const CreateRequest& request);
    void execute(const RestoreRequest& request);
    void execute(const DesyncReportRequest& request);
    void execute(const NotifyRequest& request);
    /// A server's request, which this session never makes.
    template <class Other>
    void execute(const Other& /*request*/) {
        static_assert(std::is_same_v<Other, PersistRequest> ||
                      std::is_same_v<Other, SnapshotRequest> ||
                      std::is_same_v<Other, BundleRequest>);
        LOCKWIND_ASSERT(false);
    }
    Status create_world(const MatchConfig& config);
    Status corrupt_if_due(Tick tick);
    Result<std::vector<std::byte>> desync_report(const HashMismatch& desync);

    BotSettings settings_;
    std::unique_ptr<Behaviour> behaviour_;
    Transport& transport_;
    LockstepClient session_;
    std::unique_ptr<WorldSimulation> simulation_;
    StateHistory history_;
    EventListener listener_;
    std::uint64_t packets_malformed_ = 0;
    bool connected_ = false;
    std::vector<Packet> packets_;    // scratch
    std::vector<std::byte> encoded_; // scratch
};

} // namespace lockwind
