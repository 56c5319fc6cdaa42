#include "log/log_reader.h"
#include "log/state_pack.h"
#include "tests/fuzz/framed_file.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const fuzz::FramedFile file(fuzz::bytes_of(data, size));
    Result<LogReader> log = LogReader::open(file.path());
    if (!log) {
        LOCKWIND_ASSERT(!log.error().message.empty());
        return 0;
    }
    Tick last = 0;
    std::uint64_t records = 0;
    while (const std::optional<LogRecord> record = log.value().next()) {
        ++records;
        if (const auto* tick = std::get_if<TickRecord>(&*record)) {
            LOCKWIND_ASSERT(tick->tick == last + 1);
            LOCKWIND_ASSERT(tick->inputs.size() == log.value().header().config.players);
            last = tick->tick;
        }
        LOCKWIND_ASSERT(log.value().valid_bytes() <= size);
    }
    LOCKWIND_ASSERT(records <= size);
    LOCKWIND_ASSERT((log.value().ended() == LogEnd::damaged) == !log.value().damage().empty());
    // A second pass finds the same.
    const LogEnd ended = log.value().ended();
    const LogIndex index = index_log(log.value());
    LOCKWIND_ASSERT(index.ticks == last && index.ended == ended);
    return 0;
}
