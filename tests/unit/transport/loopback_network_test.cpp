#include "tests/unit/transport/sim_support.h"
#include "transport/sim/loopback_network.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

TEST(LoopbackNetwork, DeliversAtOnceAndInOrder) {
    const VirtualClock clock;
    LoopbackNetwork network(clock);
    const auto server = network.open(kServerAddress);
    const auto client = network.open(5);
    EXPECT_EQ(client->send(0, Channel::best_effort, bytes_of("a")), SendResult::sent);
    EXPECT_EQ(client->send(0, Channel::reliable, bytes_of("b")), SendResult::sent);
    EXPECT_EQ(received(*server), (Texts{"5:a", "5:b!"}));
    EXPECT_EQ(received(*server), Texts{});
}

TEST(LoopbackNetwork, IsAStar) {
    const VirtualClock clock;
    LoopbackNetwork network(clock);
    const auto server = network.open(kServerAddress);
    const auto one = network.open(1);
    const auto two = network.open(2);
    (void)server->send(kEveryAddress, Channel::reliable, bytes_of("all"));
    (void)server->send(2, Channel::reliable, bytes_of("two"));
    (void)server->send(3, Channel::reliable, bytes_of("nobody"));
    (void)one->send(2, Channel::reliable, bytes_of("psst"));
    (void)one->send(kEveryAddress, Channel::reliable, bytes_of("hey"));
    EXPECT_EQ(received(*one), (Texts{"0:all!"}));
    EXPECT_EQ(received(*two), (Texts{"0:all!", "0:two!"}));
    EXPECT_EQ(received(*server), Texts{});
}

TEST(LoopbackNetwork, CountsPeersAndTraffic) {
    VirtualClock clock;
    LoopbackNetwork network(clock);
    auto client = network.open(1);
    EXPECT_EQ(client->peer_count(), 0U);
    const auto server = network.open(kServerAddress);
    const auto other = network.open(2);
    EXPECT_EQ(client->peer_count(), 1U);
    EXPECT_EQ(server->peer_count(), 2U);
    (void)client->send(0, Channel::reliable, bytes_of("four"));
    (void)received(*server);
    EXPECT_EQ(client->stats().packets_out, 1U);
    EXPECT_EQ(client->stats().bytes_out, 4U);
    EXPECT_EQ(server->stats().packets_in, 1U);
    EXPECT_EQ(server->stats().bytes_in, 4U);
    client.reset();
    EXPECT_EQ(server->peer_count(), 1U);
    clock.advance_to(17);
    server->wait_until(1'000);
    EXPECT_EQ(server->clock_us(), 17U);
}

} // namespace
} // namespace lockwind
