#include "sandlot/embed.h"

#include "base/log.h"
#include "base/text.h"
#include "record/playback.h"
#include "sim/world/lookup.h"

namespace sandlot {
namespace {

/// Logs warnings for callers that do not take them.
class Warnings {
 public:
  explicit Warnings(Diagnostics* asked_for) : asked_for_(asked_for) {}
  ~Warnings() {
    for (const Error& warning : own_.warnings) log::warning(warning.text());
  }
  Warnings(const Warnings&) = delete;
  Warnings& operator=(const Warnings&) = delete;
  Diagnostics& get() { return asked_for_ ? *asked_for_ : own_; }

 private:
  Diagnostics* asked_for_;
  Diagnostics own_;
};

/// The part of "rover/laser/ranges" that names a device, and the level that it may name after it.
std::pair<std::string_view, std::string_view> split_level(std::string_view name) {
  const std::size_t first = name.find('/');
  const std::size_t second = first == std::string_view::npos ? first : name.find('/', first + 1);
  if (second == std::string_view::npos) return {name, {}};
  return {name.substr(0, second), name.substr(second + 1)};
}

Error no_slot(std::string_view device, const char* verb, const char* type,
              const std::vector<Simulation::Slot>& slots) {
  std::vector<std::string> types;
  for (const Simulation::Slot& slot : slots) types.emplace_back(slot.topic->type());
  return {"'" + std::string(device) + "' " + verb + " no " + type,
          types.empty() ? "" : suggestion("", types)};
}

}  // namespace

Result<std::unique_ptr<Simulation>> load_simulation(const std::string& file, const EmbedOptions& options,
                                                    Diagnostics* diagnostics) {
  Warnings warnings(diagnostics);
  SL_ASSIGN(model::Setup setup, record::load_with_playbacks(file, options.load, warnings.get()));
  return Simulation::create(std::move(setup), options.simulation, warnings.get());
}

Result<std::unique_ptr<Simulation>> load_simulation_text(const std::string& yaml, const std::string& name,
                                                         const EmbedOptions& options,
                                                         Diagnostics* diagnostics) {
  EmbedOptions with_text = options;
  with_text.load.text = yaml;
  return load_simulation(name, with_text, diagnostics);
}

Result<std::unique_ptr<Simulation>> restore_simulation(std::span<const std::byte> snapshot,
                                                       const SimulationOptions& options,
                                                       Diagnostics* diagnostics) {
  Warnings warnings(diagnostics);
  return Simulation::restore(snapshot, options, warnings.get());
}

Result<const TopicBase*> find_reading(const Simulation& sim, std::string_view name, const char* type) {
  // A topic of a program: "rover/estimator/estimate".
  if (const TopicBase* const topic = sim.find_topic(name);
      topic && topic->name() == "/" + std::string(name) && std::string_view(topic->type()) == type)
    return topic;
  const auto [path, level] = split_level(name);
  SL_ASSIGN(const Simulation::Device* const device, device_named(sim, path));
  const TopicBase* found = nullptr;
  for (const Simulation::Slot& slot : device->topics) {
    if (std::string_view(slot.topic->type()) != type) continue;
    if (!level.empty()) {
      if (slot.topic->name() == "/" + std::string(name)) return slot.topic.get();
      continue;
    }
    const bool active = slot.level < 32 && (device->levels >> slot.level & 1) != 0;
    if (active) return slot.topic.get();
    if (!found) found = slot.topic.get();
  }
  if (found) return found;
  return no_slot(name, "publishes", type, device->topics);
}

Status check_commandable(const Simulation& sim, std::string_view name, const char* type) {
  SL_ASSIGN(const Simulation::Device* const device, device_named(sim, split_level(name).first));
  for (const Simulation::Slot& slot : device->commands)
    if (std::string_view(slot.topic->type()) == type) return {};
  return no_slot(name, "takes", type, device->commands);
}

Status check_callable(const Simulation& sim, std::string_view device, std::string_view service,
                      const char* type) {
  SL_ASSIGN(const Simulation::Device* const found, device_named(sim, device));
  SL_ASSIGN(const DeviceService* const offered, service_of(sim.kind(*found), device, service));
  if (std::string_view(offered->type) == type) return {};
  return Error{"service '" + std::string(service) + "' of '" + std::string(device) + "' is of type " +
               offered->type + ", not " + type};
}

Result<Pose> pose(const Simulation& sim, std::string_view instance) {
  SL_ASSIGN(const Simulation::Entity* const entity, entity_named(sim, instance));
  return sim.engine().pose(entity->id);
}

}  // namespace sandlot
