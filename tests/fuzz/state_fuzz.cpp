#include "tests/fuzz/fuzz_target.h"
#include "tests/support/code_scenes.h"

#include "lockwind/assert.h"

// A snapshot's canonical bytes, as a peer sends them to whoever joins.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    static const WorldPtr world = test::make_world(test::with_levels(test::scene_of_all(12, 2)));
    static const std::vector<std::byte> start = [] {
        std::vector<std::byte> bytes;
        world->save(bytes);
        return bytes;
    }();
    const std::uint64_t before = world->state_hash();
    if (const Status loaded = world->load(fuzz::bytes_of(data, size)); !loaded) {
        LOCKWIND_ASSERT(!loaded.error().message.empty());
        LOCKWIND_ASSERT(world->state_hash() == before);
        return 0;
    }
    // What load() takes, save() gives back, and steps can be made from it.
    std::vector<std::byte> saved;
    world->save(saved);
    LOCKWIND_ASSERT(std::ranges::equal(saved, fuzz::bytes_of(data, size)));
    const std::vector<SlotInput> inputs = test::busy_inputs(world->tick() + 1, world->slot_count());
    for (int tick = 0; tick < 2 && !kChecked; ++tick) {
        if (!world->step(inputs)) {
            break; // a table is full: told, not asserted
        }
    }
    LOCKWIND_ASSERT(world->load(start).ok());
    return 0;
}
