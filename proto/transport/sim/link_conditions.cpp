#include "transport/sim/link_conditions.h"

#include <array>
#include <optional>
#include <set>
#include <span>
#include <string>

namespace lockwind {
namespace {

struct Unit {
    std::string_view name;
    std::uint64_t scale = 1; // of the stored unit
};

constexpr std::array<Unit, 3> kTimeUnits = {{{"us", 1}, {"ms", 1'000}, {"s", 1'000'000}}};
constexpr std::array<Unit, 1> kChanceUnits = {{{"%", kPartsPerMillion / 100}}};
constexpr std::array<Unit, 2> kBandwidthUnits = {{{"kB/s", 1'000}, {"MB/s", 1'000'000}}};
constexpr std::uint64_t kBandwidthMax = 100'000'000'000; // bytes per second

struct Range {
    std::uint64_t min = 0;
    std::uint64_t max = 0;
    std::string_view text;
};

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// digits [ '.' digits ] times `scale`, exactly; none where it is no such number, does not come out
/// whole or has more than 12 digits.
std::optional<std::uint64_t> scaled_decimal(std::string_view text, std::uint64_t scale) {
    constexpr std::size_t kDigitsMax = 12;
    std::uint64_t digits = 0;
    std::uint64_t divisor = 1;
    bool fraction = false;
    std::size_t count = 0;
    for (const char c : text) {
        if (c == '.' && !fraction && count > 0) {
            fraction = true;
        } else if (is_digit(c) && count < kDigitsMax) {
            digits = digits * 10 + static_cast<std::uint64_t>(c - '0');
            divisor *= fraction ? 10 : 1;
            ++count;
        } else {
            return std::nullopt;
        }
    }
    if (count == 0 || text.back() == '.' || digits * scale % divisor != 0) {
        return std::nullopt;
    }
    return digits * scale / divisor; // < 10^12 * 10^6: no overflow
}

std::string unit_names(std::span<const Unit> units) {
    std::string names;
    for (std::size_t i = 0; i < units.size(); ++i) {
        names += (i == 0 ? "" : i + 1 == units.size() ? " or " : ", ");
        names += units[i].name;
    }
    return names;
}

Result<std::uint64_t> parse_quantity(std::string_view key,
                                     std::string_view text,
                                     std::span<const Unit> units,
                                     const Range& range) {
    std::size_t number_size = 0;
    while (number_size < text.size() && (is_digit(text[number_size]) || text[number_size] == '.')) {
        ++number_size;
    }
    const std::string_view unit_name = text.substr(number_size);
    for (const Unit& unit : units) {
        if (unit.name != unit_name) {
            continue;
        }
        const auto value = scaled_decimal(text.substr(0, number_size), unit.scale);
        if (value && *value >= range.min && *value <= range.max) {
            return *value;
        }
        break;
    }
    return Error{std::string(key) + " \"" + std::string(text) + "\": expected a number in " +
                 unit_names(units) + ", " + std::string(range.text)};
}

Status set_field(std::string_view key, std::string_view value, LinkConditions& out) {
    const auto set = [&](std::span<const Unit> units, const Range& range, auto& field) -> Status {
        const Result<std::uint64_t> quantity = parse_quantity(key, value, units, range);
        if (!quantity) {
            return quantity.error();
        }
        field = static_cast<std::decay_t<decltype(field)>>(quantity.value());
        return Success{};
    };
    const Range time{0, kLinkDelayUsMax, "at most 60s"};
    const Range chance{0, kPartsPerMillion, "at most 100%"};
    if (key == "latency") {
        return set(kTimeUnits, time, out.latency_us);
    }
    if (key == "jitter") {
        return set(kTimeUnits, time, out.jitter_us);
    }
    if (key == "loss") {
        return set(kChanceUnits, chance, out.loss_ppm);
    }
    if (key == "duplicate") {
        return set(kChanceUnits, chance, out.duplicate_ppm);
    }
    if (key == "reorder") {
        return set(kChanceUnits, chance, out.reorder_ppm);
    }
    if (key == "bandwidth") {
        const Range bandwidth{1'000, kBandwidthMax, "at least 1kB/s"};
        return set(kBandwidthUnits, bandwidth, out.bandwidth_bytes_per_s);
    }
    return Error{"unknown link condition \"" + std::string(key) +
                 "\"; known are latency, jitter, loss, duplicate, reorder, bandwidth"};
}

} // namespace

Result<LinkConditions> parse_link_conditions(std::string_view text) {
    LinkConditions conditions;
    std::set<std::string_view> seen;
    bool more = true;
    while (more) {
        const std::size_t comma = text.find(',');
        more = comma != std::string_view::npos;
        const std::string_view item = text.substr(0, comma);
        text.remove_prefix(more ? comma + 1 : text.size());
        const std::size_t equals = item.find('=');
        if (equals == std::string_view::npos) {
            return Error{"link condition \"" + std::string(item) +
                         "\": expected key=value, as in latency=40ms,loss=2%"};
        }
        const std::string_view key = item.substr(0, equals);
        const Status set = set_field(key, item.substr(equals + 1), conditions);
        if (!set) {
            return set.error();
        }
        if (!seen.insert(key).second) {
            return Error{"link condition " + std::string(key) + " is given twice"};
        }
    }
    if (conditions.jitter_us > conditions.latency_us) {
        return Error{"jitter is above latency: packets would arrive before they are sent"};
    }
    return conditions;
}

} // namespace lockwind
