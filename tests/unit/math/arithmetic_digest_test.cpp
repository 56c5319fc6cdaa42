#include "tests/unit/math/arithmetic_digest.h"

#include <gtest/gtest.h>

namespace {

TEST(ArithmeticDigest, TwoLimbsGiveTheBitsOfTheNativeTypes) {
    EXPECT_EQ(portable_digest(), native_digest());
}

TEST(ArithmeticDigest, IsTheSameOnEveryMachineAndInEveryBuild) {
    EXPECT_EQ(native_digest(), 4436304548516606435U);
}

} // namespace
