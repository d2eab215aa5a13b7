/// Control programs in the phases of a tick: how they step, and how their orders are delivered.
#include "sim/world/programs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <map>

#include "base/prefetch.h"
#include "base/text.h"
#include "physics/parallel.h"
#include "sim/world/beings.h"
#include "sim/world/device_keys.h"
#include "sim/world/lookup.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

constexpr std::size_t cache_line = 64;
/// Few enough to stay on the stack, enough for a kind to run warm.
constexpr std::size_t most_in_batch = 16;

/// Programs lie all over the memory. This fetches what a batch of them needs at once, as far as pointers lead, so that in a
/// large swarm the machine waits once per batch and not once per pointer.
void prefetch_programs(std::span<SimulationParts::ProgramEntry* const> programs) {
  for (const SimulationParts::ProgramEntry* const entry : programs) {
    const auto* const end = reinterpret_cast<const std::byte*>(&entry->routes);
    for (const auto* at = reinterpret_cast<const std::byte*>(&entry->key); at < end; at += cache_line)
      __builtin_prefetch(at);
  }
  for (const SimulationParts::ProgramEntry* const entry : programs) {
    __builtin_prefetch(entry->controller.get());
    __builtin_prefetch(entry->topics.data());
    __builtin_prefetch(entry->seen.data());
    __builtin_prefetch(entry->command.orders().data(), 1);
  }
  for (const SimulationParts::ProgramEntry* const entry : programs)
    for (const TopicBase* const topic : entry->topics) {
      __builtin_prefetch(topic);
      __builtin_prefetch(reinterpret_cast<const std::byte*>(topic) + 128);
    }
}

void set_failure(SimulationParts::ProgramEntry& entry, std::optional<std::string> failure) {
  entry.failure = failure ? std::make_unique<std::string>(std::move(*failure)) : nullptr;
}

/// Sources of orders of teams come after those of robots, whose sources are their creation order.
constexpr std::uint64_t first_team = std::uint64_t{1} << 63;

/// Tells programs outside that need it which robots and objects there are.
void meet_surroundings(Programs::Entities entities, std::span<Programs::ProgramEntry* const> outside) {
  std::vector<programs::Being> beings;
  for (Programs::ProgramEntry* const entry : outside) {
    auto* const surrounded = dynamic_cast<programs::Surrounded*>(entry->program.get());
    if (!surrounded) continue;
    if (beings.empty()) beings = beings_of(entities);
    surrounded->meet(beings);
  }
}

}  // namespace

// --------------------------------------------------------------------------------------------- phases of a tick

/// Lists the programs again when some came, went or ended.
void Programs::gather(Entities entities) {
  if (!changed_) return;
  changed_ = false;
  for (auto* const list : {&all_, &running_, &timed_, &publishing_, &outside_}) list->clear();
  sources_.clear();
  const auto add = [&](ProgramEntry& program, std::uint64_t source) {
    all_.push_back(&program);
    sources_.push_back(source);
    if (program.outputs) publishing_.push_back(&program);
    if (program.program->outside()) outside_.push_back(&program);
    if (!program.ended && !program.inactive)
      (program.schedule || program.wait ? timed_ : running_).push_back(&program);
  };
  for (auto& entity : entities)
    for (auto& program : entity->programs) add(*program, entity->serial);
  for (std::size_t i = 0; i < teams_.size(); ++i)
    for (auto& program : teams_[i].programs) add(*program, first_team + i);
  meet_surroundings(entities, outside_);
  // Kind by kind, in the order in which the kinds first appear.
  for (auto* const list : {&running_, &timed_}) {
    std::map<const ControllerKind*, std::size_t> place;
    for (const ProgramEntry* const entry : *list) place.emplace(entry->kind, place.size());
    std::stable_sort(list->begin(), list->end(), [&](const ProgramEntry* a, const ProgramEntry* b) {
      return place.at(a->kind) < place.at(b->kind);
    });
  }
}

bool Programs::is_due(const ProgramEntry& entry, Time now, bool control_step) const {
  if (entry.wait && entry.wait->waiting_for == Program::Waiting::time) return entry.wait->until <= now;
  if (entry.wait && entry.wait->waiting_for == Program::Waiting::message)
    return entry.topics[entry.wait->reading]->count > entry.seen[entry.wait->reading];
  return entry.schedule ? entry.schedule->due <= now : control_step;
}

