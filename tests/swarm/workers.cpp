#include "tests/swarm/workers.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>

namespace lockwind::swarm {

namespace {

using Play = std::function<SeedResult(std::uint64_t seed)>;

/// Of processor time; a seed takes a fraction of a second, with sanitizers some more.
constexpr rlim_t kSecondsMax = 300;

/// What a worker writes: this, then its failures, a line each.
struct Head {
    SwarmFigures figures;
    std::uint64_t digest = 0;
};
static_assert(std::is_trivially_copyable_v<Head>);

struct Worker {
    std::uint64_t seed = 0;
    pid_t process = 0;
    int pipe = -1;
    std::string written;
};

void write_all(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = write(file, bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR) {
            return; // nobody reads: the parent is gone
        }
        bytes.remove_prefix(count > 0 ? static_cast<std::size_t>(count) : 0);
    }
}

[[noreturn]] void work(std::uint64_t seed, const Play& play, int pipe) {
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL); // nobody waits for it then
    const rlimit limit{kSecondsMax, kSecondsMax};
    (void)setrlimit(RLIMIT_CPU, &limit);
    const SeedResult result = play(seed);
    const Head head{result.figures, result.digest};
    std::string bytes(sizeof head, '\0');
    std::memcpy(bytes.data(), &head, sizeof head);
    for (const std::string& failure : result.failures) {
        std::string line = failure;
        std::ranges::replace(line, '\n', ' ');
        bytes += line + '\n';
    }
    write_all(pipe, bytes);
    _exit(0); // the parent's objects are the parent's
}

Worker start(std::uint64_t seed, const Play& play) {
    int ends[2];
    LOCKWIND_ASSERT(pipe(ends) == 0);
    std::fflush(nullptr); // else both would write what waits
    const pid_t process = fork();
    LOCKWIND_ASSERT(process >= 0);
    if (process == 0) {
        close(ends[0]);
        work(seed, play, ends[1]);
    }
    close(ends[1]);
    return {seed, process, ends[0], ""};
}

/// Reads on; true at the end of what the worker writes.
bool read_some(Worker& worker) {
    char buffer[4096];
    const ssize_t count = read(worker.pipe, buffer, sizeof buffer);
    if (count > 0) {
        worker.written.append(buffer, static_cast<std::size_t>(count));
    }
    return count == 0 || (count < 0 && errno != EINTR);
}

SeedResult finish(const Worker& worker) {
    close(worker.pipe);
    int status = 0;
    while (waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
    }
    SeedResult result;
    result.seed = worker.seed;
    if (WIFSIGNALED(status)) {
        result.failures.push_back(fmt::format("the process died of signal {}", WTERMSIG(status)));
        return result;
    }
    Head head;
    if (WEXITSTATUS(status) != 0 || worker.written.size() < sizeof head) {
        result.failures.push_back(
            fmt::format("the process gave up with exit code {}", WEXITSTATUS(status)));
        return result;
    }
    std::memcpy(&head, worker.written.data(), sizeof head);
    result.figures = head.figures;
    result.digest = head.digest;
    std::string_view lines = std::string_view(worker.written).substr(sizeof head);
    while (!lines.empty()) {
        result.failures.emplace_back(lines.substr(0, lines.find('\n')));
        lines.remove_prefix(result.failures.back().size() + 1);
    }
    return result;
}

/// Waits for one worker to say something; the finished ones leave the list.
std::vector<SeedResult> take_finished(std::vector<Worker>& running) {
    std::vector<pollfd> files;
    files.reserve(running.size());
    for (const Worker& worker : running) {
        files.push_back({worker.pipe, POLLIN, 0});
    }
    std::vector<SeedResult> finished;
    if (poll(files.data(), files.size(), -1) <= 0) {
        return finished;
    }
    for (std::size_t index = running.size(); index-- > 0;) {
        if (files[index].revents != 0 && read_some(running[index])) {
            finished.push_back(finish(running[index]));
            running.erase(running.begin() + static_cast<std::ptrdiff_t>(index));
        }
    }
    return finished;
}

} // namespace

std::vector<SeedResult> run_seeds(const WorkerSettings& workers,
                                  const Play& play,
                                  const std::function<void(const SeedResult&)>& progress) {
    std::vector<SeedResult> results;
    std::vector<Worker> running;
    std::uint64_t begun = 0;
    bool stopped = false;
    while (!running.empty() || (begun < workers.seeds && !stopped)) {
        while (running.size() < workers.jobs && begun < workers.seeds && !stopped) {
            running.push_back(start(workers.first_seed + begun, play));
            ++begun;
        }
        for (SeedResult& result : take_finished(running)) {
            stopped = stopped || (workers.stop_at_failure && !result.failures.empty());
            progress(result);
            results.push_back(std::move(result));
        }
    }
    std::ranges::sort(results, {}, &SeedResult::seed);
    if (stopped) { // what others were about then depends on `jobs`
        const auto failed = std::ranges::find_if(
            results, [](const SeedResult& result) { return !result.failures.empty(); });
        results.erase(failed + 1, results.end());
    }
    return results;
}

} // namespace lockwind::swarm
