/// sandlot fit: parameters that were hidden in a recorded run are found again.
#include <gtest/gtest.h>

#include <cmath>

#include "command.h"

namespace sandlot::test {
namespace {

constexpr const char* gain = "robots[0].devices.left_motor.velocity.p";
constexpr const char* integral = "robots[0].devices.left_motor.velocity.i";
constexpr const char* friction = "robots[0].devices.left_motor.friction";

/// One cart, whose left motor is the subject.
class Fit : public testing::Test {
 protected:
  void SetUp() override {
    scratch.write("cart.yaml",
                  "version: 1\nname: cart\nphysics: rigid\n"
                  "time: {step: 10 ms, substeps: 2, stop: 3 s}\nseed: 1\nrobots:\n"
                  "  - name: cart\n    model: " +
                      std::filesystem::absolute("models/cart/model.sdf").string() +
                      "\n    devices:\n"
                      "      left_motor: {velocity: {p: 1, i: 1}, friction: 0.0002}\n"
                      "      right_motor: {velocity: {p: 2, i: 12}}\n"
                      "    controller:\n      kind: sequence\n      steps:\n"
                      "        - {at: 0.2 s, orders: {left_motor: 12, right_motor: 12}}\n"
                      "        - {at: 1.6 s, orders: {left_motor: 2, right_motor: 2}}\n");
    record("");
  }
  void record(const std::string& more) {
    const Printed run = sandlot("run " + scenario() + " --headless --record " + recording() + " --set " +
                                gain + "=0.7 --set " + integral + "=5 --set " + friction + "=0.0005 " + more);
    ASSERT_EQ(run.exit_code, 0) << run.out;
  }
  std::string scenario() const { return scratch.file("cart.yaml"); }
  std::string recording() const { return scratch.file("run.mcap"); }
  Printed fit(const std::string& arguments) const {
    return sandlot("fit " + scenario() + " --recording " + recording() + " " + arguments);
  }
  static std::string parameter(const char* address, const char* range) {
    return std::string(" --parameter ") + address + "=" + range;
  }
  TestFolder scratch;
};

TEST_F(Fit, FindsGainsThatWereHidden) {
  const Printed printed = fit("--json --runs 200 --screening 8 --out " + scratch.file("sets") +
                              parameter(gain, "0.1:5:log") + parameter(integral, "0.5:20:log") + " --set " +
                              friction + "=0.0005");
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  const auto json = nlohmann::json::parse(printed.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << printed.out;
  const std::vector<double> hidden{0.7, 5};
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const auto& p = json["parameters"][i];
    EXPECT_NEAR(p["value"].get<double>(), hidden[i], 0.02 * hidden[i]) << printed.out;
  }
  for (const auto& c : json["compared"])
    EXPECT_LE(c["rms_after"].get<double>(), 0.1 * c["rms_before"].get<double>() + 1e-6) << printed.out;
  EXPECT_LE(json["runs"].get<int>(), 200);
}

/// Three at once, one of which does little: each within its interval, which is narrow.
TEST_F(Fit, FindsGainsAndFrictionTogether) {
  const Printed printed = fit("--json --runs 400 --screening 12" + parameter(gain, "0.1:5:log") +
                              parameter(integral, "0.5:20:log") + parameter(friction, "0.00005:0.005:log"));
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  const auto json = nlohmann::json::parse(printed.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << printed.out;
  const std::vector<double> hidden{0.7, 5, 0.0005};
  for (std::size_t i = 0; i < hidden.size(); ++i)
    EXPECT_NEAR(json["parameters"][i]["value"].get<double>(), hidden[i], 0.02 * hidden[i]) << printed.out;
}

TEST_F(Fit, NamesAParameterThatChangesNothing) {
  const Printed printed = fit("--runs 40 --screening 2" + parameter(gain, "0.2:2:log") +
                              parameter("robots[0].devices.left_motor.max_rate", "200:900") +
                              " --compare /cart/right_motor/velocity.voltage");
  EXPECT_NE(printed.out.find("max_rate changes nothing that is compared"), std::string::npos) << printed.out;
}

TEST_F(Fit, SaysWhatIsWrong) {
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const Printed printed = fit(arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments << "\n" << printed.out;
    EXPECT_NE(printed.out.find(words), std::string::npos) << arguments << "\n" << printed.out;
  };
  refused(parameter(gain, "5:0.1"), "the lower limit must be below the upper one");
  refused(parameter(gain, "0.1"), "is not ADDRESS=LOW:HIGH");
  refused(parameter(gain, "0:1:log"), "log needs limits above 0");
  refused(parameter(gain, "0.1:2") + parameter(gain, "0.1:3"), "more than once");
  refused(parameter(gain, "0.1:2") + " --set " + gain + "=7", "it must lie in its limits");
  refused(parameter("robots[0].devices.left_motor.frictoin", "0.1:2"), "friction");
  refused(parameter(gain, "0.1:2") + " --compare /cart/left_motor/velocity.velocty", "'velocity'");
  refused(parameter(gain, "0.1:2") + " --compare /cart/left_moter/velocity.velocity", "left_motor");
  refused(parameter(gain, "0.1:2") + " --compare /cart/left_motor/velocity.velocity:0", "above 0");
  const Printed other = sandlot("fit scenarios/motor_ramp.yaml --recording " + recording() +
                                parameter(gain, "0.1:2"));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.out.find("another scenario: 'cart', not 'motor_ramp'"), std::string::npos) << other.out;
}

}  // namespace
}  // namespace sandlot::test
