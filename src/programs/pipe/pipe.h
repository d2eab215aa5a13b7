#pragma once
/// Pipe: a program in a process of its own, which gets lines of JSON on its standard input and answers on its standard
/// output: a controller in any language.
///
/// Observation  a line per control step: {"time": 1.2, "step": 12, "readings": {"laser": {...}}}: the messages that have come
///              since the line before, by device. A first line describes the robot: {"robot": "rover", "period": 0.1,
///              "readings": [{"name": "laser", "type": "sensor_msgs/msg/LaserScan"}, ...], "actuators": [...]}; it comes again
///              when devices come or go, and expects no answer.
/// Answer       one line per observation, see programs/answer.h; its orders act at the beginning of the next tick, as those of every
///              controller. What it writes to standard error goes to the log.
/// Deadline     in wall time from the observation on. An answer that comes later acts with the next one. Until an answer
///              has come no other observation is sent; `on_miss` is what the robot does meanwhile.
/// Determinism  the answers are input from outside and logged, also that none came in time: replays and rewound runs get
///              them from there, without the process.
/// Security     a process is started only by a run that may: see SECURITY.md.
/// State        numbers of answers and misses, and whether the process has ended.
/// Limits       a line has at most 1 MB, at most 64 lines of standard error are logged per step.
/// Cost         the messages as JSON, and the wait for the answer.
#include "programs/answer.h"
#include "programs/child.h"
#include "programs/output_file.h"
#include "programs/outside_program.h"

namespace sandlot::programs::pipe {

struct Spec {
  std::vector<std::string> command;
  std::string folder;
  double deadline_s = 1;
  OnMiss on_miss = OnMiss::hold;
  AfterRestore after_restore = AfterRestore::restart;
  std::vector<std::string> readings;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"command", "", "Program and its arguments; a program without / is looked for in PATH.", 0, 0,
                Field::required, 1000},
          s.command);
    visit(Field{"folder", "", "Working directory of the process; by default that of the scenario's file.", 0,
                0, Field::none, 4096},
          s.folder);
    visit(Field{"deadline", "s", "Wall time within which an answer is expected.", 1e-3, 60, Field::tunable},
          s.deadline_s);
    visit(
        Field{
            "on_miss", "",
            "Reaction to an answer that does not come in time, or to the end of the process. hold: the last "
            "orders stay; stop: drives are ordered to stand still; end: the run ends.",
            0, 0, Field::tunable},
        s.on_miss);
    visit(Field{"after_restore", "",
                "Reaction to a restored or rewound run. restart: the process is started again; detach: no "
                "orders."},
          s.after_restore);
    visit(Field{"readings", "", "Readings to send, by name; empty: all.", 0, 0, Field::none, 1000},
          s.readings);
  }
};

struct State {
  std::uint64_t answers = 0, misses = 0;
  std::uint8_t gone = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"answers", "1", "Number of answers."}, s.answers);
    visit(Field{"misses", "1", "Number of answers that did not come in time."}, s.misses);
    visit(Field{"gone", "1", "Whether the process has ended (1)."}, s.gone);
  }
};

class Pipe final : public OutsideProgram<Spec, State> {
 public:
  Status init(const Description& robot, const Node& config, Outputs& out) override;
  Resumed resume(const Observation& obs, Command& cmd) override;
  Resumed answer(const OutsideAnswer& answer, std::span<const TopicBase* const> forms, Command& cmd) override;

  Status connect() override;
  bool connected() const override { return child_.has_value(); }
  bool connects_again() const override { return spec_.after_restore == AfterRestore::restart; }
  bool expects_answer() const override { return child_ && (waiting_ || !late_.empty() || !broken_.empty()); }
  Clock::time_point deadline() const override { return deadline_; }
  void watched(std::vector<Watched>& out) const override;
  Result<bool> keep_output(const std::string& folder) override;
  void adopt(Outside& before) override;
  std::optional<OutsideAnswer> receive() override;

 private:
  std::string description() const;
  std::string observation(const Observation& obs);
  Resumed react(const std::string& why, Command& cmd);
  void log_notes();

  std::string path_;  ///< "rover/brain"
  Description robot_;
  std::vector<Named> readings_, actuators_;
  std::vector<Named> sent_readings_;  ///< those of observations

  // The process; none of it is State.
  std::optional<Child> child_;
  OutputFile output_;
  bool described_ = false, waiting_ = false;
  Clock::time_point deadline_;
  std::uint64_t step_ = 0;
  std::vector<std::uint64_t> sent_;  ///< per entry of sent_readings_: count of the message sent last
  std::vector<std::string> late_;    ///< answers that came after their deadline
  std::string broken_, last_note_;
  std::vector<std::byte> cdr_;
};

}  // namespace sandlot::programs::pipe
