#include "transport/sim/link_model.h"

#include "lockwind/assert.h"

#include <algorithm>

namespace lockwind {
namespace {

/// The finalizer of splitmix64: Steele, Lea, Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014.
std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
}

} // namespace

LinkModel::LinkModel(const LinkConditions& conditions, std::uint64_t seed) : seed_(seed) {
    set_conditions(conditions);
}

void LinkModel::set_conditions(const LinkConditions& conditions) {
    LOCKWIND_ASSERT(conditions.jitter_us <= conditions.latency_us);
    conditions_ = conditions;
}

Arrivals LinkModel::schedule(std::uint64_t now_us, Channel channel, std::size_t size_bytes) {
    ++packet_;
    if (channel == Channel::reliable) {
        return schedule_reliable(departure_us(now_us, size_bytes));
    }
    if (wire_free_us_ > now_us + kQueueUsMax) {
        return {};
    }
    const std::uint64_t sent_us = departure_us(now_us, size_bytes);
    if (chance(Draw::loss, conditions_.loss_ppm)) {
        return {};
    }
    Arrivals arrivals;
    arrivals.count = 1;
    arrivals.at_us[0] = sent_us + delay_us(Draw::delay);
    if (chance(Draw::reorder, conditions_.reorder_ppm)) {
        arrivals.at_us[0] += conditions_.reorder_delay_us;
    }
    if (chance(Draw::duplicate, conditions_.duplicate_ppm)) {
        arrivals.count = 2;
        arrivals.at_us[1] = sent_us + delay_us(Draw::duplicate_delay);
    }
    return arrivals;
}

Arrivals LinkModel::schedule_reliable(std::uint64_t sent_us) {
    std::uint64_t tries = 0;
    while (tries < kReliableTriesMax && chance(Draw::loss, conditions_.loss_ppm, tries)) {
        ++tries;
    }
    if (tries == kReliableTriesMax) {
        return {};
    }
    std::uint64_t at_us =
        sent_us + delay_us(Draw::delay) +
        tries * (2 * std::uint64_t{conditions_.latency_us} + kRetransmissionDelayUs);
    if (chance(Draw::reorder, conditions_.reorder_ppm)) {
        at_us += conditions_.reorder_delay_us;
    }
    reliable_arrival_us_ = std::max(reliable_arrival_us_, at_us);
    return {1, {reliable_arrival_us_, 0}};
}

std::uint64_t LinkModel::draw(Draw purpose, std::uint64_t try_index) const {
    const std::uint64_t stream = static_cast<std::uint64_t>(purpose) << 32U | try_index;
    return mix(mix(mix(seed_) ^ packet_) ^ stream);
}

bool LinkModel::chance(Draw purpose, std::uint32_t ppm, std::uint64_t try_index) const {
    // The high 32 bits, scaled to 0 .. 999,999.
    return ((draw(purpose, try_index) >> 32U) * kPartsPerMillion >> 32U) < ppm;
}

std::uint64_t LinkModel::delay_us(Draw purpose) const {
    const std::uint64_t width = 2 * std::uint64_t{conditions_.jitter_us} + 1;
    return conditions_.latency_us - conditions_.jitter_us + draw(purpose) % width;
}

std::uint64_t LinkModel::departure_us(std::uint64_t now_us, std::size_t size_bytes) {
    if (conditions_.bandwidth_bytes_per_s == 0) {
        return now_us;
    }
    wire_free_us_ = std::max(wire_free_us_, now_us) +
                    size_bytes * std::uint64_t{1'000'000} / conditions_.bandwidth_bytes_per_s;
    return wire_free_us_;
}

} // namespace lockwind
