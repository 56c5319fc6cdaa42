#include "info_command.h"

#include "forensics/info.h"
#include "program/console.h"
#include "program/exit_code.h"

#include <fmt/format.h>

namespace lockwind {
namespace {

int fail(const Error& error, int exit_code) {
    say_error(error.message);
    return exit_code;
}

} // namespace

int run_info(const InfoCommandOptions& options) {
    const Result<FileInfo> info = inspect_file(options.file);
    if (!info) {
        return fail(info.error(), kExitFile);
    }
    fmt::print("{}", options.json ? info.value().json + "\n" : info.value().text);
    if (!options.export_file.empty()) {
        if (const Status status = export_file(options.file, options.export_file); !status) {
            return fail(status.error(), info.value().damaged ? kExitFile : kExitUsage);
        }
    }
    return info.value().damaged ? kExitFile : kExitDone;
}

} // namespace lockwind
