#pragma once

#include "bot/bot.h"
#include "match/match_server.h"
#include "tests/swarm/oracle.h"
#include "tests/swarm/plant.h"
#include "tests/swarm/scenario.h"
#include "tests/swarm/seed_run.h"
#include "tests/swarm/watched_transport.h"
#include "transport/sim/simulated_network.h"
#include "transport/sim/virtual_clock.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lockwind::swarm {

/// One scenario, played: the shipped server and bots, each polled only when something has arrived
/// for it or its deadline has come, as their programs do.
class SwarmMatch {
public:
    SwarmMatch(std::uint64_t seed, const SwarmSettings& settings);
    ~SwarmMatch();

    SeedResult run();

private:
    struct Client;
    class ServerTap;
    class ClientTap;

    /// The begin or the end of a fault, an arrival, or the heal.
    struct Step {
        enum class Kind : std::uint8_t { arrive, begin, end, heal };
        std::uint64_t at_us = 0;
        Kind kind = Kind::heal;
        std::uint32_t index = 0; // of the fault or the client
    };

    void plan_steps();
    void open_server();
    void play();
    bool all_ended() const;
    bool take_too_long();
    std::uint64_t next_us() const;
    void poll_server();
    void poll_client(Client& client);

    void execute(const Step& step);
    void begin(const Fault& fault);
    void end(const Fault& fault);
    void heal();
    void start_client(Client& client);
    void stop_client(Client& client, const std::string& how);
    void set_conditions(const Client& client, const LinkConditions* both);

    void check_server();
    void check_client(const Client& client);
    void check_violations(const std::string& who, const ViolationCounts& violations);
    SeedResult result();
    void note(const std::string& text);

    std::uint64_t seed_;
    const SwarmSettings& settings_;
    Scenario scenario_;
    std::string log_path_;
    VirtualClock clock_;
    SimulatedNetwork network_;
    Oracle oracle_;
    std::vector<Step> steps_; // by time
    std::size_t next_step_ = 0;
    std::unique_ptr<WatchedTransport> server_transport_;
    std::unique_ptr<ServerTap> server_tap_;
    std::unique_ptr<MatchServer> server_;
    bool server_frozen_ = false;
    std::vector<std::unique_ptr<Client>> clients_;
    std::uint32_t next_address_ = 1;
    std::uint64_t end_by_us_ = 0; // 0: not healed yet
    std::uint64_t polls_ = 0;
    SwarmFigures figures_;
    std::vector<std::string> timeline_;
};

} // namespace lockwind::swarm
