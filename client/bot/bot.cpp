#include "bot/bot.h"

#include "bot/log_behaviour.h"
#include "codec/codec.h"
#include "forensics/desync_report.h"
#include "forensics/match_simulation.h"

#include "lockwind/player_input.h"

#include <algorithm>
#include <charconv>
#include <utility>
#include <variant>

namespace lockwind {

namespace {

/// Reported states that the server may still ask for.
constexpr std::size_t kHistoryCapacity = 256;

constexpr std::string_view kLogPrefix = "log:";

/// How often a bot that is not yet matched looks again.
constexpr std::uint64_t kConnectPollUs = 20'000;

template <class Number>
bool parse_number(std::string_view text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

/// Cuts the text up to the first comma off `rest`.
std::string_view next_item(std::string_view& rest) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view item = rest.substr(0, comma);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    return item;
}

} // namespace

Result<Corruption> parse_corruption(std::string_view text) {
    Corruption corruption;
    bool has_slot = false;
    bool has_tick = false;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::string_view item = next_item(rest);
        const std::string_view name = item.substr(0, item.find('='));
        const std::string_view value = item.substr(std::min(name.size() + 1, item.size()));
        bool valid = !value.empty();
        if (name == "slot") {
            has_slot = valid = valid && parse_number(value, corruption.slot);
        } else if (name == "tick") {
            has_tick = valid = valid && parse_number(value, corruption.tick) && corruption.tick > 0;
        } else if (name == "field") {
            corruption.field = value;
        } else {
            valid = false;
        }
        if (!valid) {
            return Error{"--corrupt: '" + std::string(item) +
                         "' is not one of slot=S, tick=T (from 1), field=SECTION.FIELD"};
        }
    }
    if (!has_slot || !has_tick) {
        return Error{"--corrupt needs slot=S and tick=T, as in --corrupt slot=1,tick=300"};
    }
    if (const Status known = WorldSimulation::check_field(corruption.field); !known) {
        return Error{"--corrupt: " + known.error().message};
    }
    return corruption;
}

Result<std::unique_ptr<Bot>> Bot::create(const BotSettings& settings, Transport& transport) {
    Result<std::unique_ptr<Behaviour>> behaviour =
        settings.behaviour.starts_with(kLogPrefix)
            ? make_log_behaviour(settings.behaviour.substr(kLogPrefix.size()))
            : make_behaviour(settings.behaviour, settings.seed);
    if (!behaviour) {
        return behaviour.error();
    }
    if (const Status known = WorldSimulation::check_phase(settings.corrupt_phase); !known) {
        return Error{"--corrupt-phase: " + known.error().message};
    }
    return std::unique_ptr<Bot>(new Bot(settings, std::move(behaviour).value(), transport));
}

Bot::Bot(const BotSettings& settings, std::unique_ptr<Behaviour> behaviour, Transport& transport)
    : settings_(settings), behaviour_(std::move(behaviour)), transport_(transport), session_([&] {
          LockstepClientSettings client;
          client.token = settings.token;
          client.connect_timeout_ms = settings.connect_timeout_ms;
          client.sim_version = sim_version();
          client.build_info = build_info();
          return client;
      }()),
      history_(kHistoryCapacity) {}

void Bot::poll() {
    // What is written before the server has matched this endpoint would be lost.
    connected_ = connected_ || transport_.peer_count() > 0;
    if (connected_) {
        receive();
        decide_inputs();
    }
    session_.update(transport_.clock_us());
    for (std::vector<Request> requests = session_.take_requests(); !requests.empty();
         requests = session_.take_requests()) {
        for (const Request& request : requests) {
            std::visit([this](const auto& wanted) { execute(wanted); }, request);
        }
        decide_inputs();
        session_.update(transport_.clock_us());
    }
    history_.discard_before(session_.oldest_needed_tick());
}

std::uint64_t Bot::next_deadline_us() const {
    const std::uint64_t deadline_us = session_.next_deadline_us();
    return connected_ ? deadline_us : std::min(deadline_us, transport_.clock_us() + kConnectPollUs);
}

