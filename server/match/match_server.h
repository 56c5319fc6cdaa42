#pragma once

#include "forensics/verdict.h"
#include "log/log_writer.h"
#include "session/histogram.h"
#include "session/lockstep_server.h"
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

struct MatchSettings {
    MatchConfig config; // scene_text filled in
    StallPolicy stall_policy = StallPolicy::pause;
    std::uint32_t join_timeout_ms = 30'000;
    std::string log_path; // must not exist
};

/// One desync of a match, as far as it could be traced.
struct DesyncOutcome {
    HashMismatch desync;
    std::string bundle; // path; "" where it could not be written
    std::string verdict;
    std::string problem; // why there is no bundle; "" where there is
};

/// Of one match, for its report.
struct MatchFigures {
    Histogram step_us;
    Histogram contacts; // contact points a tick
    std::uint64_t created = 0;
    std::uint64_t destroyed = 0;
    std::uint64_t scores = 0;
};

/// A match: the lock-step session's driver. Owns the world and the log, borrows the transport; runs
/// the same over DDS, loopback and a simulated network.
class MatchServer {
public:
    using EventListener = std::function<void(const SessionEvent&)>;

    /// An Error where the configuration or the scene is wrong, named as the user knows it.
    static Status check_settings(const MatchConfig& config);

    /// An Error as check_settings, or where the log cannot be created.
    static Result<std::unique_ptr<MatchServer>> create(const MatchSettings& settings,
                                                       Transport& transport);

    /// Takes what has arrived, steps what is due, sends what is to be sent.
    void poll();
    /// When poll() is next needed if nothing arrives.
    std::uint64_t next_deadline_us() const { return session_.next_deadline_us(); }
    void stop(const std::string& reason) { session_.stop(reason); }
    bool ended() const { return session_.ended(); }
    /// Called with each event of the session, in order.
    void listen(EventListener listener) { listener_ = std::move(listener); }

    const LockstepServer& session() const { return session_; }
    const WorldSimulation& simulation() const { return *simulation_; }
    const MatchFigures& figures() const { return figures_; }
    const std::vector<DesyncOutcome>& desyncs() const { return desyncs_; }
    const Transport& transport() const { return transport_; }
    const LogWriter& log() const { return *log_; }
    /// Why the log, be it only its summary, could not be written; "" where it was.
    const std::string& log_trouble() const { return log_trouble_; }

private:
    MatchServer(std::unique_ptr<WorldSimulation> simulation,
                std::unique_ptr<LogWriter> log,
                const LockstepServerSettings& settings,
                Transport& transport);

    void receive();
    void execute(const SendRequest& request);
    void execute(const PersistRequest& request);
    void execute(const AdvanceRequest& request);
    void execute(const SnapshotRequest& request);
    void execute(const BundleRequest& request);
    void execute(const NotifyRequest& request);
    /// A client's request, which this session never makes.
    template <class Other>
    void execute(const Other& /*request*/) {
        static_assert(std::is_same_v<Other, CreateRequest> ||
                      std::is_same_v<Other, RestoreRequest> ||
                      std::is_same_v<Other, DesyncReportRequest>);
        LOCKWIND_ASSERT(false);
    }
    void record_events(Tick tick);
    Status record_session_event(const SessionEvent& event);
    Result<DesyncOutcome> trace_desync(const BundleRequest& request);
    void require_logged(const Status& status);
    void fail_log(const Error& error);
    void finish();

    std::unique_ptr<WorldSimulation> simulation_;
    std::unique_ptr<LogWriter> log_;
    LockstepServer session_;
    Transport& transport_;
    StateHistory history_;
    EventListener listener_;
    MatchFigures figures_;
    std::vector<DesyncOutcome> desyncs_;
    std::optional<std::uint64_t> hash_; // of the tick that was just stepped, where due
    Tick recorded_tick_ = 0;            // newest one in the log
    bool failed_ = false;
    bool failure_told_ = false; // the list of requests in which it happened is over
    std::string log_trouble_;
    bool finished_ = false;
    std::vector<Packet> packets_;      // scratch
    std::vector<std::byte> encoded_;   // scratch
    std::vector<Event> logged_events_; // scratch
};

} // namespace lockwind
