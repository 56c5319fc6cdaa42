#include "codec/codec.h"
#include "tests/support/code_scenes.h"
#include "tests/support/dice.h"
#include "tests/unit/codec/sample_messages.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

// Writes the seeds that are made in code: messages, states and draws of calls. The others are files
// of a match.

namespace {

void write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

} // namespace

int main(int argc, char** argv) {
    using namespace lockwind;
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s CORPUS\n", argv[0]);
        return 2;
    }
    const std::filesystem::path corpus(argv[1]);
    std::filesystem::create_directories(corpus / "message");
    std::filesystem::create_directories(corpus / "state");
    for (const Message& message : sample_messages()) {
        write(corpus / "message" / kind_name(message), encode(message));
    }
    const WorldPtr world = test::make_world(test::with_levels(test::scene_of_all(12, 2)));
    for (int tick = 0; tick <= 60; ++tick) {
        if (tick % 30 == 0) {
            std::vector<std::byte> bytes;
            world->save(bytes);
            write(corpus / "state" / ("tick-" + std::to_string(tick)), bytes);
        }
        test::step_busy(*world);
    }
    std::filesystem::create_directories(corpus / "calls");
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        testing::Dice dice(seed);
        std::vector<std::byte> bytes(200 * seed);
        for (std::byte& byte : bytes) {
            byte = static_cast<std::byte>(dice.below(256));
        }
        write(corpus / "calls" / ("draws-" + std::to_string(seed)), bytes);
    }
    return 0;
}