/// Notes what a program waits for now.
void Programs::take(ProgramEntry& entry, Program::Resumed resumed) {
  set_failure(entry, std::move(resumed.failure));
  entry.ended = resumed.waiting_for == Program::Waiting::nothing;
  if (!entry.wait) return;
  SL_CHECK(resumed.waiting_for != Program::Waiting::message || resumed.reading < entry.topics.size());
  *entry.wait = {resumed.waiting_for, resumed.until, resumed.reading};
}

Error Programs::failure_of(const ProgramEntry& entry, Time now) {
  const bool controller = static_cast<bool>(entry.controller);
  return {std::string(controller ? "controller '" : "program '") + entry.path + "' (" + entry.decl.kind +
              (controller ? ") threw at " : ") failed at ") + number_text(now.s()) + " s: " + *entry.failure,
          "", entry.decl.place};
}

void Programs::plan_next_step(ProgramEntry& entry, Time now) const {
  SimulationParts::Schedule& schedule = *entry.schedule;
  if (schedule.due > now) return;  // it waited for something else
  ++schedule.step;
  // Steps that a long tick of a continuous clock skips are left out, and those in which it waited for something else.
  if (setup_.clock.mode == model::Clock::Mode::continuous || entry.wait) {
    const double passed = (now - schedule.start).s() * schedule.rate_hz;
    schedule.step = std::max(schedule.step, static_cast<std::uint64_t>(passed) + 1);
  }
  schedule.due = due_time(schedule.start, static_cast<std::int64_t>(schedule.step), schedule.rate_hz);
}

bool Programs::step_batch(std::span<ProgramEntry* const> batch, Time now) const {
  std::array<std::optional<Observation>, most_in_batch> seen;
  std::array<ControllerTurn, most_in_batch> turns;
  const auto step_all = batch.front()->kind ? batch.front()->kind->step_all : nullptr;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    ProgramEntry& entry = *batch[i];
    entry.command.clear();
    seen[i].emplace(
        now, entry.topics, entry.seen, Stream(setup_.seed, entry.key, Purpose::controller, entry.steps),
        entry.outputs ? std::as_const(*entry.outputs).inputs() : std::span<const Outputs::Input>());
    turns[i] = {entry.controller.get(), &*seen[i], &entry.command};
  }
  if (step_all) step_all({turns.data(), batch.size()});
  bool news = false;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    ProgramEntry& entry = *batch[i];
    if (step_all) set_failure(entry, std::move(turns[i].failure));
    else take(entry, entry.program->resume(*seen[i], entry.command));
    ++entry.steps;
    if (entry.schedule) plan_next_step(entry, now);
    for (std::size_t t = 0; t < entry.topics.size(); ++t) entry.seen[t] = entry.topics[t]->count;
    if (entry.outputs)
      for (Outputs::Input& input : entry.outputs->inputs()) input.seen = input.topic->count;
    news = news || entry.ended || entry.failure;
  }
  return news;
}

std::optional<Error> Programs::step(Entities entities, Time now, bool control_step) {
  gather(entities);
  std::span<ProgramEntry* const> due;
  if (control_step) due = running_;
  if (!timed_.empty()) {
    due_.assign(due.begin(), due.end());
    for (ProgramEntry* const entry : timed_)
      if (is_due(*entry, now, control_step)) due_.push_back(entry);
    due = due_;
  }
  std::atomic<bool> news = false;
  parallel_for(due.size(), 64, [&](std::size_t begin, std::size_t end) {
    while (begin < end) {
      const auto batch = due.subspan(begin, std::min(most_in_batch, end - begin));
      prefetch_programs(batch);
      std::size_t count = 1;
      while (count < batch.size() && batch[count]->kind == batch.front()->kind) ++count;
      if (step_batch(batch.first(count), now)) news = true;
      begin += count;
    }
  });
  for (ProgramEntry* const entry : publishing_) entry->outputs->commit(now);
  std::optional<Error> failed;
  for (const ProgramEntry* entry : news ? due : std::span<ProgramEntry* const>()) {
    changed_ = changed_ || entry->ended;
    if (entry->failure && !failed) failed = failure_of(*entry, now);
  }
  awaited_.clear();
  awaited_clients_.clear();
  for (ProgramEntry* const entry : outside_)
    if (std::find(due.begin(), due.end(), entry) != due.end())
      (entry->program->outside()->is_client() ? awaited_clients_ : awaited_).push_back(entry);
  return failed;
}

