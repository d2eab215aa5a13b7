#include "sim/session/experiment.h"

#include <algorithm>

#include "base/text.h"
#include "base/units.h"
#include "sim/watch/monitor.h"
#include "sim/world/program.h"

namespace sandlot {
namespace {

/// Words parted by blanks; quotes keep blanks together.
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
Status Experiment::call(const char* name, const std::function<Status(Experiment&, Arguments...)>& hook,
                        const std::type_identity_t<Arguments>&... arguments) {
  if (!hook) return {};
  Status status;
  const auto thrown = caught([&] { status = hook(*this, arguments...); });
  if (thrown) status = Error{"threw: " + *thrown};
  if (!status) status.error().what = std::string(name) + ": " + status.error().what;
  return status;
}

Status Experiment::start() {
  for (const ConsoleCommand& command : hooks_.commands)
    SL_CHECK_MSG(command.act != nullptr, "a console command without a function");
  return call("on_start", hooks_.on_start);
}

Status Experiment::finish() { return call("on_end", hooks_.on_end); }

Status Experiment::tick(std::optional<Time> measured) {
  SL_TRY(say_due_lines());
  SL_TRY(call("before_tick", hooks_.before_tick));
  SL_TRY(sim_.tick(measured));
  SL_TRY(report_contacts());
  SL_TRY(report_events());
  return call("after_tick", hooks_.after_tick);
}

Status Experiment::report_contacts() {
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
  // A pair of things may touch in many points and with several links: the deepest stands for all of them.
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

Status Experiment::report_events() {
  // Those that a hook emits while it hears of one come after the next tick, so that two hooks cannot play ping-pong.
  const std::span<const std::string> of_scenario = sim_.monitor().happened();
  std::vector<std::string> happened(of_scenario.begin(), of_scenario.end());
  for (std::string& name : std::exchange(emitted_, {})) happened.push_back(std::move(name));
  for (const std::string& name : happened) SL_TRY(call("on_event", hooks_.on_event, name));
  return {};
}

Result<const ConsoleCommand*> Experiment::find_command(const std::vector<std::string>& words) const {
  if (words.empty()) return Error{"the line says nothing"};
  std::vector<std::string> names;
  for (const ConsoleCommand& command : hooks_.commands) {
    if (words.front() == command.name) return &command;
    names.push_back(command.name);
  }
  return Error{"there is no command '" + words.front() + "'",
               names.empty() ? "this program has none" : suggestion(words.front(), names)};
}

Result<std::string> Experiment::execute(std::string_view line) {
  SL_ASSIGN(const std::vector<std::string> words, words_of(line));
  if (words.size() == 1 && words.front() == "help") {
    std::string out;
    for (const ConsoleCommand& command : hooks_.commands)
      out += (out.empty() ? "" : "\n") + command.name + "  " + command.help;
    return out;
  }
  SL_ASSIGN(const ConsoleCommand* const command, find_command(words));
  Result<std::string> answer = std::string();
  const auto thrown = caught([&] { answer = command->act(*this, std::span(words).subspan(1)); });
  if (thrown) return Error{"'" + words.front() + "' threw: " + *thrown};
  return answer;
}

Status Experiment::schedule(std::string_view text) {
  Line line{sim_.now(), std::string(text)};
  SL_ASSIGN(const std::vector<std::string> words, words_of(text));
  if (!words.empty() && words.front() == "at") {
    auto at_s = parse_quantity(words.size() > 1 ? words[1] : "", "s");
    if (!at_s || !(*at_s >= 0 && *at_s <= 9e9) || words.size() < 3)
      return Error{"'" + std::string(text) + "' is not of the form at TIME COMMAND",
                   "for example: at 2s kick ball"};
    line.at = Time::from_s(*at_s);
    const std::size_t time = text.find(words[1], text.find("at") + 2);
    line.text = std::string(text.substr(time + words[1].size()));
  }
  SL_ASSIGN(const std::vector<std::string> said, words_of(line.text));
  if (auto command = find_command(said); !command) return std::move(command.error());
  const auto later = std::upper_bound(lines_.begin(), lines_.end(), line.at,
                                      [](Time at, const Line& other) { return at < other.at; });
  lines_.insert(later, std::move(line));
  return {};
}

Status Experiment::say_due_lines() {
  while (!lines_.empty() && lines_.front().at <= sim_.now()) {
    const Line line = std::move(lines_.front());
    lines_.erase(lines_.begin());
    auto answer = execute(line.text);
    if (!answer) {
      answer.error().what = "at " + number_text(sim_.now().s()) + " s: " + answer.error().what;
      return std::move(answer.error());
    }
    answers_.push_back("at " + number_text(sim_.now().s()) + " s: " + *answer);
  }
  return {};
}

}  // namespace sandlot
