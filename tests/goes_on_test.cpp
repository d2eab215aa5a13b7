/// A run goes on elsewhere: from a snapshot in another process, from its recording, from its beginning, from a time before,
/// with robots that come and go. Each ends in the state of the run that nothing interrupted. One scenario per element whose
/// State is easily forgotten: programs outside, of teams and with topics, rules, media.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;

/// A program that forgets nothing when it is started anew: what it orders follows from the observation alone.
constexpr const char* brain = R"(import json, math, sys
open('starts', 'a').write('started\n')
sys.stdin.readline()
for line in sys.stdin:
    seen = json.loads(line)
    x = 0.2 + 0.1 * math.sin(3 * seen['time'])
    print(json.dumps({'orders': {'drive': {'linear': {'x': x}, 'angular': {'z': 4 * x - 1}}}}), flush=True)
)";

struct Scenario {
  const char* name;
  /// `@` stands for the folder of the models.
  const char* text;
  const char* add;   ///< what comes at 0.31 s, as `late`
  const char* more;  ///< steering at 1.6 s
  bool allow_programs = false;

  friend std::ostream& operator<<(std::ostream& out, const Scenario& s) { return out << s.name; }
};

const Scenario scenarios[] = {
    {.name = "Pipe",
     .text = R"(physics: planar
time: {step: 10 ms, control_interval: 10, stop: 2 s}
robots:
  - {name: rover, model: @rover, controller: {kind: pipe, command: [python3, brain.py], deadline: 20 s}}
things:
  - {name: walls, model: {builder: square_playground, length: 6}}
events:
  - {name: driven, when: rover.pose.x > 0.1}
)",
     .add = "box late 0.6 0 size=0.3",
     .more = "set rover/controller.deadline 19",
     .allow_programs = true},
    {.name = "Team",
     .text = R"(physics: planar
time: {step: 20 ms, substeps: 2, stop: 2 s}
teams:
  - {name: red, controller: {name: coach, kind: formation, rate: 10, shape: circle, odometry: truth}}
robots:
  - name: scout
    model: @scout
    count: 5
    team: red
    distribution: {uniform: {width: 6, height: 6, clearance: 0.5}}
    devices: {truth: {kind: ground_truth}, drive: {odometry: false}}
events:
  - {name: told, when: red/coach/arrived.count > 5}
)",
     .add = "copy of scout1 as late 4 4",
     .more = "set red/coach.spacing 1.5"},
    {.name = "Estimator",
     .text = R"(physics: rigid
time: {step: 10 ms, substeps: 2, control_interval: 4, stop: 2 s}
robots:
  - name: rover
    model: @rover
    rate: 30
    controllers:
      - {name: estimator, kind: odometry_estimator, odometry: drive}
      - {name: driver, kind: waypoints, odometry: estimator/estimate, rate: 7, points: [[1, 0.2], [0, 1], [2, 2]]}
    devices:
      gyroscope: {kind: imu, rate: 50}
events:
  - {name: away, when: rover/estimator/estimate.pose.pose.position.x > 0.05}
)",
     .add = "copy of rover as late 3 3",
     .more = "level rover/drive ideal"},
    {.name = "Rules",
     .text = R"(physics: rigid
time: {step: 10 ms, substeps: 2, control_interval: 4, stop: 2 s}
markers:
  - {kind: disc, name: near_hole, centre: [0.75, 0], radius: 0.1}
  - {kind: disc, name: far_hole, centre: [1.3, 0], radius: 0.2}
rules:
  - {kind: goals, object: ball, goals: [{marker: near_hole}, {marker: far_hole}], place: [0, 2, 0.11]}
  - {kind: impact, threshold: 0.001}
  - {kind: place, object: ball, when: ball.pose.y > 1, place: [0.95, 0, 0.11]}
robots:
  - {name: rover, model: @rover, controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [1, 0.1]}}]}}
things:
  - {name: ball, model: @msl_ball, pose: [0.6, 0, 0]}
