#include "bot/bot.h"
#include "codec/codec.h"
#include "forensics/match_simulation.h"
#include "forensics/replay.h"
#include "match/match_server.h"
#include "scene/scene.h"
#include "tests/support/foreign_peer.h"
#include "tests/support/match_harness.h"
#include "tests/unit/transport_dds/dds_support.h"

#include "lockwind/rng.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <iostream>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

// A real match over DDS in which one peer does all it can to spoil it.
namespace lockwind {
namespace {

constexpr Tick kTicks = 240;
constexpr std::uint32_t kStrangerAddress = 4711;

/// A server, two honest bots and a stranger's endpoint on one DDS domain.
class HostileMatch : public ::testing::Test {
protected:
    void SetUp() override {
        const ServerOnDomain opened = open_server();
        ASSERT_TRUE(opened.participant);
        domain_ = opened.domain;
        server_process_ = opened.participant;
        server_transport_ = endpoint(server_process_, kMatch, kServerPeer);
        MatchSettings settings;
        settings.config.match = kMatch;
        settings.config.mode = "lockstep";
        settings.config.scene_name = "swarm_small";
        settings.config.scene_text = load_scene_text("swarm_small").value();
        settings.config.players = players_;
        settings.config.ticks = kTicks;
        settings.join_timeout_ms = 2000;
        settings.log_path = folder_.file("match.log");
        Result<std::unique_ptr<MatchServer>> server =
            MatchServer::create(settings, *server_transport_);
        ASSERT_TRUE(server.ok()) << server.error().message;
        server_ = std::move(server).value();
        client_process_ = open_client(domain_);
        for (std::uint32_t index = 0; index < 2; ++index) {
            seats_[index].transport = endpoint(client_process_, kMatch, 100 + index);
            BotSettings bot;
            bot.token = bot.seed = index + 1;
            seats_[index].bot = Bot::create(bot, *seats_[index].transport).value();
        }
        stranger_process_ = open_client(domain_);
        stranger_ = endpoint(stranger_process_, kMatch, kStrangerAddress);
        ASSERT_TRUE(run_until([&] { return tick() >= 30 && stranger_->peer_count() > 0; }));
    }

    /// Runs the match in real time; false where it takes more than kPatienceUs.
    template <class Done>
    bool run_until(Done done) {
        const std::uint64_t end_us = DdsParticipant::clock_us() + kPatienceUs;
        while (!done()) {
            if (DdsParticipant::clock_us() > end_us) {
                return false;
            }
            poll();
        }
        return true;
    }

    void poll() {
        server_->poll();
        for (Seat& seat : seats_) {
            seat.bot->poll();
        }
        server_transport_->wait_until(
            std::min(server_->next_deadline_us(), server_transport_->clock_us() + 1000));
    }

    Tick tick() const { return server_->session().confirmed_tick(); }
    std::uint64_t counted(Violation violation) const {
        return server_->session().counters().violations.of(violation);
    }

    void say(DdsTransport& from, Channel channel, const Message& message) {
        std::vector<std::byte> bytes;
        encode(message, bytes);
        static_cast<void>(from.send(kServerPeer, channel, bytes));
    }

    /// The honest played to the end, and the log replays to the server's state.
    void expect_honest_end(std::uint32_t honest) {
        ASSERT_TRUE(run_until(
            [&] { return server_->ended() && seats_[0].bot->ended() && seats_[1].bot->ended(); }));
        const LockstepServer& session = server_->session();
        EXPECT_EQ(session.end_reason(), EndReason::complete) << session.end_message();
        EXPECT_EQ(tick(), kTicks);
        for (std::uint32_t index = 0; index < honest; ++index) {
            EXPECT_EQ(seats_[index].bot->session().state_hash(), session.state_hash());
        }
        Result<LogReader> log = LogReader::open(server_->log().path());
        ASSERT_TRUE(log.ok());
        const auto simulation = create_match_simulation(log.value().header().config);
        ReplayOptions options;
        options.verify = true;
        const Result<ReplayResult> replayed = replay(log.value(), *simulation.value(), options);
        ASSERT_TRUE(replayed.ok());
        EXPECT_FALSE(replayed.value().first_bad_tick.has_value());
        EXPECT_EQ(replayed.value().state_hash, session.state_hash());
        std::cout << "ignored: ";
        for (std::size_t index = 0; index < kViolationCount; ++index) {
            const auto violation = static_cast<Violation>(index);
            if (counted(violation) > 0) {
                std::cout << counted(violation) << " " << to_string(violation) << "  ";
            }
        }
        std::cout << "\n";
    }

