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
  const bool outer = std::exchange(inside_, true);
  const auto thrown = caught([&] { status = hook(*this, arguments...); });
  inside_ = outer;
  if (thrown) status = Error{"threw: " + *thrown};
  if (!status) status.error().what = std::string(name) + ": " + status.error().what;
  return status;
}

Status RunHooks::start() {
  for (const HookCommand& command : hooks_.commands)
    SL_CHECK_MSG(command.act != nullptr, "a console command without a function");
  SL_CHECK_MSG((hooks_.save == nullptr) == (hooks_.load == nullptr), "save and load, both or neither");
  ByteWriter w;
  if (hooks_.save) hooks_.save(w);
  first_.assign(w.bytes().begin(), w.bytes().end());
  return call("on_start", hooks_.on_start);
}

Status RunHooks::finish() { return call("on_end", hooks_.on_end); }

Status RunHooks::tick(std::optional<Time> measured, bool repeats) {
  if (repeats) repeat_lines();
  else forget_future_lines();
  SL_TRY(call("before_tick", hooks_.before_tick));
  if (repeats) sim_->drop_unlogged();
  SL_TRY(sim_->tick(measured));
  SL_TRY(report_contacts());
  SL_TRY(report_events());
  return call("after_tick", hooks_.after_tick);
}

std::string Hooks::may_not_rewind() const {
  if (stateless || (save && load)) return "";
  return "its experiment in C++ keeps a state of its own, without Hooks::save and load";
}

Status RunHooks::bind(std::string key, std::string line, std::string help) {
  if (key.empty() || line.empty())
    return Error{"a key binding without key or line", "bind(\"k\", \"kick ball\", \"Kicks\")"};
  for (KeyBinding& each : bindings_) {
    if (each.key != key) continue;
    if (each.line == line) return {};  // on_start again, after a reset
    return Error{"the key '" + key + "' is bound to '" + each.line + "' already", "choose another key"};
  }
  bindings_.push_back({std::move(key), std::move(line), std::move(help)});
  return {};
}

void RunHooks::replace(Simulation& sim) {
  sim_ = &sim;
  owner_revision_ = ~std::uint64_t{0};
}

std::vector<std::byte> RunHooks::save() const {
  ByteWriter w;
  write(w, emitted_);
  write(w, static_cast<std::uint64_t>(touching_.size()));
  for (const auto& [a, b] : touching_) write(w, a), write(w, b);
  if (hooks_.save) hooks_.save(w);
  return {w.bytes().begin(), w.bytes().end()};
}

Status RunHooks::load(std::span<const std::byte> saved) {
  emitted_.clear();
  touching_.clear();
  const std::uint64_t tick = sim_->tick_index();
  next_line_ = static_cast<std::size_t>(
      std::find_if(lines_.begin(), lines_.end(), [&](const Line& each) { return each.tick >= tick; }) -
      lines_.begin());
  if (saved.empty()) {
    ByteReader r(first_);
    if (hooks_.load) hooks_.load(r);
    return call("on_start", hooks_.on_start);
  }
  ByteReader r(saved);
  std::uint64_t count = 0;
  read(r, emitted_);
  read(r, count);
  for (std::uint64_t i = 0; i < count && r.ok(); ++i) {
    std::pair<std::uint64_t, std::uint64_t> pair;
    read(r, pair.first), read(r, pair.second);
    touching_.insert(pair);
  }
  if (hooks_.load) hooks_.load(r);
  if (!r.ok() || r.remaining() != 0)
    return Error{"the experiment's load() reads something else than its save() wrote", "compare the two"};
  return {};
}

Status RunHooks::report_contacts() {
  if (!hooks_.on_contact) return {};
  const auto entities = sim_->entities();
  const Engine& engine = sim_->engine();
  if (owner_revision_ != sim_->revision()) {
    owner_.assign(engine.states().size(), 0);
    for (std::size_t i = 0; i < entities.size(); ++i)
      for (const BodyId body : engine.bodies(entities[i]->id))
        owner_[body.index] = static_cast<std::uint32_t>(i);
    owner_revision_ = sim_->revision();
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
  const std::span<const std::string> of_scenario = sim_->monitor().happened();
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

/// The lines that came after the present tick, in a run that repeats what it was. Their answers were given then.
void RunHooks::repeat_lines() {
  for (; next_line_ < lines_.size() && lines_[next_line_].tick == sim_->tick_index(); ++next_line_)
    (void)act(lines_[next_line_].text);
}

void RunHooks::forget_future_lines() { lines_.resize(std::min(lines_.size(), next_line_)); }

Result<std::string> RunHooks::execute(std::string_view line) {
  if (!inside_) {
    forget_future_lines();
    lines_.push_back({sim_->tick_index(), std::string(line)});
    next_line_ = lines_.size();
  }
  return act(line);
}

Result<std::string> RunHooks::act(std::string_view line) {
  SL_ASSIGN(const std::vector<std::string> words, words_of(line));
  if (words.size() == 1 && words.front() == "help") {
    std::string out;
    for (const HookCommand& command : hooks_.commands)
      out += (out.empty() ? "" : "\n") + command.name + "  " + command.help;
    return out;
  }
  SL_ASSIGN(const HookCommand* const command, find_command(words));
  Result<std::string> answer = std::string();
  const bool outer = std::exchange(inside_, true);
  const auto thrown = caught([&] { answer = command->act(*this, std::span(words).subspan(1)); });
  inside_ = outer;
  if (thrown) return Error{"'" + words.front() + "' threw: " + *thrown};
  return answer;
}

}  // namespace sandlot
