#include "transport/dds/sender_registry.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

using Writers = std::vector<SenderRegistry::Writer>;

/// Writer handles 1, 2 are of participant 100, handle 3 of participant 200.
const Writers kWriters = {{1, 100}, {2, 100}, {3, 200}};

bool admit(SenderRegistry& registry,
           std::uint64_t writer,
           std::uint32_t sender,
           const Writers& matched = kWriters) {
    return registry.admit(writer, sender, [&] { return matched; });
}

TEST(SenderRegistry, BindsAWriterToItsFirstSender) {
    SenderRegistry registry;
    EXPECT_TRUE(admit(registry, 1, 7));
    EXPECT_TRUE(admit(registry, 1, 7));
    EXPECT_FALSE(admit(registry, 1, 8));
    EXPECT_TRUE(admit(registry, 1, 7));
}

TEST(SenderRegistry, LetsTheWritersOfOneParticipantShareASender) {
    SenderRegistry registry;
    EXPECT_TRUE(admit(registry, 1, 7));
    EXPECT_TRUE(admit(registry, 2, 7));
}

TEST(SenderRegistry, RefusesASenderBoundToAnotherParticipant) {
    SenderRegistry registry;
    EXPECT_TRUE(admit(registry, 1, 7));
    EXPECT_FALSE(admit(registry, 3, 7));
    EXPECT_TRUE(admit(registry, 3, 9));
}

TEST(SenderRegistry, FreesASenderWhenItsWritersAreGone) {
    SenderRegistry registry;
    EXPECT_TRUE(admit(registry, 1, 7));
    EXPECT_TRUE(admit(registry, 3, 7, {{3, 200}}));
    EXPECT_FALSE(admit(registry, 1, 7));
}

TEST(SenderRegistry, AdmitsTheLastWordsOfAWriterThatHasGone) {
    SenderRegistry registry;
    EXPECT_TRUE(admit(registry, 5, 7));
    EXPECT_TRUE(admit(registry, 1, 7)) << "what has gone binds nothing";
    EXPECT_FALSE(admit(registry, 5, 7)) << "the sender is another's now";
}

TEST(SenderRegistry, AsksForTheMatchedWritersOnlyOnce) {
    SenderRegistry registry;
    int asked = 0;
    for (int i = 0; i < 10; ++i) {
        EXPECT_TRUE(registry.admit(1, 7, [&] {
            ++asked;
            return kWriters;
        }));
    }
    EXPECT_EQ(asked, 1);
}

} // namespace
} // namespace lockwind
