#pragma once

#include "session/messages.h"
#include "session/violation.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace lockwind {

inline constexpr std::uint32_t kBlobWindowChunks = 2;
inline constexpr std::uint64_t kChunkResendUs = 250'000;

/// Sends one blob after the other in chunks, kBlobWindowChunks in flight; each is repeated until it
/// is acknowledged.
class BlobSender {
public:
    /// Begins a transfer in place of the one before, finished or not. At most kBlobSizeBytesMax
    /// bytes. `transfer` is its number, above those of all transfers that went to this receiver
    /// before, from whichever sender: it tells a new blob from a repeated chunk of an old one.
    void start(BlobKind kind, std::uint32_t transfer, std::vector<std::byte> bytes);
    void cancel();

    /// Appends the chunks that are due.
    void poll(std::uint64_t now_us, std::vector<Chunk>& out);
    /// Of another transfer, doubled or out of range: ignored.
    void receive(const ChunkAck& ack);

    bool active() const { return active_; }
    std::uint32_t transfer() const { return transfer_; }
    /// When poll is next needed without an acknowledgement; UINT64_MAX when never.
    std::uint64_t next_deadline_us() const;

private:
    struct InFlight {
        bool acked = false;
        std::uint64_t resend_us = 0; // 0: not sent yet
    };

    Chunk chunk(std::uint32_t index) const;

    BlobKind kind_ = BlobKind::snapshot;
    std::vector<std::byte> bytes_;
    std::uint32_t transfer_ = 0;
    std::uint32_t base_ = 0; // chunks below are acknowledged
    std::uint32_t count_ = 0;
    std::array<InFlight, kBlobWindowChunks> window_{}; // window_[i] is chunk base_ + i
    bool active_ = false;
};

/// A blob that has arrived whole.
struct Blob {
    BlobKind kind = BlobKind::snapshot;
    std::vector<std::byte> bytes;
};

/// Puts together what a BlobSender sends. Takes only what it was told to expect; holds at most what
/// has arrived in order and one chunk more, whatever a chunk claims.
class BlobReceiver {
public:
    /// From now on one blob of this kind and at most this size is taken; forgets a half-received
    /// one. Transfers numbered below `transfer_min` are of an earlier connection and ignored.
    void expect(BlobKind kind, std::size_t size_bytes_max, std::uint32_t transfer_min = 1);
    /// Takes nothing more.
    void close();

    struct Outcome {
        std::optional<ChunkAck> ack; // to be sent back
        std::optional<Blob> blob;    // complete with this chunk
        std::optional<Violation> violation;
    };
    Outcome receive(const Chunk& chunk);

    bool expecting() const { return expecting_; }
    std::size_t received_bytes() const { return bytes_.size(); }

private:
    std::optional<Violation> check(const Chunk& chunk) const;
    void append(const Chunk& chunk);

    BlobKind kind_ = BlobKind::snapshot;
    std::size_t size_bytes_max_ = 0;
    bool expecting_ = false;
    std::uint32_t transfer_min_ = 1;
    std::uint32_t transfer_ = 0;          // the one under way; 0: none
    std::uint32_t complete_transfer_ = 0; // the last one that arrived whole; 0: none
    std::uint32_t blob_size_bytes_ = 0;
    std::uint32_t next_index_ = 0;
    std::vector<std::byte> bytes_;
    std::optional<Chunk> ahead_; // chunk next_index_ + 1, where it came first
};

/// Chunks of a blob of this size: every one but the last is full; an empty blob is one empty chunk.
std::uint32_t chunk_count(std::size_t size_bytes);

} // namespace lockwind
