#include "tests/unit/transport/sim_support.h"
#include "transport/sim/simulated_network.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

LinkConditions wan() {
    LinkConditions conditions;
    conditions.latency_us = 40'000;
    conditions.jitter_us = 10'000;
    conditions.loss_ppm = 100'000;
    conditions.duplicate_ppm = 50'000;
    conditions.reorder_ppm = 50'000;
    return conditions;
}

LinkConditions delay(std::uint32_t latency_us) {
    LinkConditions conditions;
    conditions.latency_us = latency_us;
    return conditions;
}

/// Advances to each arrival in turn until nothing is under way; "time from:text" of all of them.
Texts run_dry(SimulatedNetwork& network, VirtualClock& clock, Transport& transport) {
    Texts texts;
    for (const std::string& text : received(transport)) {
        texts.push_back(std::to_string(clock.now_us()) + " " + text);
    }
    while (const auto next_us = network.next_arrival_us()) {
        clock.advance_to(*next_us);
        for (const std::string& text : received(transport)) {
            texts.push_back(std::to_string(clock.now_us()) + " " + text);
        }
    }
    return texts;
}

/// What the server gets of 500 packets of each channel from client 1, beside `noise` packets from
/// client 2.
Texts schedule(std::uint64_t seed, int noise) {
    VirtualClock clock;
    SimulatedNetwork network(clock, seed, wan());
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    const auto other = network.open(2);
    Texts texts;
    for (int i = 0; i < 500; ++i) {
        clock.advance_by(16'667);
        (void)client->send(0, Channel::best_effort, bytes_of(std::to_string(i)));
        (void)client->send(0, Channel::reliable, bytes_of(std::to_string(i)));
        for (int n = 0; n < noise; ++n) {
            (void)other->send(0, Channel::best_effort, bytes_of("noise"));
        }
    }
    for (const std::string& text : run_dry(network, clock, *server)) {
        if (text.find("noise") == std::string::npos) {
            texts.push_back(text);
        }
    }
    return texts;
}

TEST(SimulatedNetwork, RepeatsItselfFromItsSeed) {
    const Texts first = schedule(42, 1);
    EXPECT_GT(first.size(), 900U);
    EXPECT_EQ(schedule(42, 1), first);
    EXPECT_NE(schedule(43, 1), first);
}

TEST(SimulatedNetwork, KeepsLinksIndependent) {
    EXPECT_EQ(schedule(42, 0), schedule(42, 3));
}

TEST(SimulatedNetwork, GivesEachLinkItsOwnFate) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 42, wan());
    const auto server = network.open(kServerAddress);
    const auto one = network.open(1);
    const auto two = network.open(2);
    for (int i = 0; i < 200; ++i) {
        (void)one->send(0, Channel::best_effort, bytes_of(std::to_string(i)));
        (void)two->send(0, Channel::best_effort, bytes_of(std::to_string(i)));
    }
    clock.advance_to(1'000'000);
    Texts from_one;
    Texts from_two;
    for (const std::string& text : received(*server)) {
        (text[0] == '1' ? from_one : from_two).push_back(text.substr(2));
    }
    EXPECT_GT(from_one.size(), 150U);
    EXPECT_GT(from_two.size(), 150U);
    EXPECT_NE(from_one, from_two);
}

