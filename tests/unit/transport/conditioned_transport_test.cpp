#include "tests/unit/transport/sim_support.h"
#include "transport/sim/conditioned_transport.h"
#include "transport/sim/loopback_network.h"

#include <gtest/gtest.h>
#include <limits>

namespace lockwind {
namespace {

/// A wire to the server whose time passes while it waits, and which may refuse packets.
class TestWire final : public Transport {
public:
    SendResult send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) override {
        if (bytes.size() > room_bytes) {
            return SendResult::full;
        }
        sent.push_back({to, channel, {bytes.begin(), bytes.end()}});
        return SendResult::sent;
    }
    void receive(std::vector<Packet>& out) override {
        for (Packet& packet : arriving) {
            out.push_back(std::move(packet));
        }
        arriving.clear();
    }
    void wait_until(std::uint64_t deadline_us) override {
        waits_us.push_back(deadline_us);
        clock.advance_to(deadline_us);
    }
    std::uint64_t clock_us() const override { return clock.now_us(); }
    std::uint32_t peer_count() const override { return 1; }
    TransportStats stats() const override { return {}; }

    std::size_t room_bytes = kPayloadSizeBytesMax; // full for what is larger
    std::vector<Packet> sent;                      // `from` holds the receiver
    std::vector<Packet> arriving;
    std::vector<std::uint64_t> waits_us;
    VirtualClock clock;
};

struct Fixture {
    explicit Fixture(const LinkConditions& conditions, std::uint64_t seed = 1) {
        auto owned = std::make_unique<TestWire>();
        wire = owned.get();
        transport = std::make_unique<ConditionedTransport>(std::move(owned), conditions, seed);
    }

    Texts sent() const {
        Texts texts;
        for (const Packet& packet : wire->sent) {
            texts.emplace_back(reinterpret_cast<const char*>(packet.bytes.data()),
                               packet.bytes.size());
        }
        return texts;
    }

