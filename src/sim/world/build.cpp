/// Building a world, its entities, and finding things in it.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>

#include "base/text.h"
#include "model/motion.h"
#include "programs/programs.h"
#include "sim/visuals/ground_paint.h"
#include "sim/visuals/render_scene.h"
#include "sim/watch/monitor.h"
#include "sim/world/simulation.h"

namespace sandlot {

Simulation::Simulation(model::Setup setup, const SimulationOptions& options)
    : setup_(std::move(setup)), options_(options), monitor_(std::make_unique<Monitor>(*this)) {
  const int available = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int threads = options.threads > 0 ? options.threads : available;
  // TBB caps its workers at the number of cores by default; with it a run in more threads than cores
  // would quietly test fewer.
  if (threads > available)
    more_threads_ = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                          static_cast<std::size_t>(threads));
  arena_ = std::make_unique<tbb::task_arena>(threads, 1);
}

Simulation::~Simulation() = default;

Result<std::unique_ptr<Simulation>> Simulation::create(model::Setup setup, const SimulationOptions& options,
                                                       Diagnostics& diagnostics) {
  std::unique_ptr<Simulation> sim(new Simulation(std::move(setup), options));
  SL_TRY(sim->build(diagnostics, false));
  if (options.start_programs && options.run_programs)
    SL_TRY(sim->programs_.connect(sim->entities_, {}, true, false));
  // Tick 0: nothing has moved yet, but sensors whose first sample is due now take it and programs see it.
  sim->arena_->execute([&] {
    sim->update_scene();
    sim->deliver_media();
    sim->sense();
    sim->judge();
    sim->control();
  });
  sim->programs_.await_answers();
  return sim;
}

std::span<const ProgramKind* const> Simulation::program_kinds() const { return sandlot::program_kinds(); }

void Simulation::connect_programs() {
  if (!options_.run_programs) return;
  const Status status = programs_.connect(entities_, now_, options_.start_programs, true);
  SL_CHECK(status);  // of a world that is there all failures are warnings
  programs_.await_answers();
}

Status Simulation::build(Diagnostics& diagnostics, bool restored) {
  if (setup_.step.ns <= 0) return Error{"time.step must be positive"};
  // A forged snapshot or an embedding program may ask for anything.
  if (setup_.substeps < 1) return Error{"time.substeps must be at least 1"};
  if (setup_.control_interval < 1) return Error{"time.control_interval must be at least 1"};
  if (setup_.clock.min_step.ns <= 0 || setup_.clock.max_step < setup_.clock.min_step)
    return Error{"time.min_step must be positive and not above time.max_step"};
  step_ = setup_.step;
  SL_ASSIGN(const EngineKind* const kind, find_engine(setup_.engine));
  SL_ASSIGN(engine_, kind->create(setup_.physics, setup_.gravity));
  engine_->set_zones(setup_.zones);
  engine_->set_contact_rule(options_.contact_rule);
  scenes_.use(*engine_);
  for (const Kind* const device_kind : device_kinds()) devices_.add_kind(*device_kind);
  for (const Kind* const device_kind : options_.extra_kinds) devices_.add_kind(*device_kind);
  SL_TRY(programs_.gather_kinds(setup_.plugins, options_, diagnostics));
  // The instances live in the entities from here on; one copy is enough.
  for (model::Instance& instance : std::exchange(setup_.instances, {}))
    SL_TRY(add_entity(std::move(instance), diagnostics));
  SL_TRY(programs_.add_teams(entities_, now_, diagnostics));
  SL_TRY(elements_.build(options_, restored, setup_.addresses));
  scenes_.paint(ground_paint_of(elements_.markers()));
  scenes_.rebuild(entities_, revision_, devices_.need_render_scene(), diagnostics);
  SL_TRY(monitor_->add(setup_, setup_.addresses));
  elements_.look_up();
  return restored ? Status() : check_sharing();
}

/// That the topics are there which the scenario shares.
Status Simulation::check_sharing() const {
  std::vector<std::string> known;
  for (const model::SharedTopic& shared : setup_.sharing.topics) {
    if (known.empty()) {
      known.assign(std::begin(model::world_topics), std::end(model::world_topics));
      for_each_topic([&](const TopicBase& topic, const std::string&) { known.push_back(topic.name()); });
    }
    // Viewers get a small picture of each image, by a name that nobody publishes.
    constexpr std::string_view preview = "/compressed";
    std::string_view name = shared.pattern;
    if (name.ends_with(preview) && std::find(known.begin(), known.end(), name) == known.end())
      name.remove_suffix(preview.size());
    const model::SharedTopic wanted{std::string(name), {}};
    if (std::none_of(known.begin(), known.end(), [&](const std::string& each) { return wanted.fits(each); }))
      return Error{"there is no topic '" + shared.pattern.substr(0, 200) + "' to share",
                   suggestion(shared.pattern, known), shared.place, "/share/topics"};
  }
  return {};
}

