/// Programs that run outside this process: the one place that connects them and waits for them.
#include <poll.h>

#include <algorithm>
#include <chrono>

#include "base/log.h"
#include "programs/surroundings.h"
#include "sim/world/programs.h"

namespace sandlot {

Status Programs::connect(Entities entities, Time now, bool allowed, bool restored) {
  if (std::exchange(connected_, true)) return {};
  gather(entities);
  const auto warn = [](const ProgramEntry& entry, const std::string& why) {
    log::warning("program '" + entry.path + "' (" + entry.decl.kind + ") gives no orders: " + why);
  };
  for (ProgramEntry* const entry : outside_) {
    Outside& outside = *entry->program->outside();
    if (entry->ended || outside.connected()) continue;
    if (!allowed && !outside.is_client()) {
      warn(*entry, "this run may not start programs; run the scenario itself, or add --allow-programs");
      continue;
    }
    if (restored && !outside.connects_again()) {
      warn(*entry, "the run was restored, and it stays detached then");
      continue;
    }
    Status status = outside.connect();
    if (status && restored) ask_again(*entry, now);
    if (status) continue;
    if (!status.error().place.file) status.error().place = entry->decl.place;
    if (!restored) return status;
    warn(*entry, status.error().text());
  }
  return {};
}

/// Sends what the program observes once more if the run was left between that and the answer, which is no State: with it the
/// run goes on as the one that was not left.
void Programs::ask_again(ProgramEntry& entry, Time now) {
  if (entry.ended) return;
  if (entry.wait->waiting_for == Program::Waiting::outside) {
    const Stream random(setup_.seed, entry.key, Purpose::controller, entry.steps - 1);
    entry.program->resume({now, entry.topics, entry.seen, random}, entry.command);
  } else if (!entry.program->outside()->expects_answer()) {
    return;
  }
  auto& awaited = entry.program->outside()->is_client() ? awaited_clients_ : awaited_;
  // A step that was due before it was connected is awaited already: it would be missed twice.
  if (std::find(awaited.begin(), awaited.end(), &entry) == awaited.end()) awaited.push_back(&entry);
}

void Programs::submit_answer(const ProgramEntry& entry, OutsideAnswer answer) {
  if (answer.kind == OutsideAnswer::Kind::gone)
    log::warning("program '" + entry.path + "' (" + entry.decl.kind +
                 ") is gone: " + std::string(answer.text()));
  commands_.submit(AnswerRequest{entry.path, std::move(answer)}, {});
}

/// Takes what has come. @return whether nothing more is awaited
bool Programs::take_answers(ProgramEntry& entry) {
  Outside& outside = *entry.program->outside();
  while (outside.expects_answer()) {
    auto answer = outside.receive();
    if (!answer) return false;
    submit_answer(entry, std::move(*answer));
    auto* const surrounded = dynamic_cast<programs::Surrounded*>(entry.program.get());
    if (!surrounded) continue;
    for (const programs::Move& move : surrounded->take_moves())
      commands_.submit(PoseRequest{move.name, move.X_WM}, {});
    const std::string robot = entry.path.substr(0, entry.path.find('/') + 1);
    for (const programs::Setting& each : surrounded->take_settings())
      commands_.submit(
          ParameterRequest{robot + each.device, each.field, Node::scalar(number_text(each.value))}, {});
  }
  return true;
}

/// Takes what has come, or that nothing came until its own deadline, however long others are waited for after that.
/// @return whether nothing more is awaited
bool Programs::take_or_miss(ProgramEntry& entry) {
  if (take_answers(entry)) return true;
  if (Outside::Clock::now() < entry.program->outside()->deadline()) return false;
  submit_answer(entry, {OutsideAnswer::Kind::missed, {}});
  return true;
}

std::optional<Outside::Clock::time_point> Programs::await_clients() {
  std::erase_if(awaited_clients_, [&](ProgramEntry* entry) { return take_or_miss(*entry); });
  std::optional<Outside::Clock::time_point> next;
  for (ProgramEntry* const entry : awaited_clients_) {
    const auto deadline = entry->program->outside()->deadline();
    next = next ? std::min(*next, deadline) : deadline;
  }
  return next;
}

void Programs::end_waiting_for_clients() {
  for (ProgramEntry* const entry : awaited_clients_)
    if (!take_answers(*entry)) submit_answer(*entry, {OutsideAnswer::Kind::missed, {}});
  awaited_clients_.clear();
}

void Programs::await_answers() {
  if (awaited_.empty()) return;
  using Clock = Outside::Clock;
  std::vector<Outside::Watched> watched;
  std::vector<pollfd> polled;
  while (true) {
    // In the order of the programs, so that what is there in time has one order.
    std::erase_if(awaited_, [&](ProgramEntry* entry) { return take_or_miss(*entry); });
    if (awaited_.empty()) return;
    Clock::time_point deadline = Clock::time_point::max();
    for (ProgramEntry* const entry : awaited_)
      deadline = std::min(deadline, entry->program->outside()->deadline());
    // The first of those that no descriptor tells of; the others run meanwhile.
    const bool waited = std::any_of(awaited_.begin(), awaited_.end(), [&](ProgramEntry* entry) {
      auto* const surrounded = dynamic_cast<programs::Surrounded*>(entry->program.get());
      return surrounded && surrounded->await(deadline);
    });
    if (waited) continue;
    watched.clear();
    for (ProgramEntry* const entry : awaited_) entry->program->outside()->watched(watched);
    polled.clear();
    for (const Outside::Watched& each : watched)
      polled.push_back({each.descriptor, static_cast<short>(each.writing ? POLLOUT : POLLIN), 0});
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    poll(polled.data(), polled.size(), static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
  }
}

std::optional<Error> Programs::answer(ProgramEntry& entry, const OutsideAnswer& answer, Time now) {
  std::vector<const TopicBase*> forms(entry.routes.size(), nullptr);
  for (const Description::Entry& actuator : entry.description->actuators)
    if (const Device* const device = entry.routes[actuator.index].device.get())
      for (const SimulationParts::Slot& slot : device->commands)
        if (actuator.type == slot.topic->type()) forms[actuator.index] = slot.topic.get();
  Program::Resumed resumed;
  const auto thrown = caught([&] { resumed = entry.program->answer(answer, forms, entry.command); });
  if (thrown) resumed.failure = thrown;
  take(entry, std::move(resumed));
  if (entry.inactive) entry.command.clear();  // it was asked before it was stopped
  changed_ = changed_ || entry.ended;
  if (!entry.failure) return std::nullopt;
  return failure_of(entry, now);
}

}  // namespace sandlot
