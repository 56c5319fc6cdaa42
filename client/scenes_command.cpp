#include "scenes_command.h"

#include "codec/utf8.h"
#include "program/exit_code.h"
#include "scene/scene.h"

#include <cstdio>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lockwind {
namespace {

using Json = nlohmann::ordered_json;

Json describe(const SceneReport& report) {
    return {{"name", report.name},
            {"bodies", report.bodies},
            {"bodies_dynamic", report.bodies_dynamic},
            {"players_max", report.players_max},
            {"tick_rate_hz", report.tick_rate_hz},
            {"description", report.description}};
}

void print(const Json& json) {
    // Text of files may be no valid UTF-8: show what can be shown.
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

int fail(const ScenesOptions& options, const Error& error, int exit_code) {
    fmt::print(stderr, "lockwind scenes: {}\n", error.message);
    if (options.json) {
        print({{"scene", options.check}, {"ok", false}, {"error", error.message}});
    }
    return exit_code;
}

int check(const ScenesOptions& options) {
    const Result<std::string> text = load_scene_text(options.check);
    if (!text) {
        return fail(options, text.error(), kExitFile);
    }
    if (!is_utf8(text.value())) {
        return fail(options, Error{options.check + ": the text is not UTF-8"}, kExitUsage);
    }
    const Result<SceneReport> report = check_scene(options.check);
    if (!report) {
        return fail(options, report.error(), kExitUsage);
    }
    if (options.json) {
        Json json = {{"scene", options.check}, {"ok", true}};
        json.update(describe(report.value()));
        print(json);
    } else {
        const SceneReport& scene = report.value();
        fmt::print("{}: a valid scene: {} bodies ({} dynamic), up to {} players, {} Hz\n",
                   scene.name,
                   scene.bodies,
                   scene.bodies_dynamic,
                   scene.players_max,
                   scene.tick_rate_hz);
    }
    return kExitDone;
}

int list(const ScenesOptions& options) {
    Json scenes = Json::array();
    for (const BuiltInScene& scene : built_in_scenes()) {
        const Result<SceneReport> report = check_scene(scene.name);
        if (!report) {
            return fail(options, report.error(), kExitUsage);
        }
        scenes.push_back(describe(report.value()));
    }
    if (options.json) {
        print({{"scenes", scenes}});
        return kExitDone;
    }
    fmt::print("{:<16}{:>8}{:>9}  {}\n", "scene", "bodies", "players", "what it is");
    for (const Json& scene : scenes) {
        fmt::print("{:<16}{:>8}{:>9}  {}\n",
                   scene["name"].get<std::string>(),
                   scene["bodies"].get<std::uint32_t>(),
                   scene["players_max"].get<std::uint32_t>(),
                   scene["description"].get<std::string>());
    }
    fmt::print("heap_N is a heap of N boxes. A file works wherever a name does.\n");
    return kExitDone;
}

} // namespace

int run_scenes(const ScenesOptions& options) {
    return options.check.empty() ? list(options) : check(options);
}

} // namespace lockwind
