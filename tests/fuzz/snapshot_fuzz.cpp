#include "forensics/snapshot_file.h"
#include "forensics/state_diff.h"
#include "tests/fuzz/framed_file.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"

namespace {

/// The first section counts the rows of the others: another value there is another state.
std::size_t row_counts_size(lockwind::StateSchema schema) {
    return schema.empty() ? 0 : schema.front().stride_bytes;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const fuzz::FramedFile file(fuzz::bytes_of(data, size));
    const Result<Snapshot> snapshot = read_snapshot(file.path());
    if (!snapshot) {
        LOCKWIND_ASSERT(!snapshot.error().message.empty());
        return 0;
    }
    const StateSchema schema = snapshot.value().schema.view();
    const std::vector<std::byte>& state = snapshot.value().state;
    const Result<StateDiff> same = diff_states(schema, state, state);
    if (!same) {
        return 0; // no state of that schema
    }
    LOCKWIND_ASSERT(same.value().count == 0);
    if (state.size() > row_counts_size(schema)) {
        std::vector<std::byte> other = state;
        other.back() ^= std::byte{1};
        const Result<StateDiff> diff = diff_states(schema, state, other);
        LOCKWIND_ASSERT(diff.ok() && diff.value().count > 0);
    }
    return 0;
}
