#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "assets/image/write.h"
#include "base/text.h"
#include "control/kinds_with.h"
#include "controllers/controllers.h"
#include "model/motion.h"
#include "sim/load/device_settings.h"
#include "sim/load/plugin.h"
#include "sim/load/presets.h"
#include "sim/visuals/render_scene.h"
#include "sim/watch/monitor.h"
#include "sim/world/faults.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// Collects what a device creates while it is built.
struct SlotMaker final : TopicMaker {
  std::vector<Simulation::Slot> topics, commands;
  std::vector<std::pair<std::string, Pose>> frames;
  void adopt_topic(std::unique_ptr<TopicBase> topic, std::uint32_t level) override {
    topics.push_back({std::move(topic), level});
  }
  void adopt_command(std::unique_ptr<TopicBase> slot, std::uint32_t level) override {
    commands.push_back({std::move(slot), level});
  }
  void adopt_frame(std::string name, const Pose& X_SF) override {
    frames.emplace_back(std::move(name), X_SF);
  }
};

/// Levels named by `level: x` or `levels: [x, y]`; both keys belong to the simulator, not to the kind's spec.
Result<std::uint32_t> take_levels(Node& config, const Kind& kind, const Place& place) {
  std::vector<std::string> known;
  for (const LevelInfo& level : kind.levels) known.emplace_back(level.name);
  const Node* one = config.find("level");
  const Node* many = config.find("levels");
  if (one && many) return one->error("give either 'level' or 'levels'");
  if (many && (!many->is_sequence() || many->items().empty()))
    return wrong_type(*many, "a list of levels", "/levels");
  std::uint32_t bits = many || one ? 0u : 1u;
  const auto take = [&](const Node& node, const std::string& path) -> Status {
    const Place& at = node.place().file ? node.place() : place;
    if (!node.is_scalar())
      return Error{"expected the name of a level", "several levels at once: levels: [a, b]", at, path};
    const auto found = std::find(known.begin(), known.end(), node.text());
    if (found == known.end())
      return Error{"device kind '" + std::string(kind.name) + "' has no level '" + node.text() + "'",
                   suggestion(node.text(), known), at, path};
    const std::uint32_t bit = 1u << (found - known.begin());
    if (bits & bit) return Error{"level '" + node.text() + "' is named twice", "", at, path};
    bits |= bit;
    return {};
  };
  if (one) SL_TRY(take(*one, "/level"));
  for (std::size_t i = 0; many && i < many->items().size(); ++i)
    SL_TRY(take(many->items()[i], "/levels/" + std::to_string(i)));
  config.erase("level");
  config.erase("levels");
  return bits;
}

std::string encode_image(int width, int height, int channels, std::span<const std::uint8_t> pixels,
                         int quality) {
  const assets::Pixels8 image{width, height, channels, pixels};
  return quality > 0 ? assets::jpeg_of(image, quality) : assets::png_of(image);
}

/// What a topic is called behind its device's path: "right/image".
std::string_view part_of(const Simulation::Device& device, const TopicBase& topic) {
  return std::string_view(topic.name()).substr(device.path.size() + 2);
}

}  // namespace

Simulation::Simulation(model::Setup setup, const SimulationOptions& options)
    : setup_(std::move(setup)), options_(options), monitor_(std::make_unique<Monitor>(*this)) {
  const int available = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int threads = options.threads > 0 ? options.threads : available;
  // TBB caps its workers at the number of cores unless told otherwise; with it a run in more threads than cores
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
  SL_TRY(sim->build(diagnostics));
  // Tick 0: nothing has moved yet, but sensors whose first sample is due now take it and programs see it.
  sim->arena_->execute([&] {
    sim->update_scene();
    sim->sense();
    sim->deliver_media();
    sim->judge();
    sim->control();
  });
  return sim;
}

