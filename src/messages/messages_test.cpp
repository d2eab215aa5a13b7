#include "messages/messages.h"

#include <gtest/gtest.h>

#include <tuple>

#include "messages/topic.h"

namespace sandlot {
namespace {

msg::LaserScan scan() {
  msg::LaserScan m;
  m.header.frame_id = "robot1/laser";
  m.angle_min = -1;
  m.ranges = {1, 2, std::numeric_limits<float>::infinity()};
  m.intensities = {5};
  return m;
}
msg::JointState joint_state() {
  msg::JointState m;
  m.name = {"left", "right"};
  m.position = {1, 2};
  m.velocity = {3, 4};
  return m;
}
msg::Odometry odometry() {
  msg::Odometry m;
  m.child_frame_id = "base";
  m.pose.pose.p = {1, 2, 3};
  m.pose.covariance[35] = 9;
  m.twist.twist.angular.z = 4;
  return m;
}
msg::PoseStamped pose_stamped() {
  msg::PoseStamped m;
  m.pose.q = {0, 0, 0, 1};
  return m;
}
msg::Int64Stamped ticks() {
  msg::Int64Stamped m;
  m.data = -5'000'000'000;
  return m;
}

const auto examples = std::tuple(scan(), joint_state(), odometry(), pose_stamped(), ticks(),
                                 msg::Float64{2.5}, msg::Twist{{1, 2, 3}, {4, 5, 6}});

template <class Each>
void for_each_example(Each&& each) {
  std::apply([&](const auto&... message) { (each(message), ...); }, examples);
}
std::vector<std::byte> bytes_of(const auto& value) {
  ByteWriter w;
  write(w, value);
  return w.buffer();
}

TEST(Messages, SurviveBytes) {
  for_each_example([](const auto& message) {
    const auto bytes = bytes_of(message);
    std::remove_cvref_t<decltype(message)> back;
    ByteReader r(bytes);
    read(r, back);
    EXPECT_TRUE(r.ok() && r.remaining() == 0) << message.ros_type;
    EXPECT_EQ(bytes_of(back), bytes) << message.ros_type;
  });
}

TEST(Messages, EveryTruncationAndEveryTailIsRefusedAndTheOldMessageStays) {
  for_each_example([](const auto& message) {
    using Message = std::remove_cvref_t<decltype(message)>;
    Topic<Message> topic("/x");
    topic.message = message;
    const auto before = bytes_of(message);
    auto bytes = bytes_of(Message{});
    for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_FALSE(topic.assign(std::span(bytes).first(n))) << n;
    bytes.push_back({});
    EXPECT_FALSE(topic.assign(bytes));
    EXPECT_EQ(bytes_of(topic.message), before) << message.ros_type;
    bytes.pop_back();
    EXPECT_TRUE(topic.assign(bytes));
    EXPECT_EQ(bytes_of(topic.message), bytes);
  });
}

TEST(Messages, AnyDamagedByteIsSurvived) {
  const auto bytes = bytes_of(scan());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int value : {0, 1, 0x7f, 0xff}) {
      auto damaged = bytes;
      damaged[i] = static_cast<std::byte>(value);
      Topic<msg::LaserScan> topic("/x");
      (void)topic.assign(damaged);  // true or false, but no crash and no more memory than there are bytes
      EXPECT_LE(topic.message.ranges.capacity(), bytes.size());
    }
}

TEST(Topic, PublishesStampsCountsAndRestores) {
  Topic<msg::LaserScan> topic("/robot1/laser/ranges");
  EXPECT_EQ(topic.count, 0u);
  topic.message = scan();
  topic.publish(Time::from_s(2));
  EXPECT_EQ(topic.count, 1u);
  EXPECT_EQ(topic.stamp, Time::from_s(2));
  EXPECT_EQ(topic.message.header.stamp, Time::from_s(2));
  EXPECT_STREQ(topic.type(), "sensor_msgs/msg/LaserScan");
  ByteWriter w;
  topic.save(w);
  Topic<msg::LaserScan> other("/robot1/laser/ranges");
  ByteReader r(w.bytes());
  other.load(r);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(other.count, 1u);
  EXPECT_EQ(other.message.ranges, topic.message.ranges);
  const auto copy = topic.clone();
  topic.message.ranges[0] = 99;
  EXPECT_EQ(topic_cast<msg::LaserScan>(copy.get())->message.ranges[0], 1);
}

TEST(Topic, CastsByTypeOnly) {
  Topic<msg::Twist> topic("/x");
  TopicBase* base = &topic;
  EXPECT_EQ(topic_cast<msg::Twist>(base), &topic);
  EXPECT_EQ(topic_cast<msg::LaserScan>(base), nullptr);
  EXPECT_EQ(topic_cast<msg::Twist>(static_cast<TopicBase*>(nullptr)), nullptr);
}

TEST(Topic, PublishingAgainCostsNoHeap) {
  Topic<msg::JointState> topic("/x");
  topic.message = joint_state();
  const double* const place = topic.message.position.data();
  topic.message.position = {5, 6};
  topic.publish(Time::from_s(1));
  EXPECT_EQ(topic.message.position.data(), place);
}

}  // namespace
}  // namespace sandlot
