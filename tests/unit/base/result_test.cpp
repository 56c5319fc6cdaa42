#include "lockwind/result.h"

#include <gtest/gtest.h>
#include <memory>

namespace lockwind {
namespace {

TEST(Result, HoldsAValueOrAnError) {
    const Result<int> value = 5;
    EXPECT_TRUE(value.ok());
    EXPECT_EQ(value.value(), 5);
    const Result<int> error = Error{"no"};
    EXPECT_FALSE(error.ok());
    EXPECT_EQ(error.error().message, "no");
}

TEST(Result, HandsOutWhatCannotBeCopied) {
    Result<std::unique_ptr<int>> result = std::make_unique<int>(3);
    const std::unique_ptr<int> taken = std::move(result).value();
    EXPECT_EQ(*taken, 3);
}

TEST(ResultDeathTest, AssertsWhereTheWrongOneIsRead) {
    const Result<int> error = Error{"no"};
    EXPECT_DEATH(static_cast<void>(error.value()), "ok\\(\\)");
    const Result<int> value = 5;
    EXPECT_DEATH(static_cast<void>(value.error()), "!ok\\(\\)");
}

} // namespace
} // namespace lockwind
