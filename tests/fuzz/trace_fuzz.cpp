#include "forensics/diff.h"
#include "tests/fuzz/framed_file.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const fuzz::FramedFile file(fuzz::bytes_of(data, size));
    Result<TraceReader> trace = TraceReader::open(file.path());
    Result<TraceReader> same = TraceReader::open(file.path());
    LOCKWIND_ASSERT(trace.ok() == same.ok());
    if (!trace) {
        LOCKWIND_ASSERT(!trace.error().message.empty());
        return 0;
    }
    // A trace is the same as itself, or damaged.
    const Result<DiffResult> diff = diff_traces(trace.value(), same.value());
    LOCKWIND_ASSERT(!diff || diff.value().same);
    return 0;
}