/// Fetches what the orders of the programs after the i-th will need, a step further along the pointers the nearer they are.
void Programs::prefetch_orders(std::size_t i) const {
  __builtin_prefetch(&all_[i + 16]->routes);
  __builtin_prefetch(&all_[i + 16]->command);
  const ProgramEntry& third = *all_[i + 12];
  __builtin_prefetch(third.routes.data());
  __builtin_prefetch(third.command.orders().data());
  const ProgramEntry& second = *all_[i + 8];
  for (const Command::Order& order : second.command.orders()) {
    __builtin_prefetch(second.command.bytes(order).data());
    if (order.is_sample()) continue;
    const SimulationParts::Route& route = second.routes[order.slot];
    if (!route.slot) continue;
    __builtin_prefetch(&route.device->faults);
    __builtin_prefetch(&route.device->keys);
    __builtin_prefetch(route.slot.get());
  }
  const ProgramEntry& first = *all_[i + 4];
  for (const Command::Order& order : first.command.orders())
    if (!order.is_sample() && first.routes[order.slot].slot) {
      const auto* const topic = reinterpret_cast<const std::byte*>(
          first.routes[order.slot].slot->topic.get());
      __builtin_prefetch(topic, 1);
      __builtin_prefetch(topic + cache_line, 1);
      const SimulationParts::Device& device = *first.routes[order.slot].device;
      if (device.keys) prefetch(&device.keys->state, 1);
      if (device.energy) prefetch(device.energy.get(), 1);
    }
}

void Programs::deliver_orders(Entities entities, Time now, Time end, bool logged,
                              const FindDevice& find_device) {
  gather(entities);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    ProgramEntry& program = *all_[i];
    // Programs lie all over the memory; see prefetch().
    if (i + 16 < all_.size()) prefetch_orders(i);
    for (const Command::Order& order : program.command.orders()) {
      if (order.is_sample()) {
        deliver_sample(program, order, end, logged, sources_[i], find_device);
        continue;
      }
      SimulationParts::Route& route = program.routes[order.slot];
      const bool possible = route.slot && !commands_.is_overridden(*route.device);
      const std::span<const std::byte> bytes = program.command.bytes(order);
      // Orders for a level that was switched off meanwhile, or for a device under manual override, are refused and counted.
      const bool refused = !possible || !devices_.deliver(*route.device, *route.slot, bytes, now, false);
      if (refused) commands_.count_refused();
      if (!logged) continue;
      const Description::Entry& entry = program.description->actuators[order.slot];
      LogEntry& log = commands_.log_entry(LogEntry::command, {Source::Kind::program, sources_[i]},
                                          program.steps);
      if (route.device) log.target = route.device->path;
      if (!entry.level.empty()) log.target.append("/").append(entry.level);
      log.type = entry.type;
      log.bytes.assign(bytes.begin(), bytes.end());
      log.refused = refused;
    }
    program.command.clear();
  }
}

Status Programs::deliver(ProgramEntries& programs, const CommandRequest& command, Time now) {
  const TopicBase* of_other_type = nullptr;
  bool taken = false;
  for (auto& program : programs) {
    if (!program->outputs) continue;
    for (Outputs::Input& input : program->outputs->inputs()) {
      if (std::string_view(input.topic->name()).substr(1) != command.target) continue;
      if (command.type != input.topic->type()) {
        of_other_type = input.topic.get();
        continue;
      }
      if (command.bytes.size() > most_input_bytes)
        return Error{"a message on '" + input.topic->name() + "' has " +
                         std::to_string(command.bytes.size()) + " bytes",
                     "at most " + std::to_string(most_input_bytes)};
      SL_TRY(input.topic->assign(command.bytes));
      input.topic->stamp = now;
      ++input.topic->count;
      taken = true;
    }
  }
  if (taken) return {};
  if (of_other_type)
    return Error{"'" + of_other_type->name() + "' takes " + of_other_type->type() + ", not " +
                 command.type.substr(0, 200)};
  return no_device(command.target);
}

/// Asks a device for a sample at the end of this tick.
void Programs::deliver_sample(ProgramEntry& program, const Command::Order& order, Time end, bool logged,
                              std::uint64_t source, const FindDevice& find_device) {
  // "/rover/laser/ranges" is a topic of the device "rover/laser". A topic of a program has no device.
  const TopicBase* const topic = program.topics[order.reading()];
  const std::string_view name = topic ? std::string_view(topic->name()).substr(1) : std::string_view();
  Device* const device = find_device(name.substr(0, name.find('/', name.find('/') + 1)));
  const bool refused = !device || !devices_.request_sample(*device, end);
  if (refused) commands_.count_refused();
  if (!logged) return;
  const SampleRequest request{device ? device->path : ""};
  LogEntry& log = commands_.log_entry(static_cast<std::uint8_t>(Request(request).index()),
                                      {Source::Kind::program, source}, program.steps);
  log.target = request.device;
  ByteWriter w;
  write_request(w, request);
  log.bytes.assign(w.bytes().begin(), w.bytes().end());
  log.refused = refused;
}

