#include "bot/log_behaviour.h"

#include "log/log_reader.h"

#include <string>
#include <utility>
#include <vector>

namespace lockwind {

namespace {

class LogBehaviour final : public Behaviour {
public:
    explicit LogBehaviour(std::vector<TickRecord> ticks) : ticks_(std::move(ticks)) {}

    PlayerInput decide(const World&, Slot slot, Tick tick) override {
        // A log's ticks are consecutive from 1.
        if (tick == 0 || tick > ticks_.size()) {
            return {};
        }
        const std::vector<SlotInput>& inputs = ticks_[static_cast<std::size_t>(tick - 1)].inputs;
        return slot < inputs.size() ? decode_player_input(inputs[slot]) : PlayerInput{};
    }

private:
    std::vector<TickRecord> ticks_;
};

} // namespace

Result<std::unique_ptr<Behaviour>> make_log_behaviour(const std::string& path) {
    Result<LogReader> log = LogReader::open(path);
    if (!log) {
        return log.error();
    }
    std::vector<TickRecord> ticks;
    while (std::optional<LogRecord> record = log.value().next()) {
        if (auto* tick = std::get_if<TickRecord>(&*record)) {
            ticks.push_back(std::move(*tick));
        }
    }
    if (log.value().ended() == LogEnd::damaged) {
        return Error{path + ": damaged after tick " + std::to_string(ticks.size()) + ": " +
                     log.value().damage()};
    }
    return std::unique_ptr<Behaviour>(std::make_unique<LogBehaviour>(std::move(ticks)));
}

} // namespace lockwind
