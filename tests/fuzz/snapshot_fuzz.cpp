#include "forensics/snapshot_file.h"
#include "forensics/state_diff.h"
#include "tests/fuzz/framed_file.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"

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
    LOCKWIND_ASSERT(!same || same.value().count == 0);
    std::vector<std::byte> other = state;
    if (!other.empty()) {
        other.back() ^= std::byte{1};
        static_cast<void>(diff_states(schema, state, other));
    }
    return 0;
}