Status Simulation::add_event(model::EventDecl decl) {
  SL_TRY(monitor_->add_event(std::move(decl), false, {}));
  find_stop_reason();
  return status_;
}

void Simulation::set_stop(std::optional<Time> stop) {
  setup_.stop = stop;
  stop_reason_.reset();
}

Status Simulation::add_entity(model::Instance instance, Diagnostics& diagnostics) {
  if (find_entity(instance.name))
    return Error{"there are two things named '" + instance.name + "'", "give one of them another name",
                 instance.place};
  SL_TRY(check_team(instance));
  const Pose X_WM = instance.X_WM;
  if (instance.motion) instance.X_WM = model::pose_at(*instance.motion, now_.s());
  SL_ASSIGN(std::shared_ptr<const model::Model> declared_model, add_masses(instance));
  auto id = engine_->add(instance);
  instance.X_WM = X_WM;
  if (!id) {
    if (!id.error().place.file) id.error().place = instance.place;
    return std::move(id.error());
  }
  auto entity = std::make_unique<Entity>();
  entity->instance = std::move(instance);
  entity->declared_model = std::move(declared_model);
  entity->id = *id;
  entity->key = entity_key(entity->instance.name);
  entity->serial = next_serial_++;
  entities_.push_back(std::move(entity));
  Entity& added = *entities_.back();
  if (added.instance.motion) guided_.push_back(&added);
  by_name_[added.instance.name] = &added;
  elements_.entities_changed();
  Status status = devices_.open_account(added, *engine_);
  for (const model::DeviceDecl& decl : std::as_const(added.instance.devices))
    if (status) status = devices_.add(added, decl, *engine_, now_, diagnostics);
  for (auto& device : added.devices)
    if (status) status = devices_.connect_orders(added, *device, commands_);
  for (std::size_t i = 0; i < added.instance.controllers.size(); ++i)
    if (status) status = programs_.add(added, added.instance.controllers.share(i), now_, diagnostics);
  // Of a world that is being built the teams come last.
  if (status && added.instance.is_robot) status = programs_.describe_team(entities_, added.instance.team);
  if (!status) remove_entity(entities_.size() - 1);
  return status;
}

/// Where there are teams, a robot's is one of them, and nothing else has the name of one.
Status Simulation::check_team(const model::Instance& instance) const {
  if (setup_.teams.empty()) return {};
  std::vector<std::string> names;
  for (const model::TeamDecl& team : setup_.teams) {
    if (team.name == instance.name)
      return Error{"'" + instance.name + "' is the name of a team", "give one of the two another name",
                   instance.place};
    names.push_back(team.name);
  }
  if (instance.team.empty() || std::find(names.begin(), names.end(), instance.team) != names.end()) return {};
  return Error{"'" + instance.name + "' is of team '" + instance.team + "', which is not there",
               suggestion(instance.team, names), instance.place};
}

/// Gives an instance a model with the masses of its devices. Instances declared alike share one.
/// @return the model that was declared; null: the devices have no mass
Result<std::shared_ptr<const model::Model>> Simulation::add_masses(model::Instance& instance) {
  SL_ASSIGN(std::vector<PointMass> masses,
            masses_of_devices(instance, [&](std::string_view name) { return devices_.find_kind(name); }));
  if (masses.empty()) return std::shared_ptr<const model::Model>();
  if (with_masses_.declared != instance.model || with_masses_.masses != masses)
    with_masses_ = {instance.model, model_with_masses(*instance.model, masses), std::move(masses)};
  return std::exchange(instance.model, with_masses_.loaded);
}

void Simulation::remove_entity(std::size_t index) {
  Entity& entity = *entities_[index];
  // From the back, so that the indices still to be removed stay right.
  for (auto device = entity.devices.rbegin(); device != entity.devices.rend(); ++device)
    devices_.remove(**device);
  devices_.close_account(entity);
  engine_->remove(entity.id);
  by_name_.erase(entity.instance.name);
  std::erase(guided_, &entity);
  pulls_.remove(entity);
  entities_.erase(entities_.begin() + static_cast<std::ptrdiff_t>(index));
  programs_.entities_changed();
  elements_.entities_changed();
}

/// After entities came or went while the run goes on.
void Simulation::world_changed() {
  Diagnostics ignored;
  ++revision_;
  scenes_.rebuild(entities_, revision_, devices_.need_render_scene(), ignored);
}

RenderScene& Simulation::render_scene() {
  Diagnostics ignored;
  if (!scenes_.render_scene()) scenes_.rebuild_render_scene(entities_, true, ignored);
  scenes_.render_scene()->update(*engine_, tick_, revision_);
  return *scenes_.render_scene();
}

