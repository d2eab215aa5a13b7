#include "programs/remote/remote.h"

#include <algorithm>
#include <utility>

namespace sandlot::programs::remote {
Status Remote::init(const Description& robot, const Node& config, Outputs&) {
  SL_ASSIGN(spec_, read_spec<Spec>(config));
  readings_ = names_of(robot.readings);
  actuators_ = names_of(robot.actuators);
  if (!spec_.command.empty() && spec_.command.front().empty())
    return Error{"the command is empty",
                 "name a program and its arguments: command: [python3, team.py]",
                 {},
                 "/command"};
  return {};
}

Status Remote::connect() {
  connected_ = true;
  waiting_ = gave_up_ = behind_ = false;
  return {};
}

void Remote::adopt(Outside& before) {
  Remote& old = static_cast<Remote&>(before);
  link_ = old.link_;
  connected_ = std::exchange(old.connected_, false);
  waiting_ = old.waiting_;
  gave_up_ = old.gave_up_;
  known_attachments_ = old.known_attachments_;
  behind_ = old.behind_;
  extended_ = old.extended_;
  step_ = old.step_;
  begun_ = old.begun_;
  deadline_ = old.deadline_;
}

/// From the step on; of the first one, until a client has come. A client's time begins when it is sent the step: what others do
/// before that is not its own time.
void Remote::set_deadline() {
  const auto wall = [](double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  };
  const std::optional<double> client_s = link_->deadline_s();
  if (const std::uint64_t came = link_->attachments(); came != known_attachments_) {
    known_attachments_ = came;
    gave_up_ = behind_ = false;
  }
  // Once, or who claims again and again would hold up the run.
  if (const auto told = link_->told_at(); client_s && told && *told > begun_)
    if (!std::exchange(extended_, true)) begun_ = *told;
  if (client_s) deadline_ = begun_ + wall(std::min(*client_s, spec_.deadline_s));
  else if (gave_up_ || known_attachments_ > 0 || link_->given_up()) deadline_ = begun_;
  else deadline_ = begun_ + wall(spec_.patience_s);
}

Program::Resumed Remote::resume(const Observation& obs, Command&) {
  if (!spec_.lockstep) return {.waiting_for = Waiting::nothing};
  if (connected_) {
    begun_ = Clock::now();
    link_->count_step();
    extended_ = false;
    Stream random = obs.random();
    behind_ = std::exchange(waiting_, true);
    if (!behind_) link_->put({step_++, obs.now(), random.bits64()});
    set_deadline();
  }
  return {.waiting_for = Waiting::outside};
}

std::optional<OutsideAnswer> Remote::receive() {
  if (!connected_) return std::nullopt;
  const Clock::time_point before = deadline_;  // it may have answered and gone since
  set_deadline();
  auto answer = link_->take(std::max(before, deadline_));
  if (!answer) return std::nullopt;
  waiting_ = false;
  if (!*answer) return OutsideAnswer{OutsideAnswer::Kind::message, {}};  // it went away: nothing is ordered
  link_->count_answer();
  return OutsideAnswer::of(behind_ ? OutsideAnswer::Kind::late : OutsideAnswer::Kind::message, **answer);
}

Program::Resumed Remote::answer(const OutsideAnswer& answer, std::span<const TopicBase* const> forms,
                                Command& cmd) {
  const auto miss = [&](const char* why) -> Resumed {
    ++state_.misses;
    if (connected_) link_->count_miss();
    gave_up_ = true;
    if (spec_.on_miss == OnMiss::end) return {.failure = why};
    if (spec_.on_miss == OnMiss::stop) stop_drives(actuators_, cmd);
    return {};
  };
  switch (answer.kind) {
    case OutsideAnswer::Kind::late:
      ++state_.misses;
      if (connected_) link_->count_miss();
      [[fallthrough]];
    case OutsideAnswer::Kind::message: {
      if (answer.bytes.empty()) return miss("the client has gone");
      ++state_.answers;
      auto read = read_answer(answer.text(), readings_, actuators_, forms, cmd);
      if (read) return std::move(*read);
      ++state_.refused;
      link_->refuse(read.error().text());
      return {};
    }
    case OutsideAnswer::Kind::missed: return miss("the client sent no answer in time");
    case OutsideAnswer::Kind::gone: break;
  }
  return {.waiting_for = Waiting::nothing};
}

extern const ProgramKind kind;
constinit const ProgramKind kind{
    .name = "remote",
    .help = "A client of the server drives the robot or the team, in lockstep with the run.",
    .describe = [] { return describe_fields<Spec>(); },
    .create = []() -> std::unique_ptr<Program> { return std::make_unique<Remote>(); },
};

}  // namespace sandlot::programs::remote
