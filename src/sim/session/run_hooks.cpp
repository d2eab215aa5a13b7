#include "sim/session/run_hooks.h"

#include <algorithm>

#include "base/text.h"
#include "control/program.h"
#include "sim/watch/monitor.h"

namespace sandlot {
namespace {

/// The words of a line, separated by blanks; quotes keep blanks together.
Result<std::vector<std::string>> words_of(std::string_view line) {
  std::vector<std::string> out;
  bool in_word = false, quoted = false;
  for (const char c : line) {
    if (c == '"') {
      if (!in_word) out.emplace_back();
      in_word = true;
      quoted = !quoted;
    } else if (!quoted && (c == ' ' || c == '\t')) {
      in_word = false;
    } else {
      if (!in_word) out.emplace_back();
      in_word = true;
      out.back() += c;
    }
  }
  if (quoted) return Error{"a quote is not closed in '" + std::string(line) + "'"};
  return out;
}

}  // namespace

template <class... Arguments>
Status RunHooks::call(const char* name, const std::function<Status(RunHooks&, Arguments...)>& hook,
                      const std::type_identity_t<Arguments>&... arguments) {
  if (!hook) return {};
  Status status;
  const auto thrown = caught([&] { status = hook(*this, arguments...); });
  if (thrown) status = Error{"threw: " + *thrown};
  if (!status) status.error().what = std::string(name) + ": " + status.error().what;
  return status;
}

Status RunHooks::start() {
  for (const HookCommand& command : hooks_.commands)
    SL_CHECK_MSG(command.act != nullptr, "a console command without a function");
  return call("on_start", hooks_.on_start);
}

Status RunHooks::finish() { return call("on_end", hooks_.on_end); }

Status RunHooks::tick(std::optional<Time> measured) {
  SL_TRY(call("before_tick", hooks_.before_tick));
  SL_TRY(sim_.tick(measured));
  SL_TRY(report_contacts());
  SL_TRY(report_events());
  return call("after_tick", hooks_.after_tick);
}

Status RunHooks::report_contacts() {
  if (!hooks_.on_contact) return {};
  const auto entities = sim_.entities();
  const Engine& engine = sim_.engine();
  if (owner_revision_ != sim_.revision()) {
    owner_.assign(engine.states().size(), 0);
    for (std::size_t i = 0; i < entities.size(); ++i)
      for (const BodyId body : engine.bodies(entities[i]->id))
        owner_[body.index] = static_cast<std::uint32_t>(i);
    owner_revision_ = sim_.revision();
  }
  // A pair may touch in many points and with several links: the deepest contact stands for all of them.
  std::map<std::pair<std::uint32_t, std::uint32_t>, Contact> deepest;
  for (Contact contact : engine.contacts()) {
    std::uint32_t a = owner_[contact.a.index], b = owner_[contact.b.index];
    if (a == b) continue;
    if (a > b) {
      std::swap(a, b);
      contact.normal_W = -contact.normal_W;
    }
    const auto [known, fresh] = deepest.emplace(std::pair(a, b), contact);
    if (!fresh && contact.depth_m > known->second.depth_m) known->second = contact;
  }
  std::set<std::pair<std::uint64_t, std::uint64_t>> touching;
  for (const auto& [pair, contact] : deepest)
    touching.emplace(entities[pair.first]->serial, entities[pair.second]->serial);
  for (const auto& [pair, contact] : deepest) {
    const auto &a = *entities[pair.first], &b = *entities[pair.second];
    const Touch touch{a.instance.name,  b.instance.name, contact.point_W,
                      contact.normal_W, contact.depth_m, !touching_.contains({a.serial, b.serial})};
    SL_TRY(call("on_contact", hooks_.on_contact, touch));
  }
  touching_ = std::move(touching);
  return {};
}

Status RunHooks::report_events() {
  // Events that a hook emits here are reported after the next tick, so that two hooks cannot call each other without end.
  const std::span<const std::string> of_scenario = sim_.monitor().happened();
  std::vector<std::string> happened(of_scenario.begin(), of_scenario.end());
  for (std::string& name : std::exchange(emitted_, {})) happened.push_back(std::move(name));
  for (const std::string& name : happened) SL_TRY(call("on_event", hooks_.on_event, name));
  return {};
}

Result<const HookCommand*> RunHooks::find_command(const std::vector<std::string>& words) const {
  if (words.empty()) return Error{"the line says nothing"};
  std::vector<std::string> names;
  for (const HookCommand& command : hooks_.commands) {
    if (words.front() == command.name) return &command;
    names.push_back(command.name);
  }
  return Error{"there is no command '" + words.front() + "'",
               names.empty() ? "this program has none" : suggestion(words.front(), names)};
}

Result<std::string> RunHooks::execute(std::string_view line) {
  SL_ASSIGN(const std::vector<std::string> words, words_of(line));
  if (words.size() == 1 && words.front() == "help") {
    std::string out;
    for (const HookCommand& command : hooks_.commands)
      out += (out.empty() ? "" : "\n") + command.name + "  " + command.help;
    return out;
  }
  SL_ASSIGN(const HookCommand* const command, find_command(words));
  Result<std::string> answer = std::string();
  const auto thrown = caught([&] { answer = command->act(*this, std::span(words).subspan(1)); });
  if (thrown) return Error{"'" + words.front() + "' threw: " + *thrown};
  return answer;
}

}  // namespace sandlot
