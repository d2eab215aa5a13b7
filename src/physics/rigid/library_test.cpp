#include "physics/rigid/library.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

namespace sandlot::rigid::library {
namespace {

TEST(RigidLibrary, OdeDrawsFromUs) {
  prepare_thread();  // stops the program if it does not
  seed(1);
  const std::uint64_t before = counts().draws;
  int spread[10] = {};
  for (int n = 1; n <= 1000; ++n) {
    const int x = dRandInt(n);
    ASSERT_GE(x, 0);
    ASSERT_LT(x, n);
    EXPECT_EQ(x, dRandInt(n));  // of the seed and n alone
    ++spread[10 * x / n];
  }
  EXPECT_EQ(counts().draws, before + 2000);
  // Uniform over [0, n): a tenth falls into each tenth; the small n make it uneven by a few, five deviations are 47.
  for (const int count : spread) EXPECT_NEAR(count, 100, 50);
  const int first = dRandInt(1'000'000);
  seed(2);
  EXPECT_NE(dRandInt(1'000'000), first);
}

TEST(RigidLibrary, MessagesAreCountedInsteadOfPrinted) {
  prepare_thread();
  const std::uint64_t before = counts().messages;
  ::testing::internal::CaptureStderr();
  dMessage(3, "said %d times", 1);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(counts().messages, before + 1);
}

TEST(RigidLibrary, AllocationsAreCounted) {
  prepare_thread();
  const std::uint64_t before = counts().allocations;
  dGeomDestroy(dCreateSphere(nullptr, 1));
  EXPECT_GT(counts().allocations, before);
}

TEST(RigidLibrary, AnErrorOfOdeCanBeCaughtSoThatTheRunEndsWithItsResults) {
  prepare_thread();
  try {
    dDebug(1, "something %s", "broke");
    FAIL() << "dDebug returned";
  } catch (const Fault& fault) { EXPECT_EQ(fault.message, "something broke"); }
}

}  // namespace
}  // namespace sandlot::rigid::library