void Bot::receive() {
    packets_.clear();
    transport_.receive(packets_);
    MessageLimits limits;
    limits.direction = Direction::to_client;
    for (const Packet& packet : packets_) {
        const Result<Message> message = decode(packet.bytes, limits);
        if (!message) {
            ++packets_malformed_;
            continue;
        }
        session_.receive(packet.from, message.value(), transport_.clock_us());
    }
}

void Bot::decide_inputs() {
    while (session_.wants_input()) {
        const Tick tick = session_.next_input_tick();
        SlotInput input;
        encode(behaviour_->decide(simulation_->world(), session_.slot(), tick), input);
        session_.add_local_input(tick, input);
    }
}

void Bot::execute(const SendRequest& request) {
    encode(request.message, encoded_);
    const Channel channel =
        request.delivery == Delivery::reliable ? Channel::reliable : Channel::best_effort;
    // A full queue loses the message; the session repeats whatever is not acknowledged.
    static_cast<void>(transport_.send(request.to, channel, encoded_));
}

void Bot::execute(const AdvanceRequest& request) {
    if (session_.ended()) {
        return;
    }
    if (const Status stepped = simulation_->advance(request.inputs); !stepped) {
        session_.fail(stepped.error().message);
        return;
    }
    if (const Status corrupted = corrupt_if_due(request.tick); !corrupted) {
        session_.fail(corrupted.error().message);
        return;
    }
    const std::uint64_t hash = request.hash_due ? simulation_->state_hash() : 0;
    if (request.hash_due) {
        history_.save(*simulation_, hash);
    }
    session_.advanced(request.tick, hash);
}

void Bot::execute(const CreateRequest& request) {
    if (const Status created = create_world(request.config); !created) {
        session_.fail(created.error().message);
        return;
    }
    const std::uint64_t hash = simulation_->state_hash();
    history_.clear();
    history_.save(*simulation_, hash);
    session_.created(hash, simulation_->input_size_bytes());
}

void Bot::execute(const RestoreRequest& request) {
    if (const Status loaded = simulation_->load(request.bytes); !loaded) {
        session_.fail("the server's snapshot of tick " + std::to_string(request.tick) +
                      " is no valid state: " + loaded.error().message);
        return;
    }
    const std::uint64_t hash = simulation_->state_hash();
    history_.clear();
    history_.save(*simulation_, hash);
    session_.restored(hash);
}

void Bot::execute(const DesyncReportRequest& request) {
    Result<std::vector<std::byte>> report = desync_report(request.desync);
    if (!report) {
        session_.fail(report.error().message);
        return;
    }
    session_.send_blob(BlobKind::desync_report, std::move(report).value());
}

void Bot::execute(const NotifyRequest& request) {
    if (listener_) {
        listener_(request.event);
    }
}

Status Bot::create_world(const MatchConfig& config) {
    Result<std::unique_ptr<WorldSimulation>> simulation = create_match_simulation(config);
    if (!simulation) {
        return simulation.error();
    }
    simulation_ = std::move(simulation).value();
    return simulation_->set_phase_fault(settings_.corrupt_phase);
}

Status Bot::corrupt_if_due(Tick tick) {
    const std::optional<Corruption>& corruption = settings_.corruption;
    if (!corruption || corruption->tick != tick || corruption->slot != session_.slot()) {
        return Success{};
    }
    return simulation_->corrupt_field(corruption->field);
}

Result<std::vector<std::byte>> Bot::desync_report(const HashMismatch& desync) {
    const SavedState* agreed = history_.find(desync.agreed_tick);
    const SavedState* bad = history_.find(desync.bad_tick);
    if (agreed == nullptr || bad == nullptr) {
        return Error{"the states of ticks " + std::to_string(desync.agreed_tick) + " and " +
                     std::to_string(desync.bad_tick) + " are no longer kept"};
    }
    std::vector<std::vector<SlotInput>> inputs;
    for (Tick tick = desync.agreed_tick + 1; tick <= desync.bad_tick; ++tick) {
        const std::span<const SlotInput> confirmed = session_.confirmed_inputs(tick);
        inputs.emplace_back(confirmed.begin(), confirmed.end());
    }
    return build_desync_report(
        *simulation_,
        {desync.agreed_tick, agreed->bytes, inputs},
        {std::string(sim_version()), std::string(build_info()), session_.config()},
        {session_.slot(), bad->hash, bad->bytes});
}

} // namespace lockwind
