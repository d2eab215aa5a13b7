#include "physics/rigid/library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "physics/test_world.h"

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
  // Uniform over [0, n): a tenth falls into each tenth; the small n make it uneven by a few, five deviations
  // are 47.
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

TEST(RigidLibrary, AnEngineWhoseStepOdeBrokeOffCanBeDestroyed) {
  // A grain of 0.1 um, with moments of 1e-33 kg m^2, is sunk into the ground by half its size and pushed out.
  test::World world(*find_engine("rigid").value());
  world.add(test::ground());
  world.add(test::body_of("grain", Box{{1e-7, 1e-7, 1e-7}}, 1e-18, {{}, quat_from_rpy(0.3, 0.2, 0.1)}));
  Status status;
  for (int k = 0; k < 2000 && status; ++k) {
    world.engine->step(0.001, 0);
    status = world.engine->check_finite();
  }
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, testing::HasSubstr("no longer finite (ODE: "));
  world.engine.reset();  // would end the process
}

}  // namespace
}  // namespace sandlot::rigid::library
