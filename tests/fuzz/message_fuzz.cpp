#include "codec/codec.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"
#include "lockwind/session.h"

namespace lockwind::fuzz {
namespace {

/// A match that has begun, for messages to arrive at.
LockstepServer running_server() {
    LockstepServerSettings settings;
    settings.config.match = "fuzz";
    settings.config.mode = "lockstep";
    settings.config.players = 2;
    settings.config.ticks = 100;
    settings.sim_version = "v1";
    settings.join_timeout_ms = 1;
    LockstepServer server(settings);
    server.update(1);
    server.receive(5, Hello{kProtocolVersion, "v1", "", 7, 1}, 2);
    server.receive(5, Ready{0, 0}, 3);
    InputBatch inputs;
    inputs.first_tick = 1;
    inputs.inputs.resize(4);
    server.receive(5, inputs, 4);
    server.update(10'000);
    static_cast<void>(server.take_requests());
    return server;
}

} // namespace
} // namespace lockwind::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const Result<Message> message = decode(fuzz::bytes_of(data, size));
    if (!message) {
        LOCKWIND_ASSERT(!message.error().message.empty());
        return 0;
    }
    // What is accepted can be sent, and says the same again.
    LOCKWIND_ASSERT(check(message.value()).ok());
    const std::vector<std::byte> bytes = encode(message.value());
    const Result<Message> again = decode(bytes);
    LOCKWIND_ASSERT(again.ok());
    LOCKWIND_ASSERT(encode(again.value()) == bytes);
    // No message of anybody's brings a session down.
    LockstepServer server = fuzz::running_server();
    for (const PeerId from : {5U, 6U}) {
        server.receive(from, message.value(), 200'000);
        server.update(200'000);
        static_cast<void>(server.take_requests());
    }
    LockstepClientSettings settings;
    settings.sim_version = "v1";
    LockstepClient client(settings);
    client.update(1);
    client.receive(kServerPeer, message.value(), 2);
    client.update(3);
    static_cast<void>(client.take_requests());
    return 0;
}
