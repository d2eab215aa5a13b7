#pragma once
/// Remote: a robot or team whose program is a client of the server: in lockstep, or free-running.
///
///   controller: remote
///   controller: {kind: remote, deadline: 50 ms, on_miss: stop}
///   controller: {kind: remote, command: [python3, team.py], cpu: 50 %, memory: 512 MB, restart: on_failure}
///
/// Lockstep     in each control step the client is told of the step, when the messages of the tick are on their way to it, and
///              its answer (programs/answer.h) acts at the beginning of the next tick, as the orders of every controller do.
/// Deadline     in wall time from when the client is sent the step: its own, at most `deadline`, whoever else is waited for. An
///              answer that comes later acts with the next step, which counts as missed as well: the client is sent no other step
///              until it has answered; `on_miss` is what the robot does meanwhile.
/// No client    the first step waits up to `patience` for one to come; after that none waits until one has. Steps without a
///              client count as missed.
/// Free running clients that give no word of lockstep send commands, which act in the tick after they came. With
///              `lockstep: false` the program waits for nothing.
/// Command      of a process that a server starts and that is the client (server/processes.h); no part of what this class does.
/// Refused      answers that cannot be carried out order nothing and are counted; the run goes on.
/// Determinism  answers are input from outside and logged, also that none came in time: replays and rewound runs get them
///              from there, without a client.
/// State        numbers of answers, misses and refusals.
/// Cost         the wait for the answer.
#include "programs/answer.h"
#include "programs/budget.h"
#include "programs/outside_program.h"
#include "programs/remote/link.h"

namespace sandlot::programs::remote {

enum class Restart : std::uint8_t { never, on_failure, on_exit };
inline std::span<const EnumName<Restart>> enum_names(Restart) {
  static constexpr EnumName<Restart> names[] = {
      {"never", Restart::never}, {"on_failure", Restart::on_failure}, {"on_exit", Restart::on_exit}};
  return names;
}

struct Spec {
  double deadline_s = 1, patience_s = 60;
  OnMiss on_miss = OnMiss::stop;
  bool lockstep = true;
  std::vector<std::string> command;
  std::string folder;
  Budget budget;
  Restart restart = Restart::on_failure;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"deadline", "s", "Longest wall time within which an answer is expected.", 1e-3, 60,
                Field::tunable},
          s.deadline_s);
    visit(Field{"patience", "s", "Wall time for which the first step waits for a client.", 0, 1e5,
                Field::tunable},
          s.patience_s);
    visit(Field{"on_miss", "",
                "Reaction to an answer that does not come in time. hold: the last orders stay; stop: drives "
                "are ordered to stand still; end: the run ends.",
                0, 0, Field::tunable},
          s.on_miss);
    visit(Field{"lockstep", "",
                "Whether the run waits for the client at each control step; else its commands act when they "
                "come."},
          s.lockstep);
    visit(
        Field{
            "command", "",
            "Program that the run starts as the client, and its arguments; empty: a client comes by itself.",
            0, 0, Field::none, 1000},
        s.command);
    visit(
        Field{"folder", "",
              "Folder of the program, all it sees of the machine's files; by default that of the scenario's "
              "file.",
              0, 0, Field::none, 4096},
        s.folder);
    Budget::fields(s.budget, visit);
    visit(Field{"restart", "",
                "Reaction to the end of the program. never: none; on_failure: it is started again unless it "
                "ended with code 0; on_exit: it is started again."},
          s.restart);
  }
};

struct State {
  std::uint64_t answers = 0, misses = 0, refused = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"answers", "1", "Number of answers, late ones too."}, s.answers);
    visit(Field{"misses", "1", "Number of steps without an answer in time."}, s.misses);
    visit(Field{"refused", "1", "Number of answers that could not be carried out."}, s.refused);
  }
};

class Remote final : public OutsideProgram<Spec, State> {
 public:
  Status init(const Description& robot, const Node& config, Outputs& out) override;
  Resumed resume(const Observation& obs, Command& cmd) override;
  Resumed answer(const OutsideAnswer& answer, std::span<const TopicBase* const> forms, Command& cmd) override;

  Status connect() override;
  bool connected() const override { return connected_; }
  bool connects_again() const override { return true; }
  bool is_client() const override { return true; }
  bool has_command() const override { return !spec_.command.empty(); }
  bool expects_answer() const override { return connected_ && waiting_; }
  Clock::time_point deadline() const override { return deadline_; }
  void watched(std::vector<Watched>&) const override {}
  void adopt(Outside& before) override;
  std::optional<OutsideAnswer> receive() override;

  /// For the server. It lives as long as somebody holds it.
  const std::shared_ptr<Link>& link() const { return link_; }
  const Spec& spec() const { return spec_; }

 private:
  void set_deadline();

  std::vector<Named> readings_, actuators_;

  // The connection; none of it is State.
  std::shared_ptr<Link> link_ = std::make_shared<Link>();
  bool connected_ = false, waiting_ = false, gave_up_ = false;
  bool behind_ = false;    ///< the answer that is awaited is that of an earlier step
  bool extended_ = false;  ///< the step's time has begun once more, when its client was sent it
  std::uint64_t known_attachments_ = 0;
  std::uint64_t step_ = 0;
  Clock::time_point begun_, deadline_;
};

}  // namespace sandlot::programs::remote
