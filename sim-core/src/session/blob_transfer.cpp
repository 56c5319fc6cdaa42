#include "session/blob_transfer.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {
namespace {

/// Bytes of chunk `index` of a blob.
std::size_t chunk_size_bytes(std::size_t blob_size_bytes, std::uint32_t index) {
    const std::size_t begin = index * kChunkSizeBytesMax;
    return std::min(blob_size_bytes - begin, kChunkSizeBytesMax);
}

} // namespace

std::uint32_t chunk_count(std::size_t size_bytes) {
    const std::size_t full = (size_bytes + kChunkSizeBytesMax - 1) / kChunkSizeBytesMax;
    return static_cast<std::uint32_t>(std::max<std::size_t>(full, 1));
}

void BlobSender::start(BlobKind kind, std::uint32_t transfer, std::vector<std::byte> bytes) {
    LOCKWIND_ASSERT(bytes.size() <= kBlobSizeBytesMax);
    LOCKWIND_ASSERT(transfer > transfer_);
    kind_ = kind;
    count_ = chunk_count(bytes.size());
    bytes_ = std::move(bytes);
    transfer_ = transfer;
    base_ = 0;
    window_ = {};
    active_ = true;
}

void BlobSender::cancel() {
    active_ = false;
    bytes_.clear();
}

Chunk BlobSender::chunk(std::uint32_t index) const {
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(index * kChunkSizeBytesMax);
    const auto size = static_cast<std::ptrdiff_t>(chunk_size_bytes(bytes_.size(), index));
    Chunk chunk;
    chunk.kind = kind_;
    chunk.transfer = transfer_;
    chunk.index = index;
    chunk.count = count_;
    chunk.blob_size_bytes = static_cast<std::uint32_t>(bytes_.size());
    chunk.bytes.assign(begin, begin + size);
    return chunk;
}

void BlobSender::poll(std::uint64_t now_us, std::vector<Chunk>& out) {
    if (!active_) {
        return;
    }
    for (std::uint32_t i = 0; i < kBlobWindowChunks && base_ + i < count_; ++i) {
        InFlight& in_flight = window_[i];
        if (!in_flight.acked && now_us >= in_flight.resend_us) {
            out.push_back(chunk(base_ + i));
            in_flight.resend_us = now_us + kChunkResendUs;
        }
    }
}

void BlobSender::receive(const ChunkAck& ack) {
    if (!active_ || ack.transfer != transfer_ || ack.index < base_ ||
        ack.index - base_ >= kBlobWindowChunks || window_[ack.index - base_].resend_us == 0) {
        return;
    }
    window_[ack.index - base_].acked = true;
    while (window_[0].acked) {
        std::move(window_.begin() + 1, window_.end(), window_.begin());
        window_.back() = InFlight{};
        ++base_;
    }
    if (base_ == count_) {
        cancel();
    }
}

std::uint64_t BlobSender::next_deadline_us() const {
    std::uint64_t deadline = std::numeric_limits<std::uint64_t>::max();
    if (!active_) {
        return deadline;
    }
    for (std::uint32_t i = 0; i < kBlobWindowChunks && base_ + i < count_; ++i) {
        if (!window_[i].acked) {
            deadline = std::min(deadline, window_[i].resend_us);
        }
    }
    return deadline;
}

void BlobReceiver::expect(BlobKind kind, std::size_t size_bytes_max, std::uint32_t transfer_min) {
    kind_ = kind;
    size_bytes_max_ = std::min(size_bytes_max, kBlobSizeBytesMax);
    transfer_min_ = std::max({transfer_min, transfer_ + 1, complete_transfer_ + 1});
    close();
    expecting_ = true;
}

void BlobReceiver::close() {
    expecting_ = false;
    transfer_ = 0;
    bytes_.clear();
    ahead_.reset();
}

std::optional<Violation> BlobReceiver::check(const Chunk& chunk) const {
    if (!expecting_ || chunk.kind != kind_) {
        return Violation::chunk_unsolicited;
    }
    const bool sizes_agree =
        chunk.blob_size_bytes <= size_bytes_max_ &&
        chunk.count == chunk_count(chunk.blob_size_bytes) && chunk.index < chunk.count &&
        chunk.bytes.size() == chunk_size_bytes(chunk.blob_size_bytes, chunk.index);
    const bool first_of_transfer = chunk.transfer != transfer_;
    const bool continues = first_of_transfer || chunk.blob_size_bytes == blob_size_bytes_;
    const std::uint32_t next = first_of_transfer ? 0 : next_index_;
    if (!sizes_agree || !continues || chunk.index >= next + kBlobWindowChunks) {
        return Violation::chunk_malformed;
    }
    return std::nullopt;
}

void BlobReceiver::append(const Chunk& chunk) {
    bytes_.insert(bytes_.end(), chunk.bytes.begin(), chunk.bytes.end());
    ++next_index_;
}

BlobReceiver::Outcome BlobReceiver::receive(const Chunk& chunk) {
    Outcome outcome;
    if (chunk.transfer != 0 && chunk.transfer == complete_transfer_) {
        outcome.ack = ChunkAck{chunk.transfer, chunk.index}; // the first acknowledgement was lost
        return outcome;
    }
    const bool outdated = chunk.transfer < transfer_min_ || chunk.transfer < transfer_;
    if (expecting_ && chunk.transfer != 0 && outdated) {
        return outcome;
    }
    outcome.violation = check(chunk);
    if (outcome.violation) {
        return outcome;
    }
    if (chunk.transfer != transfer_) {
        transfer_ = chunk.transfer;
        blob_size_bytes_ = chunk.blob_size_bytes;
        next_index_ = 0;
        bytes_.clear();
        ahead_.reset();
    }
    outcome.ack = ChunkAck{chunk.transfer, chunk.index};
    if (chunk.index > next_index_) {
        ahead_ = chunk;
        return outcome;
    }
    if (chunk.index == next_index_) {
        append(chunk);
        if (ahead_) {
            append(*ahead_);
            ahead_.reset();
        }
    }
    if (next_index_ == chunk.count) {
        complete_transfer_ = transfer_;
        outcome.blob = Blob{kind_, std::move(bytes_)};
        close();
    }
    return outcome;
}

} // namespace lockwind