TEST(SimulatedNetwork, DeliversAtTheArrivalAndNotBefore) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1, delay(40'000));
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    EXPECT_EQ(network.next_arrival_us(), std::nullopt);
    clock.advance_to(1'000);
    (void)client->send(0, Channel::best_effort, bytes_of("a"));
    EXPECT_EQ(network.next_arrival_us(), 41'000U);
    server->wait_until(50'000);
    EXPECT_EQ(server->clock_us(), 1'000U) << "only the test moves the clock";
    clock.advance_to(40'999);
    EXPECT_EQ(received(*server), Texts{});
    clock.advance_to(41'000);
    EXPECT_EQ(received(*server), Texts{"1:a"});
    EXPECT_EQ(network.next_arrival_us(), std::nullopt);
}

TEST(SimulatedNetwork, IsAStar) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1);
    const auto server = network.open(kServerAddress);
    const auto one = network.open(1);
    const auto two = network.open(2);
    (void)server->send(kEveryAddress, Channel::reliable, bytes_of("all"));
    (void)server->send(2, Channel::best_effort, bytes_of("two"));
    (void)one->send(2, Channel::reliable, bytes_of("psst"));
    EXPECT_EQ(received(*one), (Texts{"0:all!"}));
    EXPECT_EQ(received(*two), (Texts{"0:all!", "0:two"}));
    EXPECT_EQ(received(*server), Texts{});
}

TEST(SimulatedNetwork, SetsConditionsByDirection) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1, delay(10'000));
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    network.set_conditions(1, kServerAddress, delay(70'000));
    (void)client->send(0, Channel::reliable, bytes_of("up"));
    (void)server->send(1, Channel::reliable, bytes_of("down"));
    clock.advance_to(10'000);
    EXPECT_EQ(received(*client), Texts{"0:down!"});
    EXPECT_EQ(network.next_arrival_us(), 70'000U);
}

TEST(SimulatedNetwork, HoldsReliablePacketsOverAShortCut) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1, delay(10'000));
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    (void)client->send(0, Channel::best_effort, bytes_of("before"));
    network.set_link_up(1, false);
    (void)client->send(0, Channel::best_effort, bytes_of("lost"));
    (void)client->send(0, Channel::reliable, bytes_of("kept 1"));
    (void)client->send(0, Channel::reliable, bytes_of("kept 2"));
    (void)server->send(1, Channel::reliable, bytes_of("down"));
    clock.advance_to(SimulatedNetwork::kLeaseUs - 1);
    EXPECT_EQ(received(*server), Texts{"1:before"}) << "it was under way";
    EXPECT_EQ(server->peer_count(), 1U);
    network.set_link_up(1, true);
    (void)client->send(0, Channel::reliable, bytes_of("after"));
    clock.advance_by(10'000);
    EXPECT_EQ(received(*server), (Texts{"1:kept 1!", "1:kept 2!", "1:after!"}));
    EXPECT_EQ(received(*client), Texts{"0:down!"});
}

TEST(SimulatedNetwork, LosesAPeerThatIsCutForLonger) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1);
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    const auto other = network.open(2);
    network.set_link_up(1, false);
    (void)client->send(0, Channel::reliable, bytes_of("lost"));
    clock.advance_to(SimulatedNetwork::kLeaseUs);
    EXPECT_EQ(server->peer_count(), 1U);
    EXPECT_EQ(client->peer_count(), 0U);
    EXPECT_EQ(other->peer_count(), 1U);
    (void)server->send(kEveryAddress, Channel::reliable, bytes_of("others"));
    network.set_link_up(1, true);
    EXPECT_EQ(server->peer_count(), 2U);
    EXPECT_EQ(client->peer_count(), 1U);
    (void)client->send(0, Channel::reliable, bytes_of("heard"));
    EXPECT_EQ(received(*server), Texts{"1:heard!"});
    EXPECT_EQ(received(*client), Texts{});
    EXPECT_EQ(received(*other), Texts{"0:others!"});
}

TEST(SimulatedNetwork, IsFullWhenTooMuchWaitsForAPeer) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1);
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    const auto other = network.open(2);
    network.set_link_up(1, false);
    const std::vector<std::byte> large(kPayloadSizeBytesMax);
    std::size_t sent = 0;
    while (sent < 1'000 &&
           server->send(kEveryAddress, Channel::reliable, large) == SendResult::sent) {
        ++sent;
    }
    EXPECT_EQ(sent, SimulatedNetwork::kBacklogSizeBytesMax / kPayloadSizeBytesMax);
    EXPECT_EQ(server->stats().packets_out, sent);
    EXPECT_EQ(server->send(2, Channel::reliable, large), SendResult::sent);
    EXPECT_EQ(server->send(1, Channel::best_effort, large), SendResult::sent);
    network.set_link_up(1, true);
    EXPECT_EQ(server->send(1, Channel::reliable, large), SendResult::sent);
    EXPECT_EQ(received(*client).size(), sent + 1);
    EXPECT_EQ(received(*other).size(), sent + 1);
}

TEST(SimulatedNetwork, GivesANewEndpointNothingOld) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1, delay(10'000));
    const auto server = network.open(kServerAddress);
    auto client = network.open(1);
    (void)server->send(1, Channel::reliable, bytes_of("under way"));
    network.set_link_up(1, false);
    (void)server->send(1, Channel::reliable, bytes_of("waiting"));
    client.reset();
    EXPECT_EQ(server->peer_count(), 0U);
    client = network.open(1);
    network.set_link_up(1, true);
    EXPECT_EQ(run_dry(network, clock, *client), Texts{});
}

TEST(SimulatedNetwork, CarriesTheLastWordsOfAnEndpoint) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1, delay(10'000));
    const auto server = network.open(kServerAddress);
    auto client = network.open(1);
    (void)client->send(0, Channel::reliable, bytes_of("bye"));
    client.reset();
    EXPECT_EQ(run_dry(network, clock, *server), Texts{"10000 1:bye!"});
}

TEST(SimulatedNetwork, CutsOneDirectionAndLeavesTheOther) {
    VirtualClock clock;
    SimulatedNetwork network(clock, 1);
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    network.set_direction_up(1, kServerAddress, false);
    (void)client->send(0, Channel::best_effort, bytes_of("lost"));
    (void)client->send(0, Channel::reliable, bytes_of("kept"));
    (void)server->send(1, Channel::best_effort, bytes_of("heard"));
    EXPECT_EQ(received(*server), Texts{});
    EXPECT_EQ(received(*client), Texts{"0:heard"});
    network.set_direction_up(1, kServerAddress, true);
    EXPECT_EQ(received(*server), Texts{"1:kept!"});

    network.set_direction_up(kServerAddress, 1, false);
    (void)server->send(1, Channel::reliable, bytes_of("waits too long"));
    clock.advance_by(SimulatedNetwork::kLeaseUs);
    EXPECT_EQ(client->peer_count(), 0U);
    EXPECT_EQ(server->peer_count(), 0U);
    network.set_direction_up(kServerAddress, 1, true);
    EXPECT_EQ(client->peer_count(), 1U);
    EXPECT_EQ(received(*client), Texts{});
}

TEST(SimulatedNetwork, CountsWhatItDoesToPackets) {
    VirtualClock clock;
    LinkConditions conditions = delay(10'000);
    SimulatedNetwork network(clock, 1, conditions);
    const auto server = network.open(kServerAddress);
    const auto client = network.open(1);
    (void)client->send(0, Channel::best_effort, bytes_of("on time"));
    EXPECT_EQ(network.stats(), NetworkStats{});

    conditions.duplicate_ppm = kPartsPerMillion;
    network.set_conditions(1, kServerAddress, conditions);
    (void)client->send(0, Channel::best_effort, bytes_of("twice"));
    EXPECT_EQ(network.stats(), (NetworkStats{0, 1, 0}));

    network.set_conditions(1, kServerAddress, delay(5'000));
    (void)client->send(0, Channel::best_effort, bytes_of("overtakes"));
    EXPECT_EQ(network.stats(), (NetworkStats{0, 1, 1}));

    conditions.loss_ppm = kPartsPerMillion;
    network.set_conditions(1, kServerAddress, conditions);
    (void)client->send(0, Channel::best_effort, bytes_of("lost"));
    network.set_link_up(1, false);
    (void)client->send(0, Channel::best_effort, bytes_of("cut off"));
    (void)client->send(0, Channel::reliable, bytes_of("waits"));
    EXPECT_EQ(network.stats(), (NetworkStats{2, 1, 1}));
    clock.advance_by(SimulatedNetwork::kLeaseUs);
    network.set_link_up(1, true);
    EXPECT_EQ(network.stats(), (NetworkStats{3, 1, 1}));
}

} // namespace
} // namespace lockwind
