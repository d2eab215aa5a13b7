/// One tick of the world, phase by phase.
#include <tbb/task_arena.h>

#include <algorithm>

#include "base/text.h"
#include "model/motion.h"
#include "sim/visuals/render_scene.h"
#include "sim/watch/monitor.h"
#include "sim/world/beings.h"
#include "sim/world/simulation.h"

namespace sandlot {

/// Each phase reads the results of the phases before it; see docs/architecture.md, section 4.
Status Simulation::tick(std::optional<Time> measured) {
  if (!status_) return status_;
  programs_.end_waiting_for_clients();
  arena_->execute([&] {
    set_step(measured);
    process_commands();    // 1  requests from outside, then those of rules and orders of programs
    if (!status_) return;  // an answer from outside that its program cannot go on with
    actuate();             // 2  actuators turn commands into targets and wrenches
    physics();             // 3  sub-steps: servo loops, then the engine
    if (!status_) return;  // nothing has moved: the world is that of the last tick that was sound
    now_ = now_ + step_;
    ++tick_;
    update_scene();   // 4  new poses into the scenes
    deliver_media();  // 5  emissions of this tick reach the inboxes of their receivers
    sense();          // 6  batteries pay for the tick, and sensors that are due take their samples
    judge();          // 7  rules, events and stop conditions
    control();        // 8  programs decide; their orders act in the next tick
    publish();        // 9  the immutable frame to observers
  });
  // Outside of the threads' work: what programs of other processes answer is input of the next tick.
  if (status_) programs_.await_answers();
  return status_;
}

/// What devices see of the world. In the phases before the time advances, `now` is set to the end of the tick.
Context Simulation::context() {
  Context all{now_, step_, tick_, setup_.seed, *engine_, rays(), actuation_, emissions_};
  all.topics = this;
  all.energy = &devices_.energy();
  if (RenderScene* const render_scene = scenes_.render_scene()) {
    all.pictures = &render_scene->pictures;
    all.labelled_objects = render_scene->labelled_objects;
  }
  return all;
}

/// Ends the run. At tick 0 nothing runs yet that could stop: the first tick() returns the error then.
void Simulation::fail(Error error) {
  if (status_) status_ = std::move(error);
  if (tick_ > 0) stop_reason_ = status_.error().what;
}

/// The length of this tick and the number of its sub-steps. A measured tick has sub-steps no longer than the setup's: it has
/// more of them.
void Simulation::set_step(std::optional<Time> measured) {
  publisher_.begin_tick();
  elements_.begin_tick();
  commands_.clear_log();
  step_ = setup_.step;
  substeps_ = setup_.substeps;
  if (!measured) return;
  step_ = std::clamp(*measured, setup_.clock.min_step, setup_.clock.max_step);
  const std::int64_t total = step_.ns * setup_.substeps;
  substeps_ = static_cast<int>(std::max<std::int64_t>(1, (total + setup_.step.ns - 1) / setup_.step.ns));
  if (!publisher_.wants().input) return;
  LogEntry& entry = commands_.log_entry(LogEntry::step, {}, 0);
  ByteWriter w;
  write(w, step_.ns);
  entry.bytes.assign(w.bytes().begin(), w.bytes().end());
}

void Simulation::process_commands() {
  const PhaseTimer timer(phase_times_, Phase::commands);
  commands_.begin_tick(now_);
  const auto serial_of = [this](std::string_view target) {
    const Entity* const entity = find_entity(first_part(target));
    return entity ? std::optional(entity->serial) : std::nullopt;
  };
  // Logged orders of programs come where the programs' own would: after the requests of rules.
  const auto is_order = [&](const Commands::Pending& pending) {
    return !options_.run_programs && pending.logged && pending.source.kind == Source::Kind::program;
  };
  const auto carry_out = [&](Commands::Pending& pending) {
    std::vector<std::byte> response;
    Status status = process(pending.request, pending.source, response);
    commands_.conclude(pending, std::move(status), publisher_.wants().input, std::move(response));
  };
  const std::span<Commands::Pending> requests = commands_.take(serial_of);
  for (Commands::Pending& pending : requests)
    if (!is_order(pending)) carry_out(pending);
  for (WorldElements::Waiting& waiting : elements_.take_requests()) {
    Commands::Pending pending{waiting.source, waiting.number, std::move(waiting.request)};
    std::vector<std::byte> response;
    Status status = process(pending.request, pending.source, response);
    // A rule that puts something where it cannot be is a mistake of the scenario.
    if (const auto* const put = std::get_if<PoseRequest>(&pending.request);
        put && !status && find_entity(put->name)) {
      const model::ElementDecl& rule = setup_.rules[pending.source.id];
      fail({"rule '" + rule.name + "': " + status.error().what, status.error().fix, rule.place});
    }
    commands_.conclude(pending, std::move(status), publisher_.wants().input, std::move(response));
  }
  for (Commands::Pending& pending : requests)
    if (is_order(pending)) carry_out(pending);
  // A snapshot may hold orders of programs that do not run: the log that drives the run has them, too.
  if (options_.run_programs)
    programs_.deliver_orders(entities_, now_, now_ + step_, publisher_.wants().log,
                             [this](std::string_view path) { return find_device(path); });
}

void Simulation::actuate() {
  const PhaseTimer timer(phase_times_, Phase::actuate);
  actuation_.clear();
  emissions_.clear();
  Context ctx = context();
  ctx.now = now_ + step_;
  devices_.actuate(ctx);
}

void Simulation::physics() {
  const PhaseTimer timer(phase_times_, Phase::physics);
  const double h_s = step_.s() / substeps_;
  Context ctx = context();
  ctx.now = now_ + step_;
  // Random numbers of the solver: a fixed clock counts its sub-steps through the run; a tick of a continuous clock may have
  // any number of them.
  const auto key = [&](int substep) {
    const auto at = static_cast<std::uint64_t>(substep);
    return setup_.clock.mode == model::Clock::Mode::fixed
               ? tick_ * static_cast<std::uint64_t>(setup_.substeps) + at
               : hash_combine(tick_, at);
  };
  for (int substep = 0; substep < substeps_; ++substep) {
    // What devices want: wrenches of the actuate phase act over the whole tick, those of pre_substep and of pulls in their
    // sub-step. Targets hold in the engine until the next ones.
    const std::size_t held = actuation_.wrenches.size();
    devices_.pre_substep(ctx, h_s);
    pulls_.add_wrenches(entities_, *engine_, now_, actuation_);
    elements_.push(medium_context(), h_s, actuation_.wrenches);
    elements_.watch(actuation_.watch);
    hand_over(actuation_);
    // Obstacles with a motion of their own: where they stand at the end of the sub-step.
    for (const Entity* entity : guided_) {
      const double from_s = now_.s() + substep * h_s;
      const model::Moved to = model::moved(*entity->instance.motion, from_s, from_s + h_s);
      engine_->guide(entity->id, to.X_WM, to.V_WM);
    }
    engine_->step(h_s, hash_combine(mix64(setup_.seed), key(substep)));
    devices_.post_substep(ctx, h_s);
    elements_.note_touches(static_cast<std::uint32_t>(substep), h_s);
    actuation_.wrenches.resize(held);
    actuation_.joints.clear();
    actuation_.drives.clear();
    actuation_.rolls.clear();
    actuation_.wheels.clear();
    actuation_.grips.clear();
    actuation_.watch.clear();
  }
  // An exploded world ends the run with the state before this tick.
  if (Status finite = engine_->check_finite(); !finite) {
    status_ = std::move(finite);
    status_.error().what += ", between " + number_text(now_.s()) + " s and " +
                            number_text((now_ + step_).s()) + " s";
    stop_reason_ = status_.error().what;
  }
}

/// Gives the engine everything that devices want of it: the one place that knows the list.
void Simulation::hand_over(const Actuation& actuation) {
  if (!actuation.watch.empty()) engine_->watch(actuation.watch);
  engine_->apply(actuation.wrenches);
  engine_->set_targets(actuation.joints);
  engine_->set_drive_targets(actuation.drives);
  engine_->set_rolls(actuation.rolls);
  engine_->set_wheels(actuation.wheels);
  engine_->set_grips(actuation.grips);
}

void Simulation::update_scene() {
  const PhaseTimer timer(phase_times_, Phase::scene);
  scenes_.update(tick_, revision_);
}

MediumContext Simulation::medium_context() const {
  return {.now = now_,
          .step = step_,
          .tick_index = tick_,
          .seed = setup_.seed,
          .world = elements_,
          .rays = rays(),
          .emissions = {},
          .buffer = emissions_,
          .receivers = {},
          .receivers_by_key = {}};
}

void Simulation::deliver_media() {
  const PhaseTimer timer(phase_times_, Phase::media);
  elements_.deliver(medium_context(), publisher_.wants().deliveries);
  emissions_.clear();
}

void Simulation::sense() {
  const PhaseTimer timer(phase_times_, Phase::sense);
  devices_.sense(context());
  SL_CHECK_MSG(emissions_.emissions.empty(),
               "a device emits while it senses; that belongs into its actuate phase");
}

void Simulation::judge() {
  const PhaseTimer timer(phase_times_, Phase::rules);
  elements_.judge(now_, step_);
  find_stop_reason();
}

/// What ends the run now, if anything: its stop time, a rule, an event. Asked again at the same time, it finds the same.
void Simulation::find_stop_reason() {
  if (!stop_reason_ && setup_.stop && now_ >= *setup_.stop)
    stop_reason_ = "simulated time reached " + number_text(setup_.stop->s()) + " s";
  if (const std::string* const reason = elements_.stop_reason(); reason && !stop_reason_)
    stop_reason_ = *reason;
  auto judged = monitor_->judge(now_);
  if (!judged) return fail(std::move(judged.error()));
  if (*judged && !stop_reason_) stop_reason_ = std::move(*judged);
}

void Simulation::control() {
  const PhaseTimer timer(phase_times_, Phase::control);
  if (!options_.run_programs) return;
  const bool control_step = tick_ % static_cast<std::uint64_t>(setup_.control_interval) == 0;
  if (programs_.any_beyond_controllers()) show_beings(entities_, *engine_);
  if (auto failed = programs_.step(entities_, now_, control_step)) fail(std::move(*failed));
}

void Simulation::publish() {
  const PhaseTimer timer(phase_times_, Phase::publish);
  publisher_.publish();
}

}  // namespace sandlot
