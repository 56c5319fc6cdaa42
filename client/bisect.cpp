#include "bisect.h"

#include "forensics/diff.h"
#include "forensics/diff_output.h"
#include "program/console.h"
#include "program/exit_code.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace lockwind {
namespace {

/// A folder for traces, removed with all that is in it.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::error_code ignored;
        std::string name =
            (std::filesystem::temp_directory_path(ignored) / "lockwind-XXXXXX").string();
        path_ = ::mkdtemp(name.data()) == nullptr ? "" : name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        if (!path_.empty()) {
            std::filesystem::remove_all(path_, ignored);
        }
    }

    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// Runs a program to its end, its stdout thrown away. Its exit code, or -1.
int run_program(const std::vector<std::string>& arguments) {
    std::vector<char*> pointers;
    pointers.reserve(arguments.size() + 1);
    pointers.reserve(arguments.size() + 1);
    for (const std::string& argument : arguments) {
        pointers.push_back(const_cast<char*>(argument.c_str()));
    }
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions{};
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int spawned =
        ::posix_spawnp(&child, pointers[0], &actions, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    if (spawned != 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) {
        return -1;
    }
    return WEXITSTATUS(status);
}

/// Has `program` trace the ticks of the options' log.
Status
trace(const std::string& program, const ReplayCommandOptions& options, const std::string& to) {
    std::vector<std::string> arguments{program, "replay", options.log, "--trace", to};
    if (options.trace_states) {
        arguments.emplace_back("--trace-states");
    }
    if (options.from) {
        arguments.insert(arguments.end(), {"--from", std::to_string(*options.from)});
    }
    if (options.to) {
        arguments.insert(arguments.end(), {"--to", std::to_string(*options.to)});
    }
    const int code = run_program(arguments);
    // 3: the log is damaged, and was traced as far as it is good.
    if (code != 0 && code != 3) {
        return Error{fmt::format("{} could not trace the log (exit code {})", program, code)};
    }
    return Success{};
}

/// Traces with both programs and compares. `name`: of this pair's files.
Result<DiffResult>
compare(const ReplayCommandOptions& options, const std::string& folder, std::string_view name) {
    const std::array<std::string, 2> programs{"/proc/self/exe", options.bisect};
    std::array<std::string, 2> files;
    for (std::size_t side = 0; side < programs.size(); ++side) {
        files[side] = fmt::format("{}/{}-{}.trace", folder, name, side);
        if (Status status = trace(programs[side], options, files[side]); !status) {
            return status.error();
        }
    }
    Result<TraceReader> a = TraceReader::open(files[0]);
    Result<TraceReader> b = TraceReader::open(files[1]);
    if (!a || !b) {
        return a ? b.error() : a.error();
    }
    Result<DiffResult> diff = diff_traces(a.value(), b.value());
    if (diff) {
        diff.value().name_a = "this";
        diff.value().name_b = "other";
        const bool builds =
            a.value().header().party.build_info != b.value().header().party.build_info;
        if (!diff.value().same) {
            diff.value().verdict = builds ? Verdict::build_differs : Verdict::nondeterminism;
        }
    }
    return diff;
}

Result<DiffResult> bisect(const ReplayCommandOptions& options, const std::string& folder) {
    ReplayCommandOptions range = options;
    range.trace_states = false;
    Result<DiffResult> found = compare(range, folder, "hashes");
    if (!found || found.value().same || !found.value().first_tick) {
        return found;
    }
    range.from = range.to = found.value().first_tick;
    range.trace_states = true;
    Result<DiffResult> field = compare(range, folder, "states");
    // A fault that does not come again leaves what the hashes tell.
    return field && !field.value().same ? field : found;
}

} // namespace

int run_bisect(const ReplayCommandOptions& options) {
    const TemporaryFolder folder;
    const Result<DiffResult> diff =
        folder.path().empty() ? Result<DiffResult>(Error{std::string("no temporary folder: ") +
                                                         std::generic_category().message(errno)})
                              : bisect(options, folder.path());
    if (!diff) {
        say_error("--bisect: " + diff.error().message);
        return kExitUsage;
    }
    fmt::print("{}", options.json ? diff_json(diff.value()) + "\n" : diff_text(diff.value()));
    return diff.value().same ? 0 : 1;
}

} // namespace lockwind