// --------------------------------------------------------------------------------------------------------- State

namespace {

/// Readings of late topics are the last of a description: those that have never had a message add no bytes.
std::size_t saved_readings(const SimulationParts::ProgramEntry& program) {
  std::size_t n = program.seen.size();
  while (n > 0 && program.seen[n - 1] == 0 && is_late(program.description->readings[n - 1])) --n;
  return n;
}

}  // namespace

void Programs::save(const ProgramEntry& program, ByteWriter& w) {
  write(w, program.steps);
  write(w, static_cast<std::uint8_t>((program.ended ? 1 : 0) | (program.inactive ? 2 : 0)));
  const std::size_t readings = saved_readings(program);
  write(w, static_cast<std::uint32_t>(readings));
  for (std::size_t i = 0; i < readings; ++i) write(w, program.seen[i]);
  write(w, static_cast<std::uint32_t>(program.command.orders().size()));
  for (const Command::Order& order : program.command.orders()) {
    const auto bytes = program.command.bytes(order);
    write(w, order.slot);
    write(w, static_cast<std::uint32_t>(bytes.size()));
    w.raw(bytes.data(), bytes.size());
  }
  if (program.schedule) {
    write(w, program.schedule->start);
    write(w, program.schedule->step);
  }
  if (program.wait) {
    write(w, program.wait->waiting_for);
    write(w, program.wait->until);
    write(w, program.wait->reading);
  }
  if (program.outputs) {
    for (const Outputs::Output& output : program.outputs->all()) output.topic->save(w);
    for (const Outputs::Input& input : program.outputs->inputs()) {
      input.topic->save(w);
      write(w, input.seen);
    }
  }
  program.program->save(w);
}

bool Programs::load(ProgramEntry& program, ByteReader& r, Time now) {
  const std::size_t readings = program.seen.size();
  read(r, program.steps);
  std::uint8_t flags = 0;
  read(r, flags);
  if (flags > 3) return false;
  program.ended = (flags & 1) != 0;
  program.inactive = (flags & 2) != 0;
  read(r, program.seen);
  const std::size_t saved = program.seen.size();
  program.seen.resize(readings, 0);
  if (saved > readings || saved != saved_readings(program)) return false;
  std::uint32_t orders = 0;
  read(r, orders);
  program.command.clear();
  for (std::uint32_t i = 0; i < orders && r.ok(); ++i) {
    std::uint32_t slot = 0, size = 0;
    read(r, slot);
    read(r, size);
    const auto bytes = r.take(size);
    if ((slot & Command::sample_bit) != 0) {
      if ((slot & ~Command::sample_bit) >= readings || size != 0) return false;
      program.command.request_sample_of(slot & ~Command::sample_bit);
      continue;
    }
    if (slot >= program.description->actuators.size()) return false;
    program.command.set_bytes(slot, bytes);
  }
  if (program.schedule) {
    SimulationParts::Schedule& schedule = *program.schedule;
    read(r, schedule.start);
    read(r, schedule.step);
    // The due time is computed from these: what cannot be would overflow.
    if (schedule.start < Time{} || schedule.start > now) return false;
    if (static_cast<double>(schedule.step) > (now - schedule.start).s() * schedule.rate_hz + 2) return false;
    schedule.due = due_time(schedule.start, static_cast<std::int64_t>(schedule.step), schedule.rate_hz);
  }
  if (program.wait) {
    SimulationParts::Wait& wait = *program.wait;
    read(r, wait.waiting_for);
    read(r, wait.until);
    read(r, wait.reading);
    if (wait.waiting_for > Program::Waiting::nothing || wait.until < Time{} ||
        (wait.waiting_for == Program::Waiting::message && wait.reading >= readings))
      return false;
  }
  const auto load_topic = [&](TopicBase& topic) {
    topic.load(r);
    return topic.stamp >= Time{} && topic.stamp <= now;
  };
  if (program.outputs) {
    for (Outputs::Output& output : program.outputs->all())
      if (!load_topic(*output.topic)) return false;
    for (Outputs::Input& input : program.outputs->inputs()) {
      if (!load_topic(*input.topic) || !check_command(input.topic->info(), input.topic->data())) return false;
      read(r, input.seen);
      if (input.seen > input.topic->count) return false;
    }
  }
  program.program->load(r);
  return r.ok();
}

}  // namespace sandlot
