#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "base/text.h"
#include "model/motion.h"
#include "physics/parallel.h"
#include "sim/visuals/render_scene.h"
#include "sim/watch/monitor.h"
#include "sim/world/simulation.h"

namespace sandlot {
/// One step of the world. Each phase sees what the phases before it left; see docs/architecture.md section 3.
Status Simulation::tick(std::optional<Time> measured) {
  if (!status_) return status_;
  arena_->execute([&] {
    set_step(measured);
    take_commands();        // 1  requests from outside, then what programs ordered in the previous tick
    actuate();              // 2  actuators turn commands into targets and wrenches
    physics();              // 3  sub-steps: servo loops, then the engine
    if (!status_) return;  // nothing has moved: the world is that of the last tick that was sound
    now_ = now_ + step_;
    ++tick_;
    update_scene();   // 4  new poses into the ray scene
    sense();          // 5  sensors that are due take their samples
    deliver_media();  // 6  what was emitted in this tick reaches its receivers
    judge();          // 7  rules: stop conditions
    control();        // 8  programs decide; their orders act in the next tick
    publish();        // 9  the immutable frame to observers
  });
  return status_;
}

Context Simulation::context() {
  Context all{now_, step_, tick_, setup_.seed, *engine_, *rays_, actuation_, emissions_};
  all.topics = this;
  if (render_scene_) {
    all.pictures = &render_scene_->pictures;
    all.labelled_objects = render_scene_->labelled_objects;
  }
  return all;
}

/// A clock that measures takes longer sub-steps no further than the setup allows: it takes more of them.
void Simulation::set_step(std::optional<Time> measured) {
  wants_ = {.instances = false};
  for (const Observer* observer : observers_) {
    const Observer::Wants wants = observer->wants();
    wants_.messages = wants_.messages || wants.messages;
    wants_.log = wants_.log || wants.log;
    wants_.input = wants_.input || wants.input || wants.log;
    wants_.hash = wants_.hash || wants.hash;
    wants_.links = wants_.links || wants.links;
    wants_.contacts = wants_.contacts || wants.contacts;
    wants_.instances = wants_.instances || wants.instances || wants.links;
  }
  for (LogEntry& entry : log_) spare_log_.push_back(std::move(entry));
  log_.clear();
  step_ = setup_.step;
  substeps_ = setup_.substeps;
  if (!measured) return;
  step_ = std::clamp(*measured, setup_.clock.min_step, setup_.clock.max_step);
  const std::int64_t total = step_.ns * setup_.substeps;
  substeps_ = static_cast<int>(std::max<std::int64_t>(1, (total + setup_.step.ns - 1) / setup_.step.ns));
  if (!wants_.input) return;
  LogEntry& entry = log_entry(LogEntry::step, {}, 0);
  ByteWriter w;
  write(w, step_.ns);
  entry.bytes.assign(w.bytes().begin(), w.bytes().end());
}

void Simulation::take_commands() {
  const PhaseTimer timer(phase_times_, Phase::commands);
  outcomes_.clear();
  std::erase_if(holds_, [&](const Hold& hold) { return hold.until <= now_; });
  {
    const std::lock_guard lock(inbox_mutex_);
    std::swap(carrying_out_, inbox_);
  }
  std::sort(carrying_out_.begin(), carrying_out_.end(), [](const Pending& a, const Pending& b) {
    return std::tuple(a.source.kind, a.source.id, a.sequence) <
           std::tuple(b.source.kind, b.source.id, b.sequence);
  });
  for (Pending& pending : carrying_out_) {
    outcomes_.push_back({pending.source, pending.sequence, carry_out(pending.request, pending.source)});
    if (wants_.input) log_request(pending.request, outcomes_.back());
  }
  carrying_out_.clear();
  apply_program_orders();
}

void Simulation::actuate() {
  const PhaseTimer timer(phase_times_, Phase::actuate);
  actuation_.clear();
  emissions_.clear();
  Context ctx = context();
  ctx.now = now_ + step_;
  for (Pool& pool : pools_) {
    if (!(pool.kind->phases & phase_actuate) || pool.devices.empty()) continue;
    pool.pool->actuate(ctx, {acting(pool, &ctx), pool.sample, pool.levels, pool.since});
  }
}

void Simulation::physics() {
  const PhaseTimer timer(phase_times_, Phase::physics);
  const double h_s = step_.s() / substeps_;
  Context ctx = context();
  ctx.now = now_ + step_;
  // Of a fixed clock the sub-steps are counted through; a tick of a continuous one may have any number of them.
  const auto key = [&](int substep) {
    const auto at = static_cast<std::uint64_t>(substep);
    return setup_.clock.mode == model::Clock::Mode::fixed
               ? tick_ * static_cast<std::uint64_t>(setup_.substeps) + at
               : hash_combine(tick_, at);
  };
  for (int substep = 0; substep < substeps_; ++substep) {
    // Wrenches of the actuate phase act over the whole tick, those of pre_substep in their sub-step.
    const std::size_t held = actuation_.wrenches.size();
    for (Pool& pool : pools_)
      if ((pool.kind->phases & phase_pre_substep) && !pool.devices.empty())
        pool.pool->pre_substep(ctx, {acting(pool, nullptr), pool.sample, pool.levels, pool.since}, h_s);
    pull();
    if (!actuation_.watch.empty()) engine_->watch(actuation_.watch);
    engine_->apply(actuation_.wrenches);
    engine_->set_targets(actuation_.joints);
    engine_->set_drive_targets(actuation_.drives);
    engine_->set_rolls(actuation_.rolls);
    engine_->set_wheels(actuation_.wheels);
    engine_->set_grips(actuation_.grips);
    for (const Entity* entity : guided_) {
      const double from_s = now_.s() + substep * h_s;
      const model::Moved to = model::moved(*entity->instance.motion, from_s, from_s + h_s);
      engine_->guide(entity->id, to.X_WM, to.V_WM);
    }
    engine_->step(h_s, hash_combine(mix64(setup_.seed), key(substep)));
    for (Pool& pool : pools_)
      if ((pool.kind->phases & phase_post_substep) && !pool.devices.empty())
        pool.pool->post_substep(ctx, {acting(pool, nullptr), pool.sample, pool.levels, pool.since}, h_s);
    actuation_.wrenches.resize(held);
    actuation_.joints.clear();
    actuation_.drives.clear();
    actuation_.rolls.clear();
    actuation_.wheels.clear();
    actuation_.grips.clear();
    actuation_.watch.clear();
  }
  if (Status finite = engine_->check_finite(); !finite) {
    status_ = std::move(finite);
    status_.error().what += ", between " + number_text(now_.s()) + " s and " +
                             number_text((now_ + step_).s()) + " s";
    stop_reason_ = status_.error().what;
  }
}

/// Adds the forces of all pulls to this sub-step's wrenches.
void Simulation::pull() {
  std::erase_if(pulls_, [&](const Pull& pull) { return pull.until <= now_; });
  for (const Pull& pull : pulls_)
    for (const auto& entity : entities_) {
      if (entity->serial != pull.serial) continue;
      const model::Model& model = *entity->instance.model;
      const BodyId body = engine_->bodies(entity->id)[pull.link];
      actuation_.wrenches.push_back(
          wrench_of(pull, body, engine_->states()[body.index], model.links[pull.link], mass_kg(model)));
    }
}

void Simulation::update_scene() {
  const PhaseTimer timer(phase_times_, Phase::scene);
  if (render_scene_) render_scene_->update(*engine_, tick_, revision_);
  if (!scene_) return;
  const auto states = engine_->states();
  scene_frame_.tick = tick_;
  scene_frame_.X_WG.resize(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) scene_frame_.X_WG[i] = states[i].X_WB;
  scene_->update(scene_frame_);
}

void Simulation::sense() {
  const PhaseTimer timer(phase_times_, Phase::sense);
  const Context ctx = context();
  for (Pool& pool : pools_) {
    if (!(pool.kind->phases & phase_sense) || pool.devices.empty()) continue;
    pool.due.clear();
    for (std::uint32_t i = 0; i < pool.devices.size(); ++i) {
      Timing& when = pool.timing[i];
      if (!when.requested && when.due > now_) continue;
      when.requested = false;
      pool.due.push_back(i);
      pool.sample[i] = when.sample;
      // The first sample has no predecessor: it counts as one nominal interval after it.
      if (when.sample == 0) pool.since[i] = when.rate_hz > 0 ? due_time({}, 1, when.rate_hz) : step_;
      else pool.since[i] = now_ - when.last;
      when.last = now_;
      ++when.sample;
      if (when.rate_hz <= 0) continue;  // due in every tick
      // A tick of a continuous clock may be longer than the interval: the samples it passed over are lost.
      if (setup_.clock.mode == model::Clock::Mode::continuous && when.due > Time{}) {
        const double passed = (now_ - when.start).s() * when.rate_hz;
        when.sample = std::max(when.sample, static_cast<std::uint64_t>(passed) + 1);
      }
      when.due = due_time(when.start, static_cast<std::int64_t>(when.sample), when.rate_hz);
    }
    if (pool.due.empty()) continue;
    if (pool.faulty > 0) sense_faulty(pool, ctx);
    else pool.pool->sense(ctx, {pool.due, pool.sample, pool.levels, pool.since});
  }
}

void Simulation::deliver_media() {
  const PhaseTimer timer(phase_times_, Phase::media);
  const MediumContext ctx{now_, tick_, setup_.seed, *engine_, *rays_};
  for (const auto& medium : media_) medium->deliver(emissions_, ctx);
}

void Simulation::judge() {
  const PhaseTimer timer(phase_times_, Phase::rules);
  const RuleContext ctx{now_, tick_, *engine_};
  for (const auto& rule : rules_) {
    auto reason = rule->judge(ctx);
    if (reason && !stop_reason_) stop_reason_ = std::move(reason);
  }
  auto judged = monitor_->judge(now_);
  if (judged) {
    if (*judged && !stop_reason_) stop_reason_ = std::move(*judged);
  } else {
    if (status_) status_ = std::move(judged.error());
    if (tick_ > 0) stop_reason_ = status_.error().what;  // else the first tick() answers: see control()
  }
}

/// Lists the programs anew when some came, went or ended.
void Simulation::gather_programs() {
  if (!programs_changed_) return;
  programs_changed_ = false;
  programs_.clear();
  owners_.clear();
  running_.clear();
  for (const auto& entity : entities_)
    for (const auto& program : entity->programs) {
      programs_.push_back(program.get());
      owners_.push_back(entity.get());
      if (!program->ended) running_.push_back(program.get());
    }
  // Kind by kind, in the order in which the kinds first appear.
  std::map<const ControllerKind*, std::size_t> place;
  for (const ProgramEntry* const entry : running_) place.emplace(entry->kind, place.size());
  std::stable_sort(running_.begin(), running_.end(), [&](const ProgramEntry* a, const ProgramEntry* b) {
    return place.at(a->kind) < place.at(b->kind);
  });
}

namespace {

/// Programs lie all over the memory. What those of a batch need of it is asked for at once, as far as pointers lead, so that
/// in a large swarm the machine waits once per batch and not once per pointer.
void prefetch(std::span<SimulationParts::ProgramEntry* const> programs) {
  for (const SimulationParts::ProgramEntry* const entry : programs) {
    __builtin_prefetch(&entry->key);
    __builtin_prefetch(&entry->topics);
    __builtin_prefetch(&entry->steps);
  }
  for (const SimulationParts::ProgramEntry* const entry : programs) {
    __builtin_prefetch(entry->controller);
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

}  // namespace

void Simulation::control() {
  const PhaseTimer timer(phase_times_, Phase::control);
  if (!options_.run_programs || tick_ % static_cast<std::uint64_t>(setup_.control_interval) != 0) return;
  gather_programs();
  parallel_for(running_.size(), 64, [&](std::size_t begin, std::size_t end) {
    // Few enough to stay on the stack, enough for a kind to run warm.
    constexpr std::size_t most = 16;
    std::array<std::optional<Observation>, most> seen;
    std::array<ControllerTurn, most> turns;
    while (begin < end) {
      const ControllerKind* const kind = running_[begin]->kind;
      std::size_t count = 0;
      prefetch({&running_[begin], std::min(most, end - begin)});
      for (; count < most && begin + count < end && running_[begin + count]->kind == kind; ++count) {
        ProgramEntry& entry = *running_[begin + count];
        entry.command.clear();
        seen[count].emplace(now_, entry.topics, entry.seen,
                            Stream(setup_.seed, entry.key, Purpose::controller, entry.steps));
        turns[count] = {entry.controller, &*seen[count], &entry.command};
      }
      if (kind->step_all) kind->step_all({turns.data(), count});
      for (std::size_t i = 0; i < count; ++i) {
        ProgramEntry& entry = *running_[begin + i];
        if (kind->step_all) {
          entry.failure = std::move(turns[i].failure);
        } else {
          Program::Resumed resumed = entry.program->resume(now_, *seen[i], entry.command);
          entry.failure = std::move(resumed.failure);
          entry.ended = resumed.waiting_for == Program::Waiting::nothing;
        }
        ++entry.steps;
        for (std::size_t t = 0; t < entry.topics.size(); ++t) entry.seen[t] = entry.topics[t]->count;
      }
      begin += count;
    }
  });
  for (const ProgramEntry* entry : running_) {
    programs_changed_ = programs_changed_ || entry->ended;
    if (!entry->failure || !status_) continue;
    status_ = Error{"controller '" + entry->path + "' (" + entry->decl.kind + ") threw at " +
                         number_text(now_.s()) + " s: " + *entry->failure,
                     "", entry->decl.place};
    // At tick 0 nothing runs yet that could stop: the first tick() answers with the failure.
    if (tick_ > 0) stop_reason_ = status_.error().what;
  }
}

}  // namespace sandlot
