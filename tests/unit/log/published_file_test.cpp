#include "log/published_file.h"
#include "tests/unit/log/log_fixture.h"

namespace lockwind::test {
namespace {

class PublishedFileTest : public LogFixture {};

TEST_F(PublishedFileTest, AppearsWhenItIsWholeAndNotBefore) {
    PublishedFile file(path("report"));
    file.write("all of it");
    EXPECT_FALSE(std::filesystem::exists(path("report")));
    ASSERT_TRUE(file.publish().ok());
    EXPECT_EQ(read_file(path("report")), "all of it");
}

TEST_F(PublishedFileTest, LeavesNothingUnlessPublished) {
    PublishedFile(path("report")).write("half of it");
    EXPECT_TRUE(std::filesystem::is_empty(path(".")));
}

TEST_F(PublishedFileTest, TakesAnothersPlaceOnlyWhenTold) {
    write_file(path("report"), "old");
    PublishedFile refused(path("report"));
    refused.write("new");
    EXPECT_FALSE(refused.publish().ok());
    EXPECT_EQ(read_file(path("report")), "old");
    PublishedFile replacing(path("report"));
    replacing.write("new");
    EXPECT_TRUE(replacing.replace().ok());
    EXPECT_EQ(read_file(path("report")), "new");
}

TEST_F(PublishedFileTest, SaysThatItCannotBeWritten) {
    PublishedFile file(path("no-such-folder/report"));
    file.write("anything");
    EXPECT_FALSE(file.publish().ok());
    EXPECT_FALSE(file.replace().ok());
}

} // namespace
} // namespace lockwind::test
