#include "diff_command.h"

#include "forensics/diff.h"
#include "forensics/diff_output.h"
#include "log/published_file.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/output_path.h"

#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <variant>
#include <vector>

namespace lockwind {
namespace {

/// Why there is no comparison, or a comparison and what could not be read behind it.
struct Failure {
    int exit_code;
    std::string message;
};
struct Comparison {
    DiffResult diff;
    std::vector<std::string> trouble;
};
using Outcome = std::variant<Comparison, Failure>;

Failure unreadable(const Error& error) {
    return {kExitFile, error.message};
}

Outcome compare_logs(const DiffCommandOptions& options) {
    Result<LogReader> a = LogReader::open(options.a);
    Result<LogReader> b = LogReader::open(options.b);
    if (!a || !b) {
        return unreadable(a ? b.error() : a.error());
    }
    Comparison comparison{diff_logs(a.value(), b.value()), {}};
    for (LogReader* log : {&a.value(), &b.value()}) {
        if (log->ended() == LogEnd::damaged) {
            comparison.trouble.push_back(fmt::format("{}: damaged {}; {} bytes before it are good",
                                                     log->path(),
                                                     log->damage(),
                                                     log->valid_bytes()));
        }
    }
    return comparison;
}

Outcome compare_traces(const DiffCommandOptions& options) {
    Result<TraceReader> a = TraceReader::open(options.a);
    Result<TraceReader> b = TraceReader::open(options.b);
    if (!a || !b) {
        return unreadable(a ? b.error() : a.error());
    }
    Result<DiffResult> diff = diff_traces(a.value(), b.value());
    if (!diff) {
        return unreadable(diff.error());
    }
    return Comparison{std::move(diff).value(), {}};
}

Outcome compare_snapshots(const DiffCommandOptions& options) {
    const Result<Snapshot> a = read_snapshot(options.a);
    const Result<Snapshot> b = read_snapshot(options.b);
    if (!a || !b) {
        return unreadable(a ? b.error() : a.error());
    }
    Result<DiffResult> diff = diff_snapshots(a.value(), b.value());
    if (!diff) {
        return unreadable(diff.error());
    }
    return Comparison{std::move(diff).value(), {}};
}

Outcome open_bundle(const DiffCommandOptions& options) {
    const Result<Bundle> bundle = read_bundle(options.a);
    if (!bundle) {
        return unreadable(bundle.error());
    }
    return Comparison{diff_bundle(bundle.value()), {}};
}

Outcome compare(const DiffCommandOptions& options) {
    const Result<FileKind> kind = detect_file_kind(options.a);
    if (!kind) {
        return unreadable(kind.error());
    }
    const std::string_view kind_name = to_text(kind.value());
    if (options.b.empty()) {
        return kind.value() == FileKind::bundle
                   ? open_bundle(options)
                   : Failure{kExitUsage,
                             fmt::format("{} is a {}: give a second one to compare it with",
                                         options.a,
                                         kind_name)};
    }
    const Result<FileKind> other = detect_file_kind(options.b);
    if (!other) {
        return unreadable(other.error());
    }
    if (kind.value() != other.value() || kind.value() == FileKind::bundle) {
        return Failure{kExitUsage,
                       fmt::format("a {} and a {}: give one bundle, or two logs, traces or "
                                   "snapshots",
                                   kind_name,
                                   to_text(other.value()))};
    }
    switch (kind.value()) {
    case FileKind::log:
        return compare_logs(options);
    case FileKind::trace:
        return compare_traces(options);
    default:
        return compare_snapshots(options);
    }
}

} // namespace

int run_diff(const DiffCommandOptions& options) {
    if (const auto trouble = output_path_trouble("--junit", options.junit, Existing::replaced)) {
        return *trouble;
    }
    std::error_code ignored;
    if (std::filesystem::exists(options.junit, ignored) && detect_file_kind(options.junit).ok()) {
        say_error(fmt::format("--junit {}: a {} is never overwritten",
                              options.junit,
                              to_text(detect_file_kind(options.junit).value())));
        return kExitUsage;
    }
    Outcome outcome = compare(options);
    if (const auto* failure = std::get_if<Failure>(&outcome)) {
        say_error(failure->message);
        return failure->exit_code;
    }
    auto& [diff, trouble] = std::get<Comparison>(outcome);
    if (!options.b.empty()) {
        diff.name_a = "a";
        diff.name_b = "b";
    }
    fmt::print("{}", options.json ? diff_json(diff) + "\n" : diff_text(diff));
    if (!options.junit.empty()) {
        PublishedFile file(options.junit);
        file.write(diff_junit(diff, options.a + (options.b.empty() ? "" : " " + options.b)));
        if (const Status written = file.replace(); !written) {
            trouble.push_back(written.error().message);
        }
    }
    for (const std::string& problem : trouble) {
        say_error(problem);
    }
    if (!diff.same) {
        return kExitDiverged; // whatever else went wrong
    }
    return trouble.empty() ? kExitDone : kExitFile;
}

} // namespace lockwind
