#include "info_command.h"

#include "forensics/info.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/output_path.h"

#include <fmt/format.h>

namespace lockwind {
namespace {

int fail(const Error& error) {
    say_error(error.message);
    return kExitFile;
}

} // namespace

int run_info(const InfoCommandOptions& options) {
    if (const auto trouble =
            output_path_trouble("--export", options.export_file, Existing::refused)) {
        return *trouble;
    }
    const Result<FileInfo> info = inspect_file(options.file);
    if (!info) {
        return fail(info.error());
    }
    fmt::print("{}", options.json ? info.value().json + "\n" : info.value().text);
    if (!options.export_file.empty()) {
        if (const Status status = export_file(options.file, options.export_file); !status) {
            return fail(status.error());
        }
    }
    return info.value().damaged ? kExitFile : kExitDone;
}

} // namespace lockwind
