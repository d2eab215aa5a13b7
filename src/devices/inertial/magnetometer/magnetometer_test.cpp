#include "devices/inertial/magnetometer/magnetometer.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::magnetometer {
namespace {

using test::config;
using test::Rig;

struct Bench : Rig {
  explicit Bench(Node node, std::uint32_t level_bits = 3) : Rig(kind, test::two_wheels()) {
    magnetic_field_T = {3e-5, 1e-5, -4e-5};
    EXPECT_TRUE(add("mag", std::move(node), level_bits));
  }
  Vec3 field() {
    sense();
    return topic<msg::MagneticField>("mag/field").message.magnetic_field;
  }
  double heading() { return topic<msg::Float64>("mag/heading").message.data; }
};

TEST(Magnetometer, ShowsTheFieldInItsOwnFrame) {
  Bench bench(config({}));
  bench.engine->body[0].X_WB.q = quat_from_rpy(0, 0, math::pi / 2);
  // x of the sensor is the world's y, y its -x.
  const Vec3 b = bench.field();
  EXPECT_NEAR(b.x, 1e-5, 1e-20);
  EXPECT_NEAR(b.y, -3e-5, 1e-20);
  EXPECT_NEAR(b.z, -4e-5, 1e-20);
}

TEST(Magnetometer, TheCompassIsRightAtAnyAttitude) {
  Bench bench(config({}));
  for (const double yaw : {-3.0, -1.0, 0.0, 0.7, 2.9})
    for (const double pitch : {-0.6, 0.0, 0.9}) {
      bench.engine->body[0].X_WB.q = quat_from_rpy(0.4, pitch, yaw);
      bench.field();
      EXPECT_NEAR(bench.heading(), yaw, 1e-14) << pitch;
    }
}

TEST(Magnetometer, IronDistorts) {
  Node node = config({});
  const auto list = [](std::initializer_list<const char*> numbers) {
    Node out = Node::sequence({});
    for (const char* number : numbers) out.push(Node::scalar(number));
    return out;
  };
  node.set("hard_iron", list({"1e-5", "0", "0"}));
  node.set("soft_iron", list({"2", "1", "0.5"}));
  node.set("soft_iron_cross", list({"0.1", "0.2", "0.3"}));
  Bench bench(node);
  // b = (4, 1, -4) e-5
  const Vec3 b = bench.field();
  EXPECT_NEAR(b.x, 1e-5 * (2 * 4 + 0.1 * 1 + 0.2 * -4), 1e-19);
  EXPECT_NEAR(b.y, 1e-5 * (0.1 * 4 + 1 * 1 + 0.3 * -4), 1e-19);
  EXPECT_NEAR(b.z, 1e-5 * (0.2 * 4 + 0.3 * 1 + 0.5 * -4), 1e-19);
}

TEST(Magnetometer, NoHeadingWithoutAHorizontalField) {
  Rig rig(kind, test::two_wheels());
  rig.magnetic_field_T = {0, 0, -4e-5};
  EXPECT_FALSE(rig.add("mag", config({}), 2));
  EXPECT_TRUE(rig.add("mag", config({}), 1));
}

}  // namespace
}  // namespace sandlot::magnetometer
