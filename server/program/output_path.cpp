#include "program/output_path.h"

#include "program/console.h"
#include "program/exit_code.h"

#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace lockwind {

std::optional<int>
output_path_trouble(std::string_view flag, const std::string& path, Existing existing) {
    if (path.empty()) {
        return std::nullopt;
    }
    const std::filesystem::path file(path);
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
        say_error(fmt::format("{} {}: is a folder; name a file", flag, path));
        return kExitUsage;
    }
    if (existing == Existing::refused && std::filesystem::exists(file, ignored)) {
        say_error(fmt::format("{} {}: the file exists; it is never overwritten", flag, path));
        return kExitUsage;
    }
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (access(folder.c_str(), W_OK | X_OK) != 0) {
        say_error(fmt::format(
            "{} {}: the folder {} is missing or not writable", flag, path, folder.string()));
        return kExitFile;
    }
    return std::nullopt;
}

} // namespace lockwind