Status Simulation::build(Diagnostics& diagnostics) {
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
  if (const RayCaster* rays = engine_->rays()) {
    rays_ = rays;
  } else {
    scene_ = std::make_unique<RayScene>();
    rays_ = scene_.get();
  }
  const auto add_pool = [&](const Kind* device_kind) {
    SL_CHECK(device_kind->api_version == device_api_version);
    pools_.push_back({device_kind, device_kind->create_pool(), {}, {}, {}, {}, {}, {}, {}});
  };
  for (const Kind* const device_kind : device_kinds()) add_pool(device_kind);
  for (const Kind* const device_kind : options_.extra_kinds) add_pool(device_kind);
  SL_TRY(gather_controllers(diagnostics));
  set_stop(setup_.stop);
  // The instances live in the entities from here on; one copy is enough.
  for (model::Instance& instance : std::exchange(setup_.instances, {}))
    SL_TRY(add_entity(std::move(instance), diagnostics));
  rebuild_scene();
  rebuild_sight(diagnostics);
  SL_TRY(monitor_->add(setup_.values, setup_.events, setup_.addresses));
  return {};
}

Status Simulation::add_event(model::EventDecl decl) {
  SL_TRY(monitor_->add_event(std::move(decl), false, {}));
  judge();
  return status_;
}

/// The kinds that `controller:` may name: ours, the program's own, then those of the plugins.
Status Simulation::gather_controllers(Diagnostics& diagnostics) {
  std::map<std::string, std::string, std::less<>> owners;
  const auto add = [&](const ControllerKind* kind, const std::string& owner, const Place& place) -> Status {
    const auto [known, fresh] = owners.emplace(kind->name, owner);
    if (!fresh)
      return Error{owner + " brings a controller '" + kind->name + "', and so does " + known->second,
                   "give it another name", place, "/plugins"};
    controller_kinds_.push_back(kind);
    return {};
  };
  for (const ControllerKind* kind : sandlot::controller_kinds()) SL_TRY(add(kind, "Sandlot", {}));
  for (const ControllerKind* kind : options_.extra_controllers) SL_TRY(add(kind, "this program", {}));
  for (model::PluginDecl& decl : setup_.plugins) {
    SL_ASSIGN(const Plugin* const plugin, load_plugin(decl, options_.paths, diagnostics));
    decl = {plugin->file, plugin->name, plugin->hash, decl.place};
    for (const ControllerKind* kind : plugin->controllers)
      SL_TRY(add(kind, "plugin '" + plugin->file + "'", decl.place));
  }
  return {};
}

void Simulation::set_stop(std::optional<Time> stop) {
  setup_.stop = stop;
  stop_reason_.reset();
  std::erase_if(rules_, [](const auto& rule) { return dynamic_cast<StopAfter*>(rule.get()) != nullptr; });
  if (stop) rules_.insert(rules_.begin(), std::make_unique<StopAfter>(*stop));
}

Status Simulation::add_entity(model::Instance instance, Diagnostics& diagnostics) {
  if (find_entity(instance.name))
    return Error{"there are two things named '" + instance.name + "'", "give one of them another name",
                 instance.place};
  const Pose X_WM = instance.X_WM;
  if (instance.motion) instance.X_WM = model::pose_at(*instance.motion, now_.s());
  auto id = engine_->add(instance);
  instance.X_WM = X_WM;
  if (!id) {
    if (!id.error().place.file) id.error().place = instance.place;
    return std::move(id.error());
  }
  auto entity = std::make_unique<Entity>();
  entity->instance = std::move(instance);
  entity->id = *id;
  entity->key = entity_key(entity->instance.name);
  entity->serial = next_serial_++;
  entities_.push_back(std::move(entity));
  Entity& added = *entities_.back();
  if (added.instance.motion) guided_.push_back(&added);
  by_name_[added.instance.name] = &added;
  Status status;
  for (const model::DeviceDecl& decl : std::as_const(added.instance.devices))
    if (status) status = add_device(added, decl, diagnostics);
  for (std::size_t i = 0; i < added.instance.controllers.size(); ++i)
    if (status) status = add_program(added, added.instance.controllers.share(i));
  if (!status) remove_entity(entities_.size() - 1);
  return status;
}

