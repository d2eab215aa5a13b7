#pragma once
/// Playback: drives a robot by the velocities of a recording.
///
/// Reads    nothing. The velocities are in `samples`; where a scenario names a recording (`file`), they are put there
///          while the scenario is loaded, so that a snapshot no longer needs the recording.
/// Orders   a Twist for the drive `to` in every control step: vx, vy [m/s], wz [rad/s] in the robot's frame. With `publish` it
///          orders nothing and publishes the Twist on a topic of that name for another program, as a joystick does.
/// Time     sample times count from the beginning of the recording; the one of time t is given in the first control step
///          not before start + t / rate, and holds until the next. Before the first and after the last: zero.
///          With `loop` the recording begins again at the time of its last sample.
/// Limits   open loop: another robot, or other ground, drifts away from the recorded path. No interpolation.
/// Cost     a binary search per step.
/// Errors   both `to` and `publish`; no samples, rows that are not four numbers, times that run backwards.
#include <string>
#include <vector>

#include "control/controller.h"

namespace sandlot::controllers::playback {

/// One row of `samples`.
struct Sample {
  double time_s = 0;
  double vx_mps = 0, vy_mps = 0, wz_radps = 0;
};

/// As rows "time vx vy wz", each number exact.
std::string samples_text(const std::vector<Sample>& samples);
/// Reads such rows; blanks and commas separate numbers, a line ends a row.
Result<std::vector<Sample>> read_samples(std::string_view text);

struct Spec {
  std::string file, topic, commands, to, publish, samples;
  double start_s = 0;
  double rate = 1;
  bool loop = false;

  static void fields(auto& s, auto&& visit) {
    constexpr std::size_t most_letters = 1'000'000'000;
    visit(Field{"file", "", "Recording (.mcap), or table (.csv) with the columns time, vx, vy, wz."}, s.file);
    visit(
        Field{
            "topic", "",
            "Topic of the recording: a Twist, TwistStamped or Odometry. Not needed when there is only one."},
        s.topic);
    visit(Field{"commands", "",
                "Drive whose recorded commands are replayed, such as rover/drive; instead of a topic."},
          s.commands);
    visit(Field{"to", "", "Drive of this robot; not needed when it has only one."}, s.to);
    visit(
        Field{
            "publish", "",
            "Topic, such as cmd_vel, that shows the velocities to other programs; no drive is ordered then."},
        s.publish);
    visit(
        Field{"samples", "", "Rows of time, vx, vy, wz; instead of a file.", 0, 0, Field::none, most_letters},
        s.samples);
    visit(Field{"start", "s", "Simulated time at which the recording begins.", 0, 1e9}, s.start_s);
    visit(Field{"rate", "1", "Playback rate; 2: twice as fast, at the recorded velocities.", 1e-3, 1e3},
          s.rate);
    visit(Field{"loop", "", "Whether to begin again after the last sample.", 0, 1}, s.loop);
  }
};

struct Playback {
  using Spec = playback::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  Actuator<msg::Twist> drive;
  std::optional<Publication<msg::Twist>> shown;  ///< instead of the drive
  std::vector<Sample> samples;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
};

}  // namespace sandlot::controllers::playback