    static constexpr const char* kMatch = "hostile";

    struct Seat {
        std::unique_ptr<DdsTransport> transport;
        std::unique_ptr<Bot> bot;
    };

    std::uint32_t players_ = 2;
    testing::TemporaryFolder folder_;
    std::uint32_t domain_ = 0;
    std::shared_ptr<DdsParticipant> server_process_;
    std::shared_ptr<DdsParticipant> client_process_;
    std::shared_ptr<DdsParticipant> stranger_process_;
    std::unique_ptr<DdsTransport> server_transport_;
    std::unique_ptr<MatchServer> server_;
    Seat seats_[2];
    std::unique_ptr<DdsTransport> stranger_;
};

/// Sends bytes to the UDP port where the server's DDS listens.
class UdpSender {
public:
    explicit UdpSender(std::uint32_t domain) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
        server_.sin_family = AF_INET;
        server_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        server_.sin_port = htons(static_cast<std::uint16_t>(dds_server_port(domain)));
    }
    UdpSender(const UdpSender&) = delete;
    UdpSender& operator=(const UdpSender&) = delete;
    ~UdpSender() { ::close(socket_); }

    std::size_t send(std::string_view bytes) const {
        constexpr std::size_t kDatagramBytes = 65'000;
        std::size_t sent = 0;
        while (!bytes.empty()) {
            const std::string_view datagram = bytes.substr(0, kDatagramBytes);
            const auto count = ::sendto(socket_,
                                        datagram.data(),
                                        datagram.size(),
                                        0,
                                        reinterpret_cast<const sockaddr*>(&server_),
                                        sizeof(server_));
            sent += count > 0 ? static_cast<std::size_t>(count) : 0;
            bytes.remove_prefix(datagram.size());
        }
        return sent;
    }

private:
    int socket_;
    sockaddr_in server_{};
};

TEST_F(HostileMatch, StandsAThousandRandomMegabytes) {
    const testing::ForeignPeer stranger(domain_, kMatch, DDS_RELIABILITY_RELIABLE);
    ASSERT_TRUE(run_until([&] { return stranger.matched(); }));
    const UdpSender udp(domain_);
    std::string noise(1U << 20U, 0);
    for (std::size_t index = 0; index < noise.size(); ++index) {
        noise[index] = static_cast<char>(random_below(9, 1, index, 256));
    }
    std::size_t sent = 0;
    int written = 0;
    for (int packet = 0; packet < 1000; ++packet) {
        noise[static_cast<std::size_t>(packet)] ^= 0x5a;
        sent += udp.send(noise);
        // And as the payload of a sound envelope.
        const std::string_view payload = std::string_view(noise).substr(0, 60'000);
        written += stranger.write(stranger.match_id(), kStrangerAddress + 1, payload) ? 1 : 0;
        poll();
    }
    expect_honest_end(2);
    std::cout << sent << " random bytes to the port, " << written << " random payloads\n";
    EXPECT_GT(sent, 900'000'000U);
    EXPECT_GT(counted(Violation::undecodable), 500U);
    EXPECT_EQ(server_->session().counters().drops, 0U);
}

TEST_F(HostileMatch, StandsAStrangerWhoSpeaksForOthers) {
    InputBatch inputs;
    inputs.slot = 0;
    inputs.first_tick = tick() + 4;
    inputs.inputs.resize(8);
    HashReport report;
    report.slot = 1;
    report.entries = {{tick(), 1}};
    for (int i = 0; i < 500; ++i) {
        say(*stranger_, Channel::best_effort, inputs);
        say(*stranger_, Channel::reliable, report);
        say(*stranger_, Channel::reliable, End{EndReason::left, 0, 1, ""});
        say(*stranger_,
            Channel::reliable,
            Hello{kProtocolVersion, std::string(sim_version()), "stranger", 1, 1});
        poll();
    }
    expect_honest_end(2);
    EXPECT_GT(counted(Violation::unknown_peer), 500U);
    EXPECT_EQ(server_->session().counters().drops, 0U);
    EXPECT_EQ(server_->session().counters().desyncs, 0U);
}

TEST_F(HostileMatch, DropsAPlayerWhoBreaksTheRulesAndPlaysOn) {
    const Slot slot = seats_[1].bot->session().slot();
    InputBatch inputs;
    inputs.slot = static_cast<Slot>(1 - slot);
    inputs.inputs.resize(1);
    for (int i = 0; i < 200; ++i) {
        inputs.first_tick = tick() + 3;
        say(*seats_[1].transport, Channel::best_effort, inputs);
        poll();
    }
    expect_honest_end(1);
    EXPECT_GT(counted(Violation::wrong_slot), 64U);
    EXPECT_EQ(server_->session().counters().drops, 1U);
    EXPECT_EQ(server_->session().slot_status(slot).state, SlotState::left);
    EXPECT_TRUE(seats_[1].bot->session().refused());
}

TEST_F(HostileMatch, DropsAPlayerWhoFloodsTheServer) {
    const InputBatch inputs = [&] {
        InputBatch batch;
        batch.slot = seats_[1].bot->session().slot();
        batch.confirmed_tick = tick();
        batch.first_tick = tick() + 1;
        return batch; // empty: only heard
    }();
    for (int i = 0; i < 600; ++i) {
        for (int j = 0; j < 30; ++j) {
            say(*seats_[1].transport, Channel::reliable, inputs);
        }
        poll();
    }
    expect_honest_end(1);
    EXPECT_GT(counted(Violation::message_flood), 64U);
    EXPECT_EQ(server_->session().counters().drops, 1U);
}

/// A match with a seat that is free.
class MismatchedClient : public HostileMatch {
protected:
    MismatchedClient() { players_ = 3; }

    /// What the server answers the stranger, of the given kind; an empty one where nothing comes.
    template <class Kind>
    Kind answer() {
        std::vector<Packet> packets;
        std::optional<Kind> found;
        EXPECT_TRUE(run_until([&] {
            packets.clear();
            stranger_->receive(packets);
            for (const Packet& packet : packets) {
                const Result<Message> message = decode(packet.bytes);
                const Kind* kind = message.ok() ? std::get_if<Kind>(&message.value()) : nullptr;
                found = kind != nullptr ? std::optional(*kind) : found;
            }
            return found.has_value();
        }));
        return found.value_or(Kind());
    }
};

TEST_F(MismatchedClient, OfAnotherVersionIsToldBoth) {
    say(*stranger_,
        Channel::reliable,
        Hello{kProtocolVersion, "0123456789abcdef", "a build of last week", 77, 1});
    const Refuse refuse = answer<Refuse>();
    EXPECT_EQ(refuse.reason, RefuseReason::sim_version);
    EXPECT_EQ(refuse.field, "sim_version");
    EXPECT_EQ(refuse.message,
              "the server simulates with version " + std::string(sim_version()) +
                  ", the client with 0123456789abcdef");
    expect_honest_end(2);
    EXPECT_EQ(counted(Violation::bad_hello), 1U);
    EXPECT_EQ(server_->session().counters().joins, 2U);
}

// Scene and seed come from the server; who builds another world of them has another state.
TEST_F(MismatchedClient, OfAnotherSceneOrSeedIsToldTheStateHash) {
    say(*stranger_,
        Channel::reliable,
        Hello{kProtocolVersion, std::string(sim_version()), "stranger", 77, 1});
    const Welcome welcome = answer<Welcome>();
    EXPECT_EQ(welcome.slot, 2U);
    MatchConfig config = welcome.config;
    ++config.seed;
    const auto simulation = create_match_simulation(config);
    ASSERT_TRUE(simulation.ok());
    say(*stranger_,
        Channel::reliable,
        Ready{welcome.resume_tick, simulation.value()->state_hash()});
    const Refuse refuse = answer<Refuse>();
    EXPECT_EQ(refuse.field, "state_hash");
    EXPECT_NE(refuse.message.find("the server has "), std::string::npos) << refuse.message;
    expect_honest_end(2);
    EXPECT_EQ(counted(Violation::bad_state_hash), 1U);
    EXPECT_EQ(server_->session().counters().desyncs, 0U);
    EXPECT_EQ(server_->session().counters().joins, 2U);
}

} // namespace
} // namespace lockwind