Status Simulation::add_device(Entity& entity, const model::DeviceDecl& declared, Diagnostics& diagnostics) {
  model::DeviceDecl decl = declared;
  const Kind* kind = nullptr;
  std::vector<std::string> names;
  for (const Pool& pool : pools_) {
    names.emplace_back(pool.kind->name);
    if (decl.kind == pool.kind->name) kind = pool.kind;
  }
  if (!kind) return Error{"no kind of device '" + decl.kind + "'", suggestion(decl.kind, names), decl.place};
  const std::string path = entity.instance.name + "/" + sanitised(decl.name);
  if (find_device(path))
    return Error{"robot '" + entity.instance.name + "' has two devices named '" + decl.name + "'",
                 "give one of them another name", decl.place};
  SL_TRY(lay_preset(decl.config, *kind));
  SL_ASSIGN(const std::uint32_t levels, take_levels(decl.config, *kind, decl.place));
  const auto pool = std::find_if(pools_.begin(), pools_.end(), [&](const Pool& p) { return p.kind == kind; });
  SL_CHECK(pool != pools_.end());
  SL_ASSIGN(std::shared_ptr<Faults> faults, take_faults(decl.config, *pool->pool, kind->name));

  SlotMaker maker;
  const DeviceBuild build{decl,
                          entity.instance,
                          path,
                          entity_key(path),
                          setup_.seed,
                          engine_->bodies(entity.id),
                          engine_->joints(entity.id),
                          engine_->capabilities(),
                          setup_.step,
                          levels,
                          maker,
                          setup_.gravity,
                          setup_.geography,
                          setup_.magnetic_field_T,
                          setup_.errors * entity.instance.errors,
                          encode_image};
  SL_TRY(pool->pool->add(build));
  const auto index = static_cast<std::uint32_t>(pool->devices.size());
  if (Status fits = faults ? faults->check(maker.topics) : Status(); !fits) {
    pool->pool->remove(index);
    return fits;
  }
  const double rate_hz = pool->pool->rate_hz(index);
  const double tick_hz = 1e9 / static_cast<double>(setup_.step.ns);
  const bool fixed = setup_.clock.mode == model::Clock::Mode::fixed;
  if (fixed && rate_hz > tick_hz * (1 + 1e-9)) {
    pool->pool->remove(index);
    const Node* const rate = decl.config.find("rate");
    return Error{
        "rate " + number_text(rate_hz) + " Hz is above the tick rate of " + number_text(tick_hz) + " Hz",
        "lower the rate or make time.step smaller", rate && rate->place().file ? rate->place() : decl.place,
        "/" + path + "/rate"};
  }
  if (fixed && rate_hz > 0) {
    const double ticks = tick_hz / rate_hz;
    if (std::abs(ticks - std::round(ticks)) > 1e-6 * ticks)
      diagnostics.warn({"rate " + number_text(rate_hz) + " Hz does not divide the tick rate of " +
                            number_text(tick_hz) + " Hz",
                        "samples fall on the next tick, so their spacing varies by one tick", decl.place,
                        "/" + path + "/rate"});
  }

  const auto alike = [&](const model::DeviceDecl& other) {
    return other.name == decl.name && other.scope == decl.scope && other.sdf_types == decl.sdf_types &&
           other.link == decl.link && other.X_LS == decl.X_LS && other.place.file == decl.place.file &&
           other.place.line == decl.place.line &&
           &other.config.entries() == &std::as_const(decl.config).entries();  // copies of one
  };
  auto device = std::make_unique<Device>(!pool->devices.empty() && alike(pool->devices.back()->decl)
                                             ? pool->devices.back()->shared_decl
                                             : std::make_shared<const model::DeviceDecl>(std::move(decl)));
  device->path = path;
  device->key = build.key;
  device->kind = static_cast<std::uint32_t>(pool - pools_.begin());
  device->index = index;
  device->topics = std::move(maker.topics);
  device->commands = std::move(maker.commands);
  device->frames = std::move(maker.frames);
  device->errors = build.errors;
  device->faults = std::move(faults);
  if (device->faults) ++pool->faulty;
  pool->devices.push_back(device.get());
  pool->all.push_back(index);
  pool->levels.push_back(levels);
  pool->sample.push_back(0);
  pool->since.push_back({});
  pool->timing.push_back({.start = now_});
  set_active_levels(*device, levels);
  plan_next_sample(*device);
  entity.devices.push_back(std::move(device));
  return {};
}