events:
  - {name: goal, when: "rules/goals.scored[0] > 0"}
  - {name: another, when: "rules/goals.scored[1] > 0"}
  - {name: bump, when: "rules/impact.robots[0].sum > 0"}
  - {name: placed, when: rules/place.count > 1}
)",
     .add = "copy of rover as late 0 -1",
     .more = "set rules/impact.threshold 0.01"},
    {.name = "Media",
     .text = R"(physics: rigid
time: {step: 10 ms, substeps: 2, control_interval: 4, stop: 2 s}
media:
  - {kind: wind, name: breeze, velocity: [-6, 3, 0]}
  - {kind: shout, name: air, speed: 4}
robots:
  - name: rover
    count: 3
    model: @rover
    distribution: {uniform: {width: 4, height: 4, clearance: 0.3}}
    devices: {voice: {kind: voice}, ear: {kind: ear, rate: 5}}
    controllers:
      - {kind: wander}
      - {name: caller, kind: sequence, repeat: 0.3 s, steps: [{at: 0.05 s, orders: {voice: Here}}]}
things:
  - {name: ball, model: @msl_ball, pose: [0.2, 0.1, 0]}
events:
  - {name: heard, when: media/air.heard > 5}
  - {name: under_way, when: media/air.words > 3}
  - {name: blown, when: abs(ball.twist.linear.x) > 0.2}
)",
     .add = "copy of rover1 as late 3 3",
     .more = "set media/breeze.velocity [4, 0, 0]"},
    {.name = "Radio",
     .text = R"(physics: planar
time: {step: 10 ms, control_interval: 4, stop: 2 s}
media:
  - {kind: radio, model: log_distance, access: csma, bandwidth: 2 kbit/s, shadowing: 4, fading: 2, modulation: fsk,
     bit_error_rate: 0.002, drop: 0.1, capture: 3, delay: 15 ms}
  - {kind: infrared}
robots:
  - name: rover
    count: 4
    model: @rover
    distribution: {uniform: {width: 4, height: 4, clearance: 0.3}}
    devices:
      radio: {kind: radio, levels: [packets, bits]}
      light: {kind: infrared, half_angle: 90 deg, acceptance: 180 deg}
      buoy: {kind: range_bearing, medium: radio, beacon_rate: 3, range_noise: {std: 5 cm}}
    controllers:
      - {kind: wander}
      - {name: caller, kind: sequence, repeat: 0.3 s, steps: [{at: 0.05 s, orders: {radio: Here, light: There}}]}
events:
  - {name: delivered, when: media/radio.delivered > 5}
  - {name: damaged, when: media/radio.damaged > 0}
  - {name: lit, when: media/infrared.delivered > 3}
)",
     .add = "copy of rover1 as late 3 3",
     .more = "set media/radio.drop 0.5"},
    // At 1 s the rover is on its way, as is the other, at the other level.
    {.name = "Maneuvers",
     .text = R"(physics: rigid
time: {step: 10 ms, substeps: 2, control_interval: 4, stop: 2 s}
robots:
  - name: rover
    model: @rover
    devices: {drive: {level: contact}}
    controller:
      kind: sequence
      steps:
        - {at: 0.1 s, orders: {drive: {maneuver: straight, distance: 0.1}}}
        - {at: 0.8 s, orders: {drive: {maneuver: to_point, x: -0.3, y: 0.2}}}
  - name: other
    model: @rover
    pose: [0, 2, 0]
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: {maneuver: turn, angle: 2}}}]}
events:
  - {name: second, when: rover/drive/maneuver.maneuvers > 1}
  - {name: turned, when: other.pose.yaw > 1}
)",
     .add = "copy of rover as late 3 3",
     .more = R"(command rover/drive DriveManeuver {"kind": 2, "distance": 1, "angle": 0.5})"},
    // At 1 s the agent is in the middle of learning.
    {.name = "SelfOrg",
     .text = R"(physics: planar
time: {step: 10 ms, control_interval: 4, stop: 2 s}
robots:
  - name: rover
    model: @rover
    controller:
      kind: selforg
      agent: experts
      parameters: {main: {epsC: 0.5}, expert_share: 0.1}
      wiring: [{kind: derivative}, {kind: one_to_one, parameters: {noise: {kind: colour_normal}}}]
      babbling: 10
      sensors:
        - {device: drive, value: twist.twist.linear.x, min: -0.5, max: 0.5}
        - {device: drive, value: twist.twist.angular.z, min: -2, max: 2}
      motors:
        - {device: drive, value: linear.x, min: -0.5, max: 0.5}
        - {device: drive, value: angular.z, min: -2, max: 2}
events:
  - {name: moved, when: abs(rover.pose.yaw) > 0.01}
)",
     .add = "copy of rover as late 3 3",
     .more = "set rover/controller.parameters.expert_share 0.2"},
};