// -------------------------------------------------------------------------------------------------------- lookups

Simulation::Entity* Simulation::find_entity(std::string_view name) {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : found->second;
}

const Simulation::Entity* Simulation::find_entity(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : found->second;
}

Simulation::Entity& Simulation::entity_of(const Device& device) {
  return *find_entity(first_part(device.path));
}

Simulation::Device* Simulation::find_device(std::string_view path) {
  Entity* const entity = find_entity(first_part(path));
  return entity ? entity->find_device(path) : nullptr;
}

Simulation::ProgramEntry* Simulation::find_program(std::string_view path) {
  const std::string_view owner = first_part(path);
  if (Entity* const entity = find_entity(owner)) return entity->find_program(path);
  if (Team* const team = programs_.find_team(owner))
    for (auto& program : team->programs)
      if (program->path == path) return program.get();
  return nullptr;
}

const Simulation::ProgramEntries* Simulation::programs_of(std::string_view owner) const {
  if (const Entity* const entity = find_entity(owner)) return &entity->programs;
  for (const Team& team : teams())
    if (team.decl.name == owner) return &team.programs;
  return nullptr;
}

bool Simulation::is_taken(std::string_view name) const {
  if (find_entity(name) || commands_.awaits_spawn(name)) return true;
  return std::any_of(setup_.teams.begin(), setup_.teams.end(),
                     [&](const model::TeamDecl& each) { return each.name == name; });
}

std::optional<InstanceId> Simulation::find_instance(std::string_view name) const {
  const Entity* const entity = find_entity(name);
  return entity ? std::optional(entity->id) : std::nullopt;
}

const TopicBase* Simulation::find_topic(std::string_view name) const {
  const std::size_t begin = name.substr(0, 1) == "/" ? 1 : 0;
  const std::string_view owner = name.substr(begin, name.find('/', begin) - begin);
  // The topics of a device are called after it. Rules ask in every tick.
  if (const Entity* const entity = find_entity(owner))
    for (const auto& device : entity->devices)
      if (name.substr(begin).starts_with(device->path))
        for (const Slot& slot : device->topics)
          if (slot.topic->name() == name || device->path == name) return slot.topic.get();
  if (const ProgramEntries* const programs = programs_of(owner))
    for (const auto& program : *programs)
      if (program->outputs)
        for (const Outputs::Output& output : program->outputs->all())
          if (std::string_view(output.topic->name()).substr(1) == name.substr(begin))
            return output.topic.get();
  return elements_.find_own_topic(name);
}

namespace {

/// "rover/camera" of "/rover/camera/image": the device of a topic; a topic of a program has none.
std::string_view device_of(const TopicBase& topic) {
  const std::string_view name = std::string_view(topic.name()).substr(1);
  return name.substr(0, name.find('/', name.find('/') + 1));
}

}  // namespace

std::optional<double> Simulation::look_rate_hz(const TopicBase& topic) const {
  const std::string_view path = device_of(topic);
  const Entity* const entity = find_entity(first_part(path));
  if (!entity) return std::nullopt;
  for (const auto& device : entity->devices)
    if (device->path == path && timing(*device).on_request) return timing(*device).rate_hz;
  return std::nullopt;
}

std::unique_ptr<TopicBase> Simulation::look_through(const TopicBase& topic) {
  Device* const device = find_device(device_of(topic));
  if (!device || !timing(*device).on_request) return nullptr;
  if (kind(*device).needs_render_scene) render_scene();
  return devices_.look_through(*device, topic, context());
}

std::vector<const TopicBase*> Simulation::topics() const {
  std::vector<const TopicBase*> all;
  for_each_topic([&](const TopicBase& topic, const std::string&) { all.push_back(&topic); });
  return all;
}

std::vector<const model::Instance*> Simulation::instances() const {
  std::vector<const model::Instance*> all;
  for (const auto& entity : entities_) all.push_back(&entity->instance);
  return all;
}

std::vector<Simulation::DeviceView> Simulation::devices(std::string_view instance) const {
  std::vector<DeviceView> views;
  for (const auto& entity : entities_) {
    if (entity->instance.name != instance) continue;
    for (const auto& device : entity->devices) {
      const Kind& kind = devices_.kind(*device);
      DeviceView view{device->path, kind.name, {}, {}, {}, {}};
      for (std::size_t level = 0; level < kind.levels.size(); ++level)
        if (device->levels >> level & 1) view.active_levels.emplace_back(kind.levels[level].name);
      for (const Slot& slot : device->topics) view.topics.push_back(slot.topic.get());
      for (const Slot& slot : device->commands) view.commands.push_back(slot.topic.get());
      for (const auto& order : device->orders()) view.orders.push_back(order.get());
      views.push_back(std::move(view));
    }
  }
  return views;
}

}  // namespace sandlot