Status Simulation::add_program(Entity& entity, std::shared_ptr<const model::ControllerDecl> declared) {
  SL_ASSIGN(auto program, make_program(entity, declared));
  if (find_device(program->path) || find_program(program->path))
    return Error{"'" + program->path + "' names two things", "give the controller another name",
                 declared->place};
  entity.programs.push_back(std::move(program));
  programs_changed_ = true;
  point_programs_at_active_levels(entity);
  return {};
}

Result<std::unique_ptr<Simulation::ProgramEntry>> Simulation::make_program(
    const Entity& entity, std::shared_ptr<const model::ControllerDecl> declared) {
  const model::ControllerDecl& decl = *declared;
  const auto at = [&](Error error) {
    if (!error.place.file) error.place = decl.place;
    return error;
  };
  const ControllerKind* kind = nullptr;
  std::vector<std::string> names;
  for (const ControllerKind* each : controller_kinds_) {
    names.emplace_back(each->name);
    if (decl.kind == each->name) kind = each;
  }
  if (!kind) return at({"no controller '" + decl.kind + "'", suggestion(decl.kind, names)});
  auto program = std::make_unique<ProgramEntry>(std::move(declared));
  program->path = entity.instance.name + "/" + sanitised(decl.name);
  program->key = entity_key(program->path);

  std::unique_ptr<Controller> controller;
  Status status;
  const auto thrown = caught([&] {
    controller = kind->create();
    program->description = describe(entity);
    if (program->description->robot == entity.instance.name) {
      status = controller->init(*program->description, decl.config);
    } else {
      Description own = *program->description;
      own.robot = entity.instance.name;
      status = controller->init(own, decl.config);
    }
  });
  if (thrown)
    return at({"controller '" + program->path + "' (" + decl.kind + ") threw while it began: " + *thrown});
  if (!status) return at(std::move(status.error()));
  program->kind = kind;
  program->controller = controller.get();
  program->program = std::make_unique<ControllerProgram>(std::move(controller));
  program->topics.resize(program->description->readings.size());
  program->seen.resize(program->description->readings.size(), 0);
  program->routes.resize(program->description->actuators.size());
  return program;
}

/// What programs of a robot may know: the same object as for the robot before it, if they have the same devices.
std::shared_ptr<const Description> Simulation::describe(const Entity& entity) {
  Description description;
  description.robot = entity.instance.name;
  set_kinds_with(kinds_with);
  description.control_period_s = (setup_.step * setup_.control_interval).s();
  const model::Model& model = *entity.instance.model;
  for (const auto& device : entity.devices) {
    const Pose X_BS = inverse(model.links.front().X_ML) * model.links[device->decl.link].X_ML *
                      device->decl.X_LS;
    // One entry per type that follows the device's active level, then one per level.
    const auto describe = [&](const std::vector<Slot>& slots, std::vector<Description::Entry>& entries) {
      std::vector<std::string> types;
      for (const Slot& slot : slots) {
        if (std::find(types.begin(), types.end(), slot.topic->type()) != types.end()) continue;
        types.emplace_back(slot.topic->type());
        entries.push_back(
            {device->decl.name, "", slot.topic->type(), static_cast<std::uint32_t>(entries.size()), X_BS});
      }
      for (const Slot& slot : slots) {
        const auto& levels = pools_[device->kind].kind->levels;
        const std::string level = slot.level < levels.size() ? levels[slot.level].name : "";
        if (!level.empty())
          entries.push_back({device->decl.name, level, slot.topic->type(),
                             static_cast<std::uint32_t>(entries.size()), X_BS});
        // Of several of one type at one level, such as the pictures of a pair of eyes, each has its own name, too.
        const auto alike = std::count_if(slots.begin(), slots.end(), [&](const Slot& other) {
          return other.level == slot.level && std::string_view(other.topic->type()) == slot.topic->type();
        });
        if (alike > 1)
          entries.push_back({device->decl.name, std::string(part_of(*device, *slot.topic)),
                             slot.topic->type(), static_cast<std::uint32_t>(entries.size()), X_BS});
      }
    };
    describe(device->topics, description.readings);
    describe(device->commands, description.actuators);
  }
  const auto same = [](const Description::Entry& a, const Description::Entry& b) {
    return a.device == b.device && a.level == b.level && a.type == b.type && a.X_BS == b.X_BS;
  };
  const auto all_same = [&](const std::vector<Description::Entry>& a,
                            const std::vector<Description::Entry>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
  };
  if (!described_ || !all_same(described_->readings, description.readings) ||
      !all_same(described_->actuators, description.actuators))
    described_ = std::make_shared<const Description>(std::move(description));
  return described_;
}

