#pragma once

#include "forensics/owned_schema.h"
#include "log/record_file.h"
#include "log/state_pack.h"
#include "session/messages.h"

#include "lockwind/result.h"
#include "lockwind/simulation.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// Who ran a simulation, and of what.
struct Party {
    std::string sim_version;
    std::string build_info;
    MatchConfig config;
};

/// What made a trace: enough to read its states without the program that wrote it.
struct TraceHeader {
    Party party;
    std::vector<std::string> phases;
    OwnedSchema schema;
    bool states = false; // entries carry their states
};

/// The state after one phase of one tick.
struct TraceEntry {
    Tick tick = 0;           // the tick being stepped
    std::uint32_t phase = 0; // indexes TraceHeader::phases
    std::uint64_t hash = 0;
    std::vector<std::uint64_t> sections; // hashes of the `state` sections, in schema order
    std::vector<std::byte> packed_state; // link of a StateChain; empty in a trace of hashes only
};

/// Where entries go. The first is the start: the state before the first step, with `tick` its own
/// and `phase` kTraceStart.
class TraceSink {
public:
    virtual ~TraceSink() = default;
    virtual Status add(TraceEntry entry) = 0;
};
inline constexpr std::uint32_t kTraceStart = 0xffffffffU;

/// The header of a trace of `simulation`.
TraceHeader trace_header(const Simulation& simulation, Party party, bool states);

/// A short trace in memory.
struct Trace final : TraceSink {
    TraceHeader header;
    std::vector<TraceEntry> entries;

    Status add(TraceEntry entry) override;
};

struct TraceOptions {
    bool states = false;
    /// Once the packed states pass this, the rest of the trace holds hashes only.
    std::uint64_t state_bytes_max = UINT64_MAX;
    /// Called before each state is looked at: a test's fault injection. Not owned.
    PhaseObserver* first = nullptr;
};

/// Hashes (and packs) the state after every phase of a simulation's advances. Outlives its last
/// advance, or observe(nullptr) comes first.
class TraceRecorder final : public PhaseObserver {
public:
    TraceRecorder(const Simulation& simulation, TraceSink& sink, const TraceOptions& options);

    /// Records the start: the simulation's state as it is. Call once, before the first advance.
    void start();
    void after_phase(std::uint32_t phase) override;
    /// The first Error of the sink; nothing is recorded after it.
    const Status& status() const { return status_; }

private:
    void record(std::uint32_t phase);

    const Simulation& simulation_;
    TraceSink& sink_;
    TraceOptions options_;
    Tick tick_ = 0;
    std::uint64_t packed_bytes_ = 0;
    StateChainPacker packer_;
    std::vector<std::byte> state_;
    Status status_ = Success{};
};

/// Writes a trace file under a temporary name; finish() gives it its own.
class TraceWriter final : public TraceSink {
public:
    /// `path` must not exist.
    static Result<TraceWriter> create(const std::string& path, const TraceHeader& header);
    Status add(TraceEntry entry) override;
    Status finish();

    TraceWriter(TraceWriter&& other) noexcept;
    TraceWriter& operator=(TraceWriter&&) = delete;
    /// Without finish() nothing stays.
    ~TraceWriter() override;

private:
    TraceWriter(std::string path, RecordWriter file);

    std::string path_;
    RecordWriter file_;
    std::uint64_t entries_ = 0;
    bool finished_ = false;
};

/// Entries of a trace in order; holds one.
class TraceSource {
public:
    virtual ~TraceSource() = default;
    virtual const TraceHeader& header() const = 0;
    /// Nothing at the end; an Error where the trace is damaged.
    virtual Result<std::optional<TraceEntry>> next() = 0;
};

class TraceReader final : public TraceSource {
public:
    static Result<TraceReader> open(const std::string& path);
    const TraceHeader& header() const override { return header_; }
    Result<std::optional<TraceEntry>> next() override;
    std::uint64_t valid_bytes() const { return file_.offset(); }

private:
    TraceReader(RecordReader file, TraceHeader header)
        : file_(std::move(file)), header_(std::move(header)) {}
    Error damaged(const std::string& what) const;

    RecordReader file_;
    TraceHeader header_;
    bool ended_ = false;
    std::uint64_t entries_ = 0;
    std::string payload_;
};

/// Reads a trace in memory; the trace must outlive it.
class TraceView final : public TraceSource {
public:
    explicit TraceView(const Trace& trace) : trace_(trace) {}
    const TraceHeader& header() const override { return trace_.header; }
    Result<std::optional<TraceEntry>> next() override;

private:
    const Trace& trace_;
    std::size_t next_ = 0;
};

} // namespace lockwind
