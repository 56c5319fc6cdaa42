#include "scene/scene.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <memory>
#include <system_error>

namespace lockwind {
namespace {

constexpr std::string_view kHeapPrefix = "heap_";
constexpr std::string_view kHeapModel = "heap_1000";

const BuiltInScene* find_built_in(std::string_view name) {
    for (const BuiltInScene& scene : built_in_scenes()) {
        if (scene.name == name) {
            return &scene;
        }
    }
    return nullptr;
}

/// heap_N is heap_1000 with N written in place of each 1000. Empty where `name` is no heap_N.
std::string heap_text(std::string_view name) {
    constexpr std::string_view kCount = "1000";
    if (name.substr(0, kHeapPrefix.size()) != kHeapPrefix) {
        return {};
    }
    const std::string_view digits = name.substr(kHeapPrefix.size());
    std::uint32_t count = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
    if (error != std::errc() || end != digits.data() + digits.size() || digits.front() == '0') {
        return {};
    }
    const BuiltInScene* model = find_built_in(kHeapModel);
    LOCKWIND_ASSERT(model != nullptr);
    std::string text(model->text);
    for (std::size_t at = text.find(kCount); at != std::string::npos;
         at = text.find(kCount, at + digits.size())) {
        text.replace(at, kCount.size(), digits);
    }
    return text;
}

std::string built_in_names() {
    std::string names;
    for (const BuiltInScene& scene : built_in_scenes()) {
        names += std::string(scene.name) + ", ";
    }
    return names + "heap_N";
}

std::string reason(int error_number) {
    return std::generic_category().message(error_number);
}

Result<std::string> read_file(const std::string& path) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               &std::fclose);
    if (file == nullptr) {
        return Error{path + ": " + reason(errno) + "; name a file or one of: " + built_in_names()};
    }
    std::string text;
    std::array<char, 4096> block{};
    std::size_t size = block.size();
    while (size == block.size()) {
        size = std::fread(block.data(), 1, block.size(), file.get());
        text.append(block.data(), size);
        if (text.size() > kSceneTextSizeBytesMax) {
            return Error{path + ": longer than " + std::to_string(kSceneTextSizeBytesMax) +
                         " bytes; use arrangements instead of single bodies"};
        }
    }
    if (std::ferror(file.get()) != 0) {
        return Error{path + ": " + reason(errno)};
    }
    return text;
}

} // namespace

Result<std::string> load_scene_text(std::string_view name_or_path) {
    if (const BuiltInScene* scene = find_built_in(name_or_path)) {
        return std::string(scene->text);
    }
    std::string heap = heap_text(name_or_path);
    if (!heap.empty()) {
        return heap;
    }
    return read_file(std::string(name_or_path));
}

Result<WorldDefinition> load_scene(std::string_view name_or_path, const SceneOptions& options) {
    const Result<std::string> text = load_scene_text(name_or_path);
    if (!text) {
        return text.error();
    }
    return parse_scene(text.value(), name_or_path, options);
}

} // namespace lockwind