void Simulation::plan_next_sample(const Device& device) {
  Timing& when = pools_[device.kind].timing[device.index];
  when.rate_hz = pools_[device.kind].pool->rate_hz(device.index);
  when.due = when.rate_hz > 0 ? due_time(when.start, static_cast<std::int64_t>(when.sample), when.rate_hz)
                              : Time{};
}

void Simulation::set_active_levels(Device& device, std::uint32_t levels) {
  device.levels = levels;
  pools_[device.kind].levels[device.index] = levels;
}

void Simulation::point_programs_at_active_levels(Entity& entity) {
  for (const auto& program : entity.programs) {
    for (const Description::Entry& entry : program->description->readings) {
      const TopicBase* first = nullptr;
      const TopicBase* chosen = nullptr;
      for (const auto& device : entity.devices) {
        if (device->decl.name != entry.device) continue;
        const auto& levels = pools_[device->kind].kind->levels;
        for (const Slot& slot : device->topics) {
          if (entry.type != slot.topic->type()) continue;
          const bool always = slot.level >= levels.size();
          const bool named = entry.level == part_of(*device, *slot.topic);
          if (!entry.level.empty() && !named && (always || entry.level != levels[slot.level].name)) continue;
          if (!first) first = slot.topic.get();
          if (!chosen && (always || (device->levels >> slot.level & 1))) chosen = slot.topic.get();
        }
      }
      program->topics[entry.index] = chosen ? chosen : first;
    }
    for (const Description::Entry& entry : program->description->actuators) {
      Route& route = program->routes[entry.index];
      route = {};
      for (const auto& device : entity.devices)
        if (device->decl.name == entry.device)
          route = {device.get(), active_command_slot(*device, entry.type, entry.level)};
    }
  }
}

void Simulation::remove_entity(std::size_t index) {
  Entity& entity = *entities_[index];
  // From the back, so that the indices still to be removed stay right.
  for (auto device = entity.devices.rbegin(); device != entity.devices.rend(); ++device)
    remove_from_pool(**device);
  engine_->remove(entity.id);
  by_name_.erase(entity.instance.name);
  std::erase(guided_, &entity);
  std::erase_if(pulls_, [&](const Pull& pull) { return pull.serial == entity.serial; });
  entities_.erase(entities_.begin() + static_cast<std::ptrdiff_t>(index));
  programs_changed_ = true;
}

void Simulation::remove_from_pool(const Device& device) {
  Pool& pool = pools_[device.kind];
  pool.pool->remove(device.index);
  pool.devices.erase(pool.devices.begin() + device.index);
  pool.all.pop_back();
  pool.timing.erase(pool.timing.begin() + device.index);
  pool.levels.erase(pool.levels.begin() + device.index);
  pool.sample.pop_back();
  pool.since.pop_back();
  if (device.faults) --pool.faulty;
  for (std::uint32_t i = device.index; i < pool.devices.size(); ++i) pool.devices[i]->index = i;
}

Simulation::Entity* Simulation::find_entity(std::string_view name) {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : found->second;
}

const Simulation::Entity* Simulation::find_entity(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : found->second;
}

