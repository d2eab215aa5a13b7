#include "controllers/selforg/selforg.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include "base/base64.h"

namespace sandlot::controllers::selforg {
extern const ControllerKind kind;
namespace {

Node place(const char* device, const char* value, const char* min, const char* max) {
  Node node = Node::map();
  node.set("device", Node::scalar(device));
  if (*value) node.set("value", Node::scalar(value));
  node.set("min", Node::scalar(min));
  node.set("max", Node::scalar(max));
  return node;
}

/// A robot with a hinge of +-2 rad, a drive, and motors for both.
struct Rig {
  Description robot;
  sandlot::Topic<msg::Float64MultiArray> hinge{"/me/hinge/angles"};
  sandlot::Topic<msg::Float64> light{"/me/light/level"};
  Outputs out{"me/controller"};
  SelfOrg controller;
  Command cmd;
  std::uint64_t steps = 0;

  Rig() {
    robot.robot = "me";
    robot.readings = {{"hinge", "angles", msg::Float64MultiArray::ros_type, 0, {}},
                      {"light", "level", msg::Float64::ros_type, 1, {}}};
    robot.actuators = {{"drive", "", msg::Twist::ros_type, 0, {}},
                       {"hip", "", msg::Float64::ros_type, 1, {}}};
    hinge.message.data = {0, 0};
    cmd.bind(&out);
  }
  static Node config() {
    Node node = Node::map();
    Node sensors = Node::sequence(), motors = Node::sequence();
    sensors.push(place("hinge", "data[1]", "-2", "2"));
    sensors.push(place("light", "", "0", "10"));
    motors.push(place("hip", "", "0", "4"));
    motors.push(place("drive", "angular.z", "-3", "3"));
    motors.push(place("drive", "linear.x", "-1", "1"));
    node.set("sensors", sensors);
    node.set("motors", motors);
    node.set("noise", Node::scalar("0"));
    return node;
  }
  Status init(const Node& node = config()) { return controller.init(robot, node, out); }
  void step() {
    const TopicBase* const topics[] = {&hinge, &light};
    const std::vector<std::uint64_t> seen{0, 0};
    ++steps;
    const Observation obs(Time::from_s(static_cast<double>(steps)), topics, seen,
                          Stream(1, 2, Purpose::controller, steps));
    cmd.clear();
    controller.step(obs, cmd);
  }
  template <class M>
  M order(std::uint32_t slot) {
    M message{};
    for (const auto& each : cmd.orders()) {
      if (each.slot != slot) continue;
      ByteReader r(cmd.bytes(each));
      read(r, message);
    }
    return message;
  }
  void see(int k) {
    hinge.message.data[1] = k % 7 - 3.0;
    light.message.data = k % 5;
    hinge.publish(Time::from_s(1));
    light.publish(Time::from_s(1));
  }
};

TEST(SelfOrg, TheAgentIsThatOfThePlainProgramToTheBit) {
  Rig rig;
  const Status ready = rig.init();
  ASSERT_TRUE(static_cast<bool>(ready)) << ready.error().text();
  ::sandlot::selforg::AgentSpec spec;
  spec.noise = 0;
  spec.name = "me";
  auto plain = ::sandlot::selforg::WiredController::make(2, 3, spec);
  ASSERT_TRUE(static_cast<bool>(plain));
  std::vector<double> x(2), y(3);
  for (int k = 0; k < 200; ++k) {
    rig.see(k);
    rig.step();
    x = {(k % 7 - 3.0) / 2, (k % 5 - 5.0) / 5};
    (*plain)->step(x, y);
    ASSERT_EQ(rig.order<msg::Float64>(1).data, 2 + 2 * y[0]) << k;
    ASSERT_EQ(rig.order<msg::Twist>(0).angular.z, 3 * y[1]);
    ASSERT_EQ(rig.order<msg::Twist>(0).linear.x, y[2]);
  }
}

TEST(SelfOrg, SavedAgentsGoOnToTheSameBytes) {
  Rig one, two;
  ASSERT_TRUE(static_cast<bool>(one.init()));
  ASSERT_TRUE(static_cast<bool>(two.init()));
  for (int k = 0; k < 77; ++k) one.see(k), one.step();
  ASSERT_TRUE(static_cast<bool>(one.controller.set_parameter("parameters/epsC", Node::scalar("0.3"))));
  ByteWriter w;
  one.controller.save(w);
  ByteReader r(w.bytes());
  two.controller.load(r);
  ASSERT_TRUE(r.ok());
  two.steps = one.steps;
  for (int k = 77; k < 150; ++k) one.see(k), one.step(), two.see(k), two.step();
  ByteWriter a, b;
  one.controller.save(a);
  two.controller.save(b);
  EXPECT_TRUE(std::equal(a.bytes().begin(), a.bytes().end(), b.bytes().begin(), b.bytes().end()));
  EXPECT_EQ(two.controller.value(ValuePart::parameter, *parse_value_path("parameters.epsC")).value, 0.3);
  std::vector<std::byte> cut(w.bytes().begin(), w.bytes().end() - 9);
  ByteReader short_one(cut);
  two.controller.load(short_one);
  EXPECT_FALSE(short_one.ok());
}

TEST(SelfOrg, ParametersThatAreTunedBeforeTheFirstStepAreKept) {
  Rig rig;
  Node node = Rig::config();
  Node wiring = Node::map();
  wiring.set("kind", Node::scalar("feedback"));
  node.set("wiring", Node::sequence()).push(wiring);
  ASSERT_TRUE(static_cast<bool>(rig.init(node)));
  ASSERT_TRUE(static_cast<bool>(rig.controller.set_parameter("parameters/error", Node::scalar("root"))));
  ASSERT_TRUE(static_cast<bool>(rig.controller.set_parameter("wiring/factor", Node::scalar("0.5"))));
  ASSERT_TRUE(static_cast<bool>(rig.controller.set_parameter("noise", Node::scalar("0.2"))));
  EXPECT_FALSE(static_cast<bool>(rig.controller.set_parameter("agent", Node::scalar("dep")))) << "fixed";
  rig.step();
  const auto parameter = [&](const char* path) {
    return rig.controller.value(ValuePart::parameter, *parse_value_path(path)).value;
  };
  EXPECT_EQ(parameter("parameters.error"), 2);
  EXPECT_EQ(parameter("wiring.factor"), 0.5);
  EXPECT_EQ(parameter("noise"), 0.2);
}

std::string base64(std::span<const std::byte> bytes) {
  std::string text;
  add_base64(bytes, text);
  return text;
}

TEST(SelfOrg, AStoredAgentGoesOnInAnotherRunWhetherItHasBegunOrNot) {
  for (const int before : {0, 30}) {
    Rig one, two;
    ASSERT_TRUE(static_cast<bool>(one.init()) && static_cast<bool>(two.init()));
    for (int k = 0; k < 77; ++k) one.see(k), one.step();
    const std::vector<std::byte> file = one.controller.agent().stored();
    for (int k = 0; k < before; ++k) two.see(k + 3), two.step();
    ASSERT_TRUE(static_cast<bool>(two.controller.check_learned(file, "file")));
    const Status taken = two.controller.set_parameter("learned", Node::scalar(base64(file)));
    ASSERT_TRUE(static_cast<bool>(taken)) << taken.error().text();
    // Without noise nothing depends on the seed.
    for (int k = 77; k < 150; ++k) {
      one.see(k), one.step(), two.see(k), two.step();
      ASSERT_EQ(one.order<msg::Float64>(1).data, two.order<msg::Float64>(1).data) << before << " " << k;
    }
    EXPECT_EQ(one.controller.agent().stored(), two.controller.agent().stored());
  }
}

TEST(SelfOrg, WhatWasLoadedBeforeTheFirstStepIsSavedAndKept) {
  Rig one, two, three;
  ASSERT_TRUE(static_cast<bool>(one.init()) && static_cast<bool>(two.init()) &&
              static_cast<bool>(three.init()));
  for (int k = 0; k < 40; ++k) one.see(k), one.step();
  ASSERT_TRUE(static_cast<bool>(
      two.controller.set_parameter("learned", Node::scalar(base64(one.controller.agent().stored())))));
  ByteWriter w;
  two.controller.save(w);
  ByteReader r(w.bytes());
  three.controller.load(r);
  ASSERT_TRUE(r.ok());
  two.see(5), two.step(), three.see(5), three.step();
  EXPECT_EQ(two.controller.agent().stored(), three.controller.agent().stored());
  EXPECT_EQ(two.controller.agent().steps(), 41u);
}

TEST(SelfOrg, ForeignAgentsAreRefusedAndChangeNothing) {
  Rig rig, other;
  Node semox = Rig::config();
  semox.set("agent", Node::scalar("semox"));
  ASSERT_TRUE(static_cast<bool>(rig.init()) && static_cast<bool>(other.init(semox)));
  for (int k = 0; k < 20; ++k) rig.see(k), rig.step();
  ByteWriter before, after;
  rig.controller.save(before);
  const auto complaint = [&](const Node& value) {
    const Status status = rig.controller.set_parameter("learned", value);
    return status ? std::string() : status.error().what;
  };
  EXPECT_EQ(complaint(Node::scalar(base64(other.controller.agent().stored()))),
            "'learned' holds semox behind one_to_one; this agent is sox behind one_to_one");
  EXPECT_EQ(complaint(Node::scalar("***")), "'learned' takes a stored agent in Base64");
  EXPECT_EQ(complaint(Node::map()), "'learned' takes a stored agent in Base64");
  EXPECT_EQ(complaint(Node::scalar("")), "'learned' is not a stored agent");
  std::vector<std::byte> cut = rig.controller.agent().stored();
  cut.resize(cut.size() / 2);
  EXPECT_EQ(complaint(Node::scalar(base64(cut))), "'learned' is damaged or incomplete");
  rig.controller.save(after);
  EXPECT_TRUE(
      std::equal(before.bytes().begin(), before.bytes().end(), after.bytes().begin(), after.bytes().end()));
}

TEST(SelfOrg, ParametersAndStateOfWiringsAreValues) {
  Rig rig;
  ASSERT_TRUE(static_cast<bool>(rig.init()));
  const auto number = [&](ValuePart part, const char* path) {
    return rig.controller.value(part, *parse_value_path(path));
  };
  EXPECT_EQ(number(ValuePart::parameter, "wiring[0].noise.strength").value, 1);
  ASSERT_TRUE(
      static_cast<bool>(rig.controller.set_parameter("wiring/0/noise/strength", Node::scalar("0.5"))));
  EXPECT_EQ(number(ValuePart::parameter, "wiring.noise.strength").value, 0.5);
  rig.hinge.message.data[1] = std::nan("");
  rig.hinge.publish(Time::from_s(1));
  rig.step();
  rig.step();
  EXPECT_EQ(number(ValuePart::state, "bad_sensors").value, 2);
  EXPECT_EQ(number(ValuePart::state, "wiring[0].noise.t").value, 2);
  EXPECT_EQ(number(ValuePart::state, "wiring[1].noise.t").is, ValueFound::Is::unknown);
  std::vector<std::string> paths;
  rig.controller.list_values(ValuePart::parameter, [&](const ValueEntry& e) { paths.push_back(e.path); });
  EXPECT_NE(std::find(paths.begin(), paths.end(), "wiring[0].noise.strength"), paths.end());
  EXPECT_NE(std::find(paths.begin(), paths.end(), "parameters.epsC"), paths.end());
}

TEST(SelfOrg, DescribesTheParametersOfAllAgents) {
  const auto fields = kind.describe();
  const auto has = [&](std::string_view path) {
    return std::count_if(fields.begin(), fields.end(),
                         [&](const FieldInfo& each) { return each.path == path; });
  };
  EXPECT_EQ(has("noise"), 1);
  EXPECT_EQ(has("parameters/epsC"), 1) << "Sox and SeMoX have it";
  EXPECT_EQ(has("parameters/main/epsC"), 1);
  EXPECT_EQ(has("parameters/synboost"), 1);
  EXPECT_EQ(has("parameters/init_feedback"), 1);
  for (const FieldInfo& each : fields) {
    EXPECT_FALSE(each.path == "parameters/init_feedback" && each.tunable);
    EXPECT_FALSE(each.path == "parameters/file" && each.required) << "of some agents only";
  }
}

TEST(SelfOrg, PublishesMatricesRowAfterRow) {
  Rig rig;
  ASSERT_TRUE(static_cast<bool>(rig.init()));
  rig.see(1);
  rig.step();
  rig.out.commit(Time::from_s(1));
  const msg::Float64MultiArray* C = nullptr;
  for (const auto& output : rig.out.all())
    if (output.topic->name() == "/me/controller/C") {
      const auto* topic = topic_cast<msg::Float64MultiArray>(output.topic.get());
      C = &topic->message;
    }
  ASSERT_NE(C, nullptr);
  EXPECT_EQ(C->layout.dim[0].size, 3u);
  EXPECT_EQ(C->layout.dim[1].size, 2u);
  EXPECT_EQ(C->data, (std::vector<double>{1, 0, 0, 1, 0, 0}));  // the identity of 3 x 2
}

TEST(SelfOrg, BrokenSensorsNoSensorsAndDeadMatricesGiveFiniteOrders) {
  Node blind = Rig::config();
  blind.set("sensors", Node::sequence());
  for (const char* agent : {"sox", "semox", "dep", "experts"}) {
    Rig broken, none;
    Node node = Rig::config(), without = blind;
    node.set("agent", Node::scalar(agent)), without.set("agent", Node::scalar(agent));
    ASSERT_TRUE(static_cast<bool>(broken.init(node)) && static_cast<bool>(none.init(without))) << agent;
    for (int k = 0; k < 200; ++k) {
      broken.see(k);
      if (k % 3 == 0)
        broken.hinge.message.data[1] = k % 2 ? std::nan("") : std::numeric_limits<double>::infinity();
      if (k > 100)
        broken.hinge.message.data = {0, 0}, broken.light.message.data = 5;  // silence: singular matrices
      broken.hinge.publish(Time::from_s(1));
      broken.step();
      none.step();
      for (Rig* const rig : {&broken, &none}) {
        const double hip = rig->order<msg::Float64>(1).data;
        ASSERT_TRUE(hip >= 0 && hip <= 4) << agent << " " << k;
        ASSERT_TRUE(std::abs(rig->order<msg::Twist>(0).angular.z) <= 3) << agent << " " << k;
      }
    }
  }
}

TEST(SelfOrg, ParametersOutOfRangeAreRefusedByName) {
  const auto error_of = [](const char* parameter, const char* value) {
    Rig rig;
    Node node = Rig::config(), parameters = Node::map();
    parameters.set(parameter, Node::scalar(value));
    node.set("parameters", parameters);
    const Status ready = rig.init(node);
    return ready ? std::string() : ready.error().text();
  };
  EXPECT_EQ(error_of("epsC", "5"), "");
  for (const char* value : {"5.1", "-0.1", "nan", "inf", "fast"})
    EXPECT_NE(error_of("epsC", value).find("epsC"), std::string::npos) << value;
  EXPECT_NE(error_of("s4delay", "10").find("[1, 9]"), std::string::npos);
  EXPECT_NE(error_of("epsD", "1").find("'epsD'"), std::string::npos);
  Rig rig;
  ASSERT_TRUE(static_cast<bool>(rig.init()));
  EXPECT_FALSE(static_cast<bool>(rig.controller.set_parameter("parameters/epsC", Node::scalar("9"))));
  EXPECT_EQ(rig.controller.value(ValuePart::parameter, *parse_value_path("parameters.epsC")).value, 0.1);
}

TEST(SelfOrg, RefusesWhatIsNotThere) {
  const auto complaint = [](auto&& change) {
    Rig rig;
    Node node = Rig::config();
    change(node);
    const Status ready = rig.init(node);
    return ready ? std::string() : ready.error().path + ": " + ready.error().what;
  };
  EXPECT_EQ(complaint([](Node&) {}), "");
  EXPECT_EQ(complaint([](Node& n) { n.find("sensors")->items()[0].set("device", Node::scalar("hing")); }),
            "/sensors/0/device: the robot has no 'hing'");
  EXPECT_EQ(complaint([](Node& n) { n.find("motors")->items()[1].set("value", Node::scalar("angular.x")); }),
            "/motors/1/value: 'drive' takes a Twist, which has no 'angular.x'");
  EXPECT_NE(complaint([](Node& n) {
              n.find("sensors")->items()[0].set("max", Node::scalar("-2"));
            }).find("an empty range"),
            std::string::npos);
  EXPECT_NE(complaint([](Node& n) { n.set("agent", Node::scalar("sax")); }).find("no controller kind 'sax'"),
            std::string::npos);
}

TEST(SelfOrg, PatternsAndSpreadsAreTheirListsWrittenOut) {
  const auto with_lists = [](const std::vector<std::array<const char*, 2>>& sensors,
                             const std::vector<const char*>& motors) {
    Rig rig;
    Node node = Node::map(), in = Node::sequence(), out = Node::sequence();
    for (const auto& [device, value] : sensors) in.push(place(device, value, "-2", "2"));
    for (const char* motor : motors) out.push(place(motor, "", "-1", "1"));
    node.set("sensors", in);
    node.set("motors", out);
    rig.robot.actuators = {{"hip_1", "", msg::Float64::ros_type, 0, {}},
                           {"hand", "", msg::Float64::ros_type, 1, {}},
                           {"hip_2", "", msg::Float64::ros_type, 2, {}}};
    const Status ready = rig.init(node);
    if (!ready) return ready.error().path + ": " + ready.error().what;
    for (int k = 0; k < 20; ++k) rig.see(k), rig.step();
    std::string orders;
    for (std::uint32_t slot = 0; slot < 3; ++slot)
      orders += std::to_string(rig.order<msg::Float64>(slot).data) + " ";
    return orders;
  };
  const std::string all = with_lists({{"hinge", "data[0..1]"}}, {"hip_*"});
  EXPECT_EQ(all, with_lists({{"hinge", "data[0]"}, {"hinge", "data[1]"}}, {"hip_1", "hip_2"}));
  EXPECT_NE(all, with_lists({{"hinge", "data[0..1]"}}, {"hip_2", "hip_1"}));
  EXPECT_EQ(with_lists({{"hinge", "data[0]"}}, {"leg_*"}), "/motors/0/device: the robot has no 'leg_*'");
  for (const char* wrong : {"data[1..0x]", "data[1..0]", "data[..1]"})
    EXPECT_EQ(with_lists({{"hinge", wrong}}, {"hip_*"}).rfind("/sensors/0/value: ", 0), 0u) << wrong;
}

TEST(SelfOrg, AnInfiniteNumberIsTheEndOfTheRange) {
  Rig rig, other;
  ASSERT_TRUE(static_cast<bool>(rig.init()));
  ASSERT_TRUE(static_cast<bool>(other.init()));
  for (int k = 0; k < 20; ++k) {
    rig.light.message.data = k % 2 ? INFINITY : -INFINITY;
    other.light.message.data = k % 2 ? 10 : 0;  // the range's ends
    for (Rig* each : {&rig, &other}) {
      each->light.publish(Time::from_s(1));
      each->step();
    }
  }
  EXPECT_EQ(rig.order<msg::Float64>(1).data, other.order<msg::Float64>(1).data);
}

TEST(SelfOrg, CrossMotorTeachingIsThatOfTheLibrary) {
  Rig rig;
  Node node = Rig::config(), sources = Node::sequence();
  for (const char* source : {"1", "-1", "0"}) sources.push(Node::scalar(source));
  node.set("cross_motor", sources);
  node.set("cross_motor_threshold", Node::scalar("0.1"));
  ASSERT_TRUE(static_cast<bool>(rig.init(node)));
  ::sandlot::selforg::AgentSpec spec;
  spec.noise = 0;
  spec.name = "me";
  auto plain = ::sandlot::selforg::WiredController::make(2, 3, spec);
  auto teaching = ::sandlot::selforg::CrossMotorTeaching::make({{1}, {}, {0}}, 0.1);
  std::vector<double> x(2), y(3);
  for (int k = 0; k < 100; ++k) {
    rig.see(k);
    rig.step();
    x = {(k % 7 - 3.0) / 2, (k % 5 - 5.0) / 5};
    teaching->teach(*(*plain)->controller().teachable());
    (*plain)->step(x, y);
    ASSERT_EQ(rig.order<msg::Float64>(1).data, 2 + 2 * y[0]) << k;
  }
}

TEST(SelfOrg, TheRewardIsTheSumOfItsTerms) {
  Rig rig;
  Node node = Rig::config(), terms = Node::sequence();
  const auto term = [&](std::vector<const char*> values, const char* min, const char* max, const char* weight,
                        bool magnitude) {
    Node each = Node::map(), list = Node::sequence();
    for (const char* value : values) list.push(Node::scalar(value));
    each.set("device", Node::scalar("hinge"));
    each.set("values", list);
    each.set("min", Node::scalar(min));
    each.set("max", Node::scalar(max));
    each.set("weight", Node::scalar(weight));
    each.set("magnitude", Node::scalar(magnitude ? "true" : "false"));
    terms.push(each);
  };
  term({"data[0]", "data[1]"}, "0", "10", "0.5", true);
  term({"data[0]", "data[1]"}, "-8", "8", "1", false);
  node.set("reward", terms);
  ASSERT_TRUE(static_cast<bool>(rig.init(node)));
  ::sandlot::selforg::AgentSpec spec;
  spec.noise = 0;
  spec.name = "me";
  auto plain = ::sandlot::selforg::WiredController::make(2, 3, spec);
  std::vector<double> x(2), y(3);
  for (int k = 0; k < 100; ++k) {
    rig.see(k);
    rig.hinge.message.data[0] = 4;
    const double other = k % 7 - 3.0;
    rig.step();
    x = {other / 2, (k % 5 - 5.0) / 5};
    const double size = std::sqrt(16 + other * other);
    (*plain)->controller().rewardable()->set_reward(0.5 * ((size - 5) / 5) + (4 + other) / 8);
    (*plain)->step(x, y);
    ASSERT_EQ(rig.order<msg::Float64>(1).data, 2 + 2 * y[0]) << k;
  }
}

TEST(SelfOrg, RefusesGuidanceThatCannotBe) {
  const auto complaint = [](const char* agent, const char* key, const char* value, bool list) {
    Rig rig;
    Node node = Rig::config();
    node.set("agent", Node::scalar(agent));
    Node all = Node::sequence();
    if (list) {
      all.push(Node::scalar(value));
    } else {
      Node term = Node::map(), values = Node::sequence();
      values.push(Node::scalar("data"));
      term.set("device", Node::scalar(value));
      term.set("values", values);
      all.push(term);
    }
    node.set(key, all);
    const Status ready = rig.init(node);
    return ready ? std::string() : ready.error().path + ": " + ready.error().what;
  };
  EXPECT_EQ(complaint("sox", "reward", "light", false), "");
  EXPECT_EQ(complaint("dep", "reward", "light", false), "/reward: agents of kind dep take no reward");
  EXPECT_EQ(complaint("sox", "reward", "lamp", false), "/reward/0/device: the robot has no 'lamp'");
  EXPECT_EQ(complaint("sox", "reward", "hinge", false), "/reward/0/values/0: 'hinge' gives no number 'data'");
  EXPECT_EQ(complaint("dep", "cross_motor", "0", true), "/cross_motor: agents of kind dep cannot be taught");
  EXPECT_EQ(complaint("sox", "cross_motor", "0", true), "/cross_motor: 1 teachers for 3 motors");
}

}  // namespace
}  // namespace sandlot::controllers::selforg
