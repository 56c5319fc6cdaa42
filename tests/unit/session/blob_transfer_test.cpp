#include "tests/unit/session/virtual_match.h"

namespace lockwind::testing {
namespace {

std::vector<std::byte> blob_of(std::size_t size_bytes, std::uint64_t seed) {
    Dice dice(seed);
    std::vector<std::byte> bytes(size_bytes);
    for (std::byte& byte : bytes) {
        byte = static_cast<std::byte>(dice.next() & 0xffU);
    }
    return bytes;
}

std::vector<Chunk> poll(BlobSender& sender, std::uint64_t now_us) {
    std::vector<Chunk> chunks;
    sender.poll(now_us, chunks);
    return chunks;
}

TEST(BlobTransfer, KeepsAWindowOfTwoInFlight) {
    BlobSender sender;
    sender.start(BlobKind::snapshot, sender.transfer() + 1, blob_of(5 * kChunkSizeBytesMax, 1));
    EXPECT_EQ(sender.next_deadline_us(), 0U);
    const std::vector<Chunk> first = poll(sender, 10);
    ASSERT_EQ(first.size(), 2U);
    EXPECT_EQ(first[0].index, 0U);
    EXPECT_EQ(first[1].index, 1U);
    EXPECT_EQ(first[1].count, 5U);
    EXPECT_TRUE(poll(sender, 11).empty());
    EXPECT_EQ(sender.next_deadline_us(), 10 + kChunkResendUs);
    sender.receive(ChunkAck{sender.transfer(), 1}); // the first one is still missing
    EXPECT_TRUE(poll(sender, 12).empty());
    sender.receive(ChunkAck{sender.transfer(), 0});
    const std::vector<Chunk> second = poll(sender, 13);
    ASSERT_EQ(second.size(), 2U);
    EXPECT_EQ(second[0].index, 2U);
    EXPECT_EQ(second[1].index, 3U);
}

TEST(BlobTransfer, RepeatsWhatIsNotAcknowledged) {
    BlobSender sender;
    sender.start(BlobKind::snapshot, sender.transfer() + 1, blob_of(2 * kChunkSizeBytesMax, 1));
    EXPECT_EQ(poll(sender, 10).size(), 2U);
    sender.receive(ChunkAck{sender.transfer(), 0});
    EXPECT_TRUE(poll(sender, 9 + kChunkResendUs).empty());
    const std::vector<Chunk> repeated = poll(sender, 10 + kChunkResendUs);
    ASSERT_EQ(repeated.size(), 1U);
    EXPECT_EQ(repeated[0].index, 1U);
    sender.receive(ChunkAck{sender.transfer(), 1});
    EXPECT_FALSE(sender.active());
    EXPECT_EQ(sender.next_deadline_us(), UINT64_MAX);
}

TEST(BlobTransfer, ArrivesWholeUnderLossDuplicationAndReordering) {
    const std::vector<std::size_t> sizes = {0,
                                            1,
                                            kChunkSizeBytesMax - 1,
                                            kChunkSizeBytesMax,
                                            kChunkSizeBytesMax + 1,
                                            7 * kChunkSizeBytesMax + 123};
    std::uint64_t lost = 0;
    for (const std::size_t size : sizes) {
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            Dice dice(seed + size);
            const std::vector<std::byte> bytes = blob_of(size, seed);
            BlobSender sender;
            BlobReceiver receiver;
            sender.start(BlobKind::desync_report, sender.transfer() + 1, bytes);
            receiver.expect(BlobKind::desync_report, size);
            std::vector<Chunk> under_way;
            std::optional<Blob> arrived;
            for (std::uint64_t now_us = 0; sender.active() && now_us < 60'000'000;
                 now_us += 50'000) {
                sender.poll(now_us, under_way);
                for (std::size_t i = under_way.size(); i-- > 0;) {
                    if (dice.chance(300)) {
                        ++lost;
                        under_way.erase(under_way.begin() + static_cast<std::ptrdiff_t>(i));
                        continue;
                    }
                    const BlobReceiver::Outcome outcome = receiver.receive(under_way[i]);
                    EXPECT_FALSE(outcome.violation.has_value());
                    if (outcome.blob) {
                        EXPECT_FALSE(arrived.has_value());
                        arrived = outcome.blob;
                    }
                    if (outcome.ack && !dice.chance(300)) {
                        sender.receive(*outcome.ack);
                    }
                    if (!dice.chance(200)) { // else it comes once more
                        under_way.erase(under_way.begin() + static_cast<std::ptrdiff_t>(i));
                    }
                }
            }
            ASSERT_TRUE(arrived.has_value()) << size;
            EXPECT_EQ(arrived->bytes, bytes);
            EXPECT_EQ(arrived->kind, BlobKind::desync_report);
            EXPECT_FALSE(sender.active());
        }
    }
    EXPECT_GT(lost, 50U);
}

TEST(BlobTransfer, TakesNothingThatWasNotAskedFor) {
    BlobSender sender;
    sender.start(BlobKind::snapshot, sender.transfer() + 1, blob_of(100, 1));
    const Chunk chunk = poll(sender, 1).at(0);
    BlobReceiver receiver;
    EXPECT_EQ(receiver.receive(chunk).violation, Violation::chunk_unsolicited);
    receiver.expect(BlobKind::desync_report, 1000);
    EXPECT_EQ(receiver.receive(chunk).violation, Violation::chunk_unsolicited);
    receiver.expect(BlobKind::snapshot, 1000);
    EXPECT_TRUE(receiver.receive(chunk).blob.has_value());
    const BlobReceiver::Outcome again = receiver.receive(chunk); // its acknowledgement was lost
    EXPECT_TRUE(again.ack.has_value());
    EXPECT_FALSE(again.blob.has_value());
    EXPECT_FALSE(again.violation.has_value());
}

TEST(BlobTransfer, HoldsNoMoreThanWhatHasArrived) {
    Chunk chunk;
    chunk.transfer = 1;
    chunk.index = 1;
    chunk.count = chunk_count(kBlobSizeBytesMax);
    chunk.blob_size_bytes = kBlobSizeBytesMax;
    chunk.bytes.resize(kChunkSizeBytesMax);
    BlobReceiver receiver;
    receiver.expect(BlobKind::snapshot, kBlobSizeBytesMax);
    EXPECT_TRUE(receiver.receive(chunk).ack.has_value());
    EXPECT_EQ(receiver.received_bytes(), 0U);
    chunk.index = 0;
    EXPECT_TRUE(receiver.receive(chunk).ack.has_value());
    EXPECT_EQ(receiver.received_bytes(), 2 * kChunkSizeBytesMax);
}

TEST(BlobTransfer, RefusesSizesThatContradictEachOtherOrTheLimit) {
    Chunk good;
    good.transfer = 1;
    good.count = 2;
    good.blob_size_bytes = kChunkSizeBytesMax + 5;
    good.bytes.resize(kChunkSizeBytesMax);
    const auto refused = [](const Chunk& chunk) {
        BlobReceiver receiver;
        receiver.expect(BlobKind::snapshot, 10 * kChunkSizeBytesMax);
        return receiver.receive(chunk).violation == Violation::chunk_malformed;
    };
    EXPECT_FALSE(refused(good));
    Chunk chunk = good;
    chunk.transfer = 0;
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.count = 3;
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.index = 2;
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.bytes.pop_back();
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.index = 1; // the last one has 5 bytes
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.blob_size_bytes = 10 * kChunkSizeBytesMax + 1;
    chunk.count = chunk_count(chunk.blob_size_bytes);
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.blob_size_bytes = 5 * kChunkSizeBytesMax;
    chunk.count = 5;
    chunk.index = 2; // outside the window
    EXPECT_TRUE(refused(chunk));
    chunk = good;
    chunk.blob_size_bytes = 0xffffffff;
    chunk.count = chunk_count(chunk.blob_size_bytes);
    chunk.index = 0xffffffff;
    EXPECT_TRUE(refused(chunk));
}

TEST(BlobTransfer, RefusesATransferThatChangesItsSize) {
    Chunk chunk;
    chunk.transfer = 1;
    chunk.count = 3;
    chunk.blob_size_bytes = 2 * kChunkSizeBytesMax + 5;
    chunk.bytes.resize(kChunkSizeBytesMax);
    BlobReceiver receiver;
    receiver.expect(BlobKind::snapshot, kBlobSizeBytesMax);
    EXPECT_FALSE(receiver.receive(chunk).violation.has_value());
    chunk.index = 1;
    chunk.blob_size_bytes += 1;
    EXPECT_EQ(receiver.receive(chunk).violation, Violation::chunk_malformed);
}

TEST(BlobTransfer, ANewTransferReplacesTheOldOneWhoseChunksAreIgnored) {
    BlobSender sender;
    BlobReceiver receiver;
    receiver.expect(BlobKind::snapshot, kBlobSizeBytesMax);
    sender.start(BlobKind::snapshot, sender.transfer() + 1, blob_of(3 * kChunkSizeBytesMax, 1));
    const std::vector<Chunk> old = poll(sender, 1);
    receiver.receive(old[0]);
    const std::vector<std::byte> bytes = blob_of(50, 2);
    sender.start(BlobKind::snapshot, sender.transfer() + 1, bytes);
    receiver.expect(BlobKind::snapshot, kBlobSizeBytesMax, sender.transfer());
    const BlobReceiver::Outcome stale = receiver.receive(old[1]);
    EXPECT_FALSE(stale.ack.has_value());
    EXPECT_FALSE(stale.violation.has_value());
    const BlobReceiver::Outcome outcome = receiver.receive(poll(sender, 2).at(0));
    ASSERT_TRUE(outcome.blob.has_value());
    EXPECT_EQ(outcome.blob->bytes, bytes);
    sender.receive(ChunkAck{1, 0}); // of the old transfer
    EXPECT_TRUE(sender.active());
    sender.receive(*outcome.ack);
    EXPECT_FALSE(sender.active());
}

} // namespace
} // namespace lockwind::testing