Simulation::Device* Simulation::find_device(std::string_view path) {
  Entity* const entity = find_entity(path.substr(0, path.find('/')));
  if (!entity) return nullptr;
  for (const auto& device : entity->devices)
    if (device->path == path) return device.get();
  return nullptr;
}

Simulation::ProgramEntry* Simulation::find_program(std::string_view path) {
  Entity* const entity = find_entity(path.substr(0, path.find('/')));
  if (!entity) return nullptr;
  for (const auto& program : entity->programs)
    if (program->path == path) return program.get();
  return nullptr;
}

std::optional<InstanceId> Simulation::find_instance(std::string_view name) const {
  const Entity* const entity = find_entity(name);
  return entity ? std::optional(entity->id) : std::nullopt;
}

const TopicBase* Simulation::find_topic(std::string_view name) const {
  const std::size_t begin = name.substr(0, 1) == "/" ? 1 : 0;
  const Entity* const entity = find_entity(name.substr(begin, name.find('/', begin) - begin));
  if (!entity) return nullptr;
  for (const auto& device : entity->devices)
    for (const Slot& slot : device->topics)
      if (slot.topic->name() == name || device->path == name) return slot.topic.get();
  return nullptr;
}

TopicBase* Simulation::find_command(std::string_view name) const {
  const std::size_t begin = name.substr(0, 1) == "/" ? 1 : 0;
  const Entity* const entity = find_entity(name.substr(begin, name.find('/', begin) - begin));
  if (!entity) return nullptr;
  for (const auto& device : entity->devices)
    for (const Slot& slot : device->commands)
      if (slot.topic->name() == name) return takes_commands(*device) ? slot.topic.get() : nullptr;
  return nullptr;
}

std::vector<const TopicBase*> Simulation::topics() const {
  std::vector<const TopicBase*> all;
  for (const auto& entity : entities_)
    for (const auto& device : entity->devices)
      for (const Slot& slot : device->topics) all.push_back(slot.topic.get());
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
      const Kind& kind = *pools_[device->kind].kind;
      DeviceView view{device->path, kind.name, {}, {}, {}};
      for (std::size_t level = 0; level < kind.levels.size(); ++level)
        if (device->levels >> level & 1) view.active_levels.emplace_back(kind.levels[level].name);
      for (const Slot& slot : device->topics) view.topics.push_back(slot.topic.get());
      for (const Slot& slot : device->commands) view.commands.push_back(slot.topic.get());
      views.push_back(std::move(view));
    }
  }
  return views;
}

void Simulation::rebuild_scene() {
  if (!scene_) return;
  std::vector<SceneShape> shapes;
  scene_frame_.X_WG.assign(engine_->states().size(), Pose{});
  for (const auto& entity : entities_) {
    const model::Model& model = *entity->instance.model;
    const auto bodies = engine_->bodies(entity->id);
    for (std::size_t link = 0; link < model.links.size(); ++link)
      for (const model::Collision& collision : model.links[link].collisions)
        shapes.push_back({bodies[link].index, collision.X_LC, collision.shape, bodies[link].index,
                          !model.is_static || entity->instance.motion.has_value()});
  }
  scene_->set_shapes(shapes);
  scene_frame_.revision = revision_;
}

/// Nothing to do as long as nobody sees.
void Simulation::rebuild_sight(Diagnostics& diagnostics) {
  const bool seen = std::any_of(pools_.begin(), pools_.end(), [](const Pool& pool) {
    return pool.kind->needs_render_scene && !pool.devices.empty();
  });
  if (!render_scene_ && !seen) return;
  if (!render_scene_) render_scene_ = std::make_unique<RenderScene>();
  render_scene_->rebuild(entities_, *engine_, setup_, diagnostics);
}

RenderScene& Simulation::render_scene() {
  if (!render_scene_) {
    Diagnostics ignored;
    render_scene_ = std::make_unique<RenderScene>();
    render_scene_->rebuild(entities_, *engine_, setup_, ignored);
  }
  render_scene_->update(*engine_, tick_, revision_);
  return *render_scene_;
}

}  // namespace sandlot
