#include "messages/command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "messages/messages.h"
#include "messages/registry.h"
#include "messages/sample.h"

namespace sandlot {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(CommandBytes, AreTheSameFromAStructCdrAndJson) {
  const Topic<msg::Twist> slot("/x");
  msg::Twist twist;
  twist.linear.x = 1.5;
  twist.angular.z = -2;
  std::vector<std::byte> cdr;
  write_cdr(message_info<msg::Twist>(), &twist, cdr);
  const auto from_cdr = command_from_cdr(slot, cdr);
  const auto from_json = command_from_json(slot, R"({"linear": {"x": 1.5}, "angular": {"z": -2}})");
  ASSERT_TRUE(from_cdr);
  ASSERT_TRUE(from_json);
  EXPECT_EQ(*from_cdr, command_bytes(twist));
  EXPECT_EQ(*from_json, command_bytes(twist));
  EXPECT_FALSE(command_from_cdr(slot, std::span(cdr).first(20)));
  EXPECT_FALSE(command_from_json(slot, ""));
}

TEST(CommandBytes, AreTakenWholeOrNotAtAll) {
  Topic<msg::Float64> slot("/x");
  slot.message.data = 7;
  std::vector<std::byte> bytes = command_bytes(msg::Float64{2});
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(slot.assign(bytes)) << "a byte too many";
  EXPECT_FALSE(slot.assign(std::span(bytes).first(7)));
  EXPECT_EQ(slot.message.data, 7);
  EXPECT_TRUE(slot.assign(std::span(bytes).first(8)));
  EXPECT_EQ(slot.message.data, 2);
}

/// Calls f(field, the number's bytes, in a list) for each floating-point number of a message: a walk along the fields,
/// unlike that of check_command(), which goes along runs of numbers.
template <class F>
void for_each_float(const MessageInfo& info, std::byte* message, const F& f) {
  if (info.is_time) return;
  for (const MessageField& field : info.fields) {
    std::byte* at = message + field.offset;
    std::size_t count = field.count == MessageField::Count::array ? field.length : 1;
    const bool is_list = field.count == MessageField::Count::sequence;
    if (is_list) {
      count = field.vector->size(at);
      at = static_cast<std::byte*>(const_cast<void*>(field.vector->data(at)));
    }
    for (std::size_t i = 0; i < count; ++i, at += field.stride) {
      if (field.message) for_each_float(*field.message, at, f);
      else if (field.type == Wire::float32 || field.type == Wire::float64) f(field, at, is_list);
    }
  }
}

void set_number(const MessageField& field, std::byte* at, double x) {
  if (field.type == Wire::float32) put_number<float>(at, x);
  else put_number<double>(at, x);
}

TEST(CheckCommand, FindsEveryNumberThatIsNotFiniteInEveryType) {
  std::size_t numbers = 0, listed = 0;
  for (const MessageInfo* info : all_messages()) {
    AnyMessage message(*info);
    int values = 0;
    fill_sample(*info, message.data(), values);
    EXPECT_TRUE(check_command(*info, message.data())) << info->name;
    for_each_float(*info, static_cast<std::byte*>(message.data()),
                   [&](const MessageField& field, std::byte* at, bool in_list) {
                     const double before = number_at(field.type, at);
                     for (const double x : {infinity, -infinity}) {
                       set_number(field, at, x);
                       EXPECT_FALSE(check_command(*info, message.data())) << info->name << " " << field.name;
                     }
                     // In a list it leaves that joint or wheel as it is.
                     set_number(field, at, std::nan(""));
                     EXPECT_EQ(static_cast<bool>(check_command(*info, message.data())), in_list)
                         << info->name << " " << field.name;
                     set_number(field, at, before);
                     ++numbers;
                     listed += in_list;
                   });
    EXPECT_TRUE(check_command(*info, message.data())) << info->name;
  }
  // The walk has found them at all: 6 of a Twist, 39 + 36 of an Odometry, lists of a LaserScan and a JointState.
  EXPECT_GT(numbers, 500u);
  EXPECT_GT(listed, 10u);
}

TEST(CheckCommand, RefusesAStampedTwistAndLeavesTheOldCommand) {
  Topic<msg::TwistStamped> slot("/x");
  msg::TwistStamped twist;
  twist.twist.linear.x = 1;
  ASSERT_TRUE(slot.assign(command_bytes(twist)));
  twist.twist.angular.z = std::nan("");
  const Status status = slot.assign(command_bytes(twist));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "the command is not finite");
  EXPECT_EQ(slot.message.twist.angular.z, 0);
}

TEST(CheckCommand, LetsAJointStateLeaveJointsOut) {
  Topic<msg::JointState> slot("/x");
  msg::JointState wheels;
  wheels.velocity = {1, std::nan("")};
  EXPECT_TRUE(slot.assign(command_bytes(wheels)));
  wheels.velocity = {1, infinity};
  EXPECT_FALSE(slot.assign(command_bytes(wheels)));
}

TEST(Standstill, IsAnOrderOfNoVelocityForTheTypesThatDrive) {
  Topic<msg::Twist> plain("/x");
  plain.message.linear.x = 1, plain.message.angular.z = 2;
  ASSERT_TRUE(plain.assign(standstill("geometry_msgs/msg/Twist").value()));
  EXPECT_EQ(plain.message.linear.x, 0);
  EXPECT_EQ(plain.message.angular.z, 0);
  Topic<msg::TwistStamped> stamped("/x");
  stamped.message.twist.linear.y = 1;
  ASSERT_TRUE(stamped.assign(standstill("geometry_msgs/msg/TwistStamped").value()));
  EXPECT_EQ(stamped.message.twist.linear.y, 0);
  EXPECT_FALSE(standstill("std_msgs/msg/Float64"));
  EXPECT_FALSE(standstill("geometry_msgs/msg/TwistWithCovariance"));
}

}  // namespace
}  // namespace sandlot
