/// Any bytes as an answer of a program outside: what is read orders only what is there, and nothing when it is refused.
#include "base/check.h"
#include "messages/messages.h"
#include "programs/answer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  using namespace sandlot::programs;
  static const std::vector<Named> readings{{"laser", 0, msg::LaserScan::ros_type},
                                           {"drive", 1, msg::Odometry::ros_type}};
  static const std::vector<Named> actuators{{"drive", 0, msg::Twist::ros_type},
                                            {"drive/TwistStamped", 1, msg::TwistStamped::ros_type},
                                            {"arm", 2, msg::JointTrajectory::ros_type},
                                            {"gone", 3, msg::Float64::ros_type}};
  static Topic<msg::Twist> twist("/rover/drive/ideal/command");
  static Topic<msg::TwistStamped> stamped("/rover/drive/ideal/command");
  static Topic<msg::JointTrajectory> arm("/rover/arm/command");
  static const TopicBase* const forms[] = {&twist, &stamped, &arm, nullptr};
  Command cmd;
  const auto read = read_answer({reinterpret_cast<const char*>(data), size}, readings, actuators, forms, cmd);
  if (!read) {
    SL_CHECK(cmd.orders().empty() && !read.error().what.empty());
    return 0;
  }
  SL_CHECK(read->waiting_for != Program::Waiting::message || read->reading < readings.size());
  SL_CHECK(read->until >= Time{});
  for (const Command::Order& order : cmd.orders())
    SL_CHECK(order.is_sample() ? order.reading() < readings.size() : order.slot < 3);
  return 0;
}
