#include "scene/scene.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"
#include "lockwind/slot_input.h"
#include "lockwind/world.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const Result<WorldDefinition> scene = parse_scene(text, "fuzz", {.players = kEverySeat});
    if (!scene) {
        LOCKWIND_ASSERT(scene.error().message.starts_with("fuzz"));
        return 0;
    }
    constexpr std::size_t kBodiesMax = 200; // larger ones only take longer
    if (scene.value().bodies.size() > kBodiesMax) {
        return 0;
    }
    const Result<WorldPtr> world = World::create(scene.value());
    if (!world) {
        LOCKWIND_ASSERT(!world.error().message.empty());
        return 0;
    }
    const std::vector<SlotInput> inputs(world.value()->slot_count());
    for (int tick = 0; tick < 3 && world.value()->step(inputs); ++tick) {
        LOCKWIND_ASSERT(world.value()->check().ok());
    }
    return 0;
}
