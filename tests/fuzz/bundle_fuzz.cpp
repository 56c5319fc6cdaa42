#include "forensics/diff.h"
#include "forensics/diff_output.h"
#include "tests/fuzz/framed_file.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const fuzz::FramedFile file(fuzz::bytes_of(data, size));
    const Result<Bundle> bundle = read_bundle(file.path());
    if (!bundle) {
        LOCKWIND_ASSERT(!bundle.error().message.empty());
        return 0;
    }
    const DiffResult diff = diff_bundle(bundle.value());
    LOCKWIND_ASSERT(!diff_text(diff).empty());
    LOCKWIND_ASSERT(!diff_json(diff).empty());
    LOCKWIND_ASSERT(!diff_junit(diff, "fuzz").empty());
    return 0;
}