    TestWire* wire = nullptr;
    std::unique_ptr<ConditionedTransport> transport;
};

LinkConditions delay(std::uint32_t latency_us) {
    LinkConditions conditions;
    conditions.latency_us = latency_us;
    return conditions;
}

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

TEST(ConditionedTransport, IsTransparentOnAPerfectLink) {
    Fixture f(delay(0));
    EXPECT_EQ(f.transport->send(0, Channel::best_effort, bytes_of("a")), SendResult::sent);
    EXPECT_EQ(f.sent(), Texts{"a"});
    f.wire->arriving.push_back({0, Channel::reliable, bytes_of("b")});
    EXPECT_EQ(received(*f.transport), Texts{"0:b!"});
    EXPECT_EQ(f.transport->peer_count(), 1U);
    EXPECT_EQ(f.transport->next_due_us(), kNever);
}

TEST(ConditionedTransport, DelaysBothDirections) {
    Fixture f(delay(40'000));
    (void)f.transport->send(7, Channel::best_effort, bytes_of("out"));
    f.wire->arriving.push_back({0, Channel::best_effort, bytes_of("in")});
    EXPECT_EQ(received(*f.transport), Texts{});
    EXPECT_EQ(f.sent(), Texts{});
    EXPECT_EQ(f.transport->next_due_us(), 40'000U);
    f.wire->clock.advance_to(39'999);
    EXPECT_EQ(received(*f.transport), Texts{});
    EXPECT_EQ(f.sent(), Texts{});
    f.wire->clock.advance_to(40'000);
    EXPECT_EQ(received(*f.transport), Texts{"0:in"});
    ASSERT_EQ(f.sent(), Texts{"out"});
    EXPECT_EQ(f.wire->sent[0].from, 7U) << "the receiver";
    EXPECT_EQ(f.transport->stats().packets_out, 1U);
    EXPECT_EQ(f.transport->stats().bytes_out, 3U);
    EXPECT_EQ(f.transport->stats().packets_in, 1U);
    EXPECT_EQ(f.transport->stats().bytes_in, 2U);
}

TEST(ConditionedTransport, SendsWhatIsDueWhileItWaits) {
    Fixture f(delay(40'000));
    (void)f.transport->send(0, Channel::reliable, bytes_of("out"));
    f.transport->wait_until(100'000);
    EXPECT_EQ(f.wire->waits_us, (std::vector<std::uint64_t>{40'000, 100'000}));
    EXPECT_EQ(f.sent(), Texts{"out"});
}

TEST(ConditionedTransport, WakesUpWhenAPacketIsDue) {
    Fixture f(delay(40'000));
    f.wire->arriving.push_back({0, Channel::best_effort, bytes_of("in")});
    f.transport->wait_until(100'000);
    EXPECT_EQ(f.transport->clock_us(), 40'000U);
    EXPECT_EQ(received(*f.transport), Texts{"0:in"});
}

TEST(ConditionedTransport, ReturnsAtOnceOnAVirtualClock) {
    const VirtualClock clock;
    LoopbackNetwork network(clock);
    const auto server = network.open(kServerAddress);
    ConditionedTransport client(network.open(1), delay(40'000), 1);
    (void)client.send(0, Channel::reliable, bytes_of("a"));
    client.wait_until(1'000'000);
    EXPECT_EQ(client.clock_us(), 0U);
}

TEST(ConditionedTransport, LosesAndDoublesByItsSeed) {
    LinkConditions conditions = delay(1'000);
    conditions.loss_ppm = 200'000;
    conditions.duplicate_ppm = 100'000;
    const auto run = [&](std::uint64_t seed) {
        Fixture f(conditions, seed);
        for (int i = 0; i < 1'000; ++i) {
            (void)f.transport->send(0, Channel::best_effort, bytes_of(std::to_string(i)));
            f.wire->arriving.push_back({0, Channel::best_effort, bytes_of(std::to_string(i))});
        }
        (void)received(*f.transport);
        f.wire->clock.advance_to(1'000);
        const Texts in = received(*f.transport);
        return std::pair{f.sent(), in};
    };
    const auto [sent, in] = run(5);
    EXPECT_EQ(run(5), std::pair(sent, in));
    EXPECT_NE(run(6), std::pair(sent, in));
    // 1,000 x 0.8 x 1.1 = 880, five standard deviations of about 14.
    EXPECT_NEAR(static_cast<double>(sent.size()), 880, 75);
    EXPECT_NEAR(static_cast<double>(in.size()), 880, 75);
    EXPECT_NE(sent.size(), in.size()) << "each direction has its own draws";
}

TEST(ConditionedTransport, KeepsReliableOrderOverAFullWire) {
    Fixture f(delay(1'000));
    f.wire->room_bytes = 1;
    for (const char* text : {"one", "2", "3"}) {
        EXPECT_EQ(f.transport->send(0, Channel::reliable, bytes_of(text)), SendResult::sent);
    }
    (void)f.transport->send(0, Channel::best_effort, bytes_of("gone"));
    f.wire->clock.advance_to(1'000);
    (void)received(*f.transport);
    EXPECT_EQ(f.sent(), Texts{}) << "there is room for 2, but it waits for the one before it";
    EXPECT_EQ(f.transport->next_due_us(), 2'000U) << "not at once: that would spin";
    f.wire->room_bytes = kPayloadSizeBytesMax;
    f.wire->clock.advance_to(2'000);
    (void)received(*f.transport);
    EXPECT_EQ(f.sent(), (Texts{"one", "2", "3"}));
}

TEST(ConditionedTransport, IsFullWhenTooMuchIsOnItsWay) {
    Fixture f(delay(1'000));
    const std::vector<std::byte> large(kPayloadSizeBytesMax);
    std::size_t sent = 0;
    while (sent < 1'000 && f.transport->send(0, Channel::reliable, large) == SendResult::sent) {
        ++sent;
    }
    EXPECT_EQ(sent, ConditionedTransport::kBacklogSizeBytesMax / kPayloadSizeBytesMax);
    f.wire->clock.advance_to(1'000);
    (void)received(*f.transport);
    EXPECT_EQ(f.transport->send(0, Channel::reliable, large), SendResult::sent);
}

TEST(ConditionedTransport, SendsAFarewellThatIsStillOnItsWay) {
    const VirtualClock clock;
    LoopbackNetwork network(clock);
    const auto server = network.open(kServerAddress);
    auto client = std::make_unique<ConditionedTransport>(network.open(1), delay(40'000), 1);
    (void)client->send(0, Channel::reliable, bytes_of("last"));
    (void)client->send(0, Channel::reliable, bytes_of("bye"));
    client.reset();
    EXPECT_EQ(received(*server), (Texts{"1:last!", "1:bye!"}));
}

} // namespace
} // namespace lockwind