class GoesOn : public testing::TestWithParam<Scenario> {
 protected:
  void SetUp() override {
    folder.write("brain.py", brain);
    std::string text = GetParam().text;
    for (std::size_t at = 0; (at = text.find('@', at)) != std::string::npos;)
      text.replace(at, 1, fs::absolute("models").string() + "/");
    scenario = folder.write("s.yaml", "version: 1\nname: goes_on\n" + text);
  }

  nlohmann::json run(const std::string& arguments) {
    const Printed printed = sandlot("run " + arguments + " --summary " + folder.file("summary.json"));
    EXPECT_EQ(printed.exit_code, 0) << arguments << "\n" << printed.out;
    return read_json(folder.file("summary.json"));
  }
  std::string hash(const std::string& arguments) { return run(arguments)["state_hash"].dump(); }
  std::size_t starts() const {
    const std::string text = fs::exists(folder.path / "starts") ? folder.read("starts") : "";
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
  static std::string line(const std::string& text) { return " --command '" + text + "'"; }
  /// Steering before the snapshot in the middle, and behind it.
  std::string early() const { return line(std::string("at 0.31s add ") + GetParam().add); }
  std::string late() const {
    return line("at 1.4s remove late") + line(std::string("at 1.6s ") + GetParam().more);
  }

  /// Runs with `before` and `after`, and again in all the ways in which a run is interrupted.
  void interrupt(const std::string& before, const std::string& after) {
    const std::string half = folder.file("half.snapshot"), recording = folder.file("r.mcap");
    const std::string whole = scenario + before + after;
    // At 1 s the answer of the program outside is under way.
    const auto first = run(whole + " --record " + recording + " --snapshot-at 1s --snapshot " + half);
    const std::string expected = first["state_hash"].dump();
    EXPECT_FALSE(first["events"].empty());
    for (const auto& event : first["events"])
      EXPECT_GT(event["count"], 0) << event << ": what is to be seen does not happen";
    EXPECT_EQ(hash(whole), expected) << "the run is not the same twice";
    const std::string allow = GetParam().allow_programs ? " --allow-programs" : "";
    for (const char* threads : {" --threads 1", " --threads 2", " --threads 4"}) {
      EXPECT_EQ(hash("--from " + half + allow + after + threads), expected)
          << "from the snapshot," << threads;
      const std::size_t started = starts();
      const Printed printed = sandlot("replay " + recording + " --verify --json" + threads);
      const auto replay = nlohmann::json::parse(printed.out, nullptr, false);
      EXPECT_EQ(replay["verified"], true) << threads << printed.out;
      EXPECT_EQ(replay["state_hash"].dump(), expected) << threads;
      EXPECT_EQ(starts(), started) << "a replay starts nothing";
    }
    const std::string replayed = folder.file("replayed.snapshot");
    EXPECT_EQ(sandlot("replay " + recording + " --snapshot-at 1s --snapshot " + replayed).exit_code, 0);
    const Printed same = sandlot("diff " + half + " " + replayed);
    EXPECT_EQ(same.exit_code, 0) << same.out;
    // Only with a page a run keeps what it can go back to.
    const std::string served = " --port 0 --rate max";
    EXPECT_EQ(hash(whole + line("at 1.8s reset") + served), expected) << "reset";
    EXPECT_EQ(hash(whole + line("at 1.8s jump 0.53s") + served + " --threads 2"), expected) << "rewound";
    EXPECT_EQ(hash(whole + line("at 1.8s jump 1.2s") + line("at 1.85s reset") + served), expected) << "both";
    EXPECT_EQ(hash("--from " + half + allow + after + line("at 1.8s reset") + served), expected)
        << "reset to the snapshot that it comes from";
  }

  const TestFolder folder;
  std::string scenario;
};
INSTANTIATE_TEST_SUITE_P(All, GoesOn, testing::ValuesIn(scenarios),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(GoesOn, InTheStateOfARunThatNothingInterrupts) { interrupt("", ""); }

class SlowGoesOn : public GoesOn {};
INSTANTIATE_TEST_SUITE_P(All, SlowGoesOn, testing::ValuesIn(scenarios),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(SlowGoesOn, AlsoWithEntitiesThatComeAndGo) {
  interrupt(early(), late());
  EXPECT_NE(hash(scenario), hash(scenario + early() + late())) << "the steering does nothing";
}

}  // namespace
}  // namespace sandlot::test
