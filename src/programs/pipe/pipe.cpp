#include "programs/pipe/pipe.h"

#include <algorithm>
#include <utility>

#include "base/json_writer.h"
#include "base/log.h"
#include "base/text.h"
#include "messages/command.h"
#include "messages/json.h"

namespace sandlot::programs::pipe {
Status Pipe::init(const Description& robot, const Node& config, Outputs& out) {
  SL_ASSIGN(spec_, read_spec<Spec>(config));
  path_ = out.path();
  robot_ = robot;
  readings_ = names_of(robot.readings);
  actuators_ = names_of(robot.actuators);
  if (spec_.command.empty() || spec_.command.front().empty())
    return Error{"the command is empty",
                 "name a program and its arguments: command: [python3, brain.py]",
                 {},
                 "/command"};
  if (spec_.readings.empty()) {
    for (const Named& each : readings_)
      if (each.any_level) sent_readings_.push_back(each);
  }
  std::vector<std::string> known;
  for (const Named& each : readings_) known.push_back(each.name);
  for (const std::string& wanted : spec_.readings) {
    const auto found = std::find_if(readings_.begin(), readings_.end(),
                                    [&](const Named& each) { return each.name == wanted; });
    if (found == readings_.end())
      return Error{"robot '" + robot.robot + "' has no reading '" + wanted + "'",
                   suggestion(wanted, known),
                   {},
                   "/readings"};
    sent_readings_.push_back(*found);
  }
  sent_.assign(sent_readings_.size(), 0);
  return {};
}

// ------------------------------------------------------------------------------------- what the simulation sees

Program::Resumed Pipe::resume(const Observation& obs, Command&) {
  if (child_ && broken_.empty()) {
    child_->move();
    while (auto line = child_->take_line()) {
      if (std::exchange(waiting_, false)) late_.push_back(std::move(*line));
      else broken_ = "it sent a line that answers no observation";
    }
    if (!waiting_) {
      if (!std::exchange(described_, true)) child_->write_line(description());
      child_->write_line(observation(obs));
      waiting_ = true;
    }
    const auto deadline = std::chrono::duration<double>(spec_.deadline_s);
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(deadline);
  }
  return {.waiting_for = Waiting::outside};
}

Program::Resumed Pipe::answer(const OutsideAnswer& answer, std::span<const TopicBase* const> forms,
                              Command& cmd) {
  switch (answer.kind) {
    case OutsideAnswer::Kind::late:
    case OutsideAnswer::Kind::message: {
      ++state_.answers;
      auto read = read_answer(answer.text(), readings_, actuators_, forms, cmd);
      if (!read) return {.failure = read.error().text()};
      return std::move(*read);
    }
    case OutsideAnswer::Kind::missed:
      ++state_.misses;
      return react("sent no answer within " + number_text(spec_.deadline_s) + " s", cmd);
    case OutsideAnswer::Kind::gone: break;
  }
  state_.gone = 1;
  Resumed out = react("is gone: " + std::string(answer.text()), cmd);
  out.waiting_for = Waiting::nothing;
  return out;
}

Program::Resumed Pipe::react(const std::string& why, Command& cmd) {
  if (spec_.on_miss == OnMiss::end) return {.failure = "the process " + why};
  if (spec_.on_miss == OnMiss::stop) stop_drives(actuators_, cmd);
  return {};
}

// --------------------------------------------------------------------------------------------------- the process

Status Pipe::connect() {
  SL_ASSIGN(child_, Child::start(spec_.command, spec_.folder));
  described_ = waiting_ = false;
  late_.clear();
  broken_.clear();
  std::fill(sent_.begin(), sent_.end(), 0);
  return {};
}

void Pipe::adopt(Outside& before) {
  Pipe& old = static_cast<Pipe&>(before);
  child_ = std::exchange(old.child_, std::nullopt);
  waiting_ = old.waiting_;
  deadline_ = old.deadline_;
  step_ = old.step_;
  late_ = std::move(old.late_);
  broken_ = std::move(old.broken_);
  described_ = false;
  output_ = std::move(old.output_);
}

void Pipe::watched(std::vector<Watched>& out) const {
  if (!child_) return;
  if (child_->output() >= 0) out.push_back({child_->output(), false});
  if (child_->error() >= 0) out.push_back({child_->error(), false});
  if (child_->writing()) out.push_back({child_->input(), true});
}

std::optional<OutsideAnswer> Pipe::receive() {
  if (!child_) return std::nullopt;
  child_->move();
  log_notes();
  if (!late_.empty()) {
    OutsideAnswer late = OutsideAnswer::of(OutsideAnswer::Kind::message, late_.front());
    late_.erase(late_.begin());
    return late;
  }
  if (broken_.empty() && waiting_)
    if (auto line = child_->take_line()) {
      waiting_ = false;
      return OutsideAnswer::of(OutsideAnswer::Kind::message, *line);
    }
  if (broken_.empty()) broken_ = child_->gone();
  if (broken_.empty()) return std::nullopt;
  if (!last_note_.empty()) broken_ += "; last line of its standard error: " + last_note_;
  child_.reset();
  waiting_ = false;
  return OutsideAnswer::of(OutsideAnswer::Kind::gone, std::exchange(broken_, {}));
}

Result<bool> Pipe::keep_output(const std::string& folder) {
  if (!child_) return false;
  SL_TRY(output_.open(folder, path_));
  return true;
}

void Pipe::log_notes() {
  while (auto note = child_->take_note()) {
    output_.write(*note);
    log::warning(path_ + ": " + *note);
    if (!note->empty()) last_note_ = std::move(*note);
  }
}

std::string Pipe::description() const {
  std::string out;
  JsonWriter w(out);
  const auto list = [&](const char* key, std::span<const Named> all) {
    w.key(key).list([&] {
      for (const Named& each : all)
        w.object([&] {
          w.key("name").text(each.name);
          w.key("type").text(each.type);
        });
    });
  };
  w.object([&] {
    w.key("robot").text(robot_.robot);
    w.key("period").number(robot_.control_period_s);
    list("readings", sent_readings_);
    list("actuators", actuators_);
  });
  return out;
}

std::string Pipe::observation(const Observation& obs) {
  std::string out, message;
  JsonWriter w(out);
  w.object([&] {
    w.key("time").number(obs.now().s());
    w.key("step").integer(step_++);
    w.key("readings").object([&] {
      for (std::size_t i = 0; i < sent_readings_.size(); ++i) {
        const TopicBase& topic = obs.topic(sent_readings_[i].index);
        if (topic.count == 0 || topic.count == sent_[i]) continue;
        sent_[i] = topic.count;
        topic.to_cdr(cdr_);
        const Status written = cdr_to_json(topic.info(), cdr_, message);
        SL_CHECK_MSG(written, "a message that its own type cannot read");
        w.key(sent_readings_[i].name).raw(message);
      }
    });
  });
  return out;
}

extern const ProgramKind kind;
constinit const ProgramKind kind{
    .name = "pipe",
    .help = "A program in a process of its own, by lines of JSON on its standard input and output.",
    .describe = [] { return describe_fields<Spec>(); },
    .create = []() -> std::unique_ptr<Program> { return std::make_unique<Pipe>(); },
};

}  // namespace sandlot::programs::pipe
