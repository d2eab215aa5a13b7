#include "server/clients/inventory.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/text.h"
#include "messages/command.h"
#include "messages/sensor_images.h"
#include "server/clients/preview.h"
#include "sim/world/controllers.h"

namespace sandlot::server {
namespace {

/// A swarm has ten thousand: their services would be most of what a client is told.
constexpr std::ptrdiff_t most_managed_robots = 200;

bool is_drive(const Inventory::Slot& slot) { return slot.active && standstill(slot.info->name).has_value(); }

std::string kind_name(const Simulation& simulation, const Simulation::Device& device, std::uint32_t level) {
  const auto levels = simulation.kind(device).levels;
  return level < levels.size() ? levels[level].name : "";
}

/// What a device has for an entry of a program's description: at its active level where the entry names none.
template <class Slots>
void add_name(const Simulation& simulation, const Simulation::Entity& entity, const Description::Entry& entry,
              Slots slots, std::vector<std::string>& out) {
  if (!entry.level.empty()) return;  // the description lists each level too
  if (entry.program) return out.push_back("/" + entity.instance.name + "/" + entry.device);
  for (const auto& device : entity.devices) {
    if (device->decl.name != entry.device) continue;
    for (const Simulation::Slot& slot : slots(*device)) {
      const bool always = slot.level >= simulation.kind(*device).levels.size();
      if (entry.type == slot.topic->type() && (always || (device->levels >> slot.level & 1)))
        return out.push_back(slot.topic->name());
    }
  }
}

}  // namespace

std::shared_ptr<const Inventory> take_inventory(const Simulation& simulation, std::uint64_t epoch) {
  auto out = std::make_shared<Inventory>();
  out->epoch = epoch;
  out->revision = simulation.revision();
  out->sharing = simulation.setup().sharing;
  std::map<std::string_view, std::shared_ptr<const TopicBase>> blanks;
  const auto add_published = [&](const Simulation::ProgramEntries& programs) {
    for (const auto& program : programs)
      if (program->outputs)
        for (const Outputs::Output& output : program->outputs->all())
          out->topics.push_back({output.topic->name(), &output.topic->info(), program->path});
  };
  const auto& all = simulation.entities();
  const bool managed = std::count_if(all.begin(), all.end(), [](const auto& each) {
                         return each->instance.is_robot;
                       }) <= most_managed_robots;
  // Several programs may read one topic.
  const auto add_inputs = [&](const Simulation::ProgramEntry& program, std::vector<std::string>& reads) {
    if (!program.outputs) return;
    for (const Outputs::Input& input : std::as_const(*program.outputs).inputs()) {
      const std::string& name = input.topic->name();
      reads.push_back(name);
      const bool known = std::any_of(out->slots.begin(), out->slots.end(), [&](const Inventory::Slot& slot) {
        return slot.of_program && slot.name == name && slot.info == &input.topic->info();
      });
      auto& blank = blanks[input.topic->type()];
      if (!blank) blank = input.topic->clone();
      if (!known) out->slots.push_back({name, name.substr(1), "", true, &input.topic->info(), blank, true});
    }
  };
  for (const auto& entity : simulation.entities()) {
    if (entity->instance.is_robot) out->robots.push_back({entity->instance.name, entity->instance.team});
    for (const auto& device : entity->devices) {
      for (const Simulation::Slot& slot : device->topics)
        out->topics.push_back({slot.topic->name(), &slot.topic->info(), device->path});
      for (const Simulation::Slot& slot : device->topics)
        if (topic_cast<msg::Image>(slot.topic.get()) &&
            !simulation.find_topic(preview_name(slot.topic->name())))
          out->topics.push_back(
              {preview_name(slot.topic->name()), &message_info<msg::CompressedImage>(), device->path});
      for (const Simulation::Slot& slot : device->commands) {
        auto& blank = blanks[slot.topic->type()];
        if (!blank) blank = slot.topic->clone();
        const std::string level = kind_name(simulation, *device, slot.level);
        const bool active = level.empty() || (device->levels >> slot.level & 1);
        out->slots.push_back({slot.topic->name(), device->path, level, active, &slot.topic->info(), blank});
      }
    }
    add_published(entity->programs);
    for (const auto& device : entity->devices)
      for (const DeviceService& service : simulation.kind(*device).services)
        out->services.push_back({"/" + device->path + "/" + service.name, device->path, &service});
    if (entity->instance.is_robot && managed) {
      const std::string manager = entity->instance.name + "/" + std::string(controller_manager_name);
      for (const DeviceService& service : controller_services())
        out->services.push_back({"/" + manager + "/" + service.name, manager, &service});
    }
    for (const auto& program : entity->programs) {
      Inventory::Program& made = out->programs.emplace_back();
      made.path = program->path;
      for (const Description::Entry& entry : program->description->readings)
        add_name(
            simulation, *entity, entry, [](const Simulation::Device& d) -> const auto& { return d.topics; },
            made.reads);
      for (const Description::Entry& entry : program->description->actuators)
        add_name(
            simulation, *entity, entry, [](const Simulation::Device& d) -> const auto& { return d.commands; },
            made.orders);
      add_inputs(*program, made.reads);
    }
  }
  for (const WorldElements::Part& part : simulation.elements().parts()) {
    for (const auto& topic : part.topics) out->topics.push_back({topic->name(), &topic->info(), part.path});
    for (const auto& slot : part.commands) {
      const std::string& name = slot->name();  // "/rules/referee/word/command"
      const std::size_t begin = part.path.size() + 2;
      out->slots.push_back(
          {name, part.path, name.substr(begin, name.rfind('/') - begin), true, &slot->info(), slot->clone()});
    }
  }
  for (const Simulation::Team& team : simulation.teams()) {
    add_published(team.programs);
    for (const auto& program : team.programs) {
      Inventory::Program& made = out->programs.emplace_back();
      made.path = program->path;
      add_inputs(*program, made.reads);
      for (const auto& entity : simulation.entities()) {
        if (!entity->instance.is_robot || entity->instance.team != team.decl.name) continue;
        for (const Description& member : program->description->members) {
          if (member.robot != entity->instance.name) continue;
          for (const Description::Entry& entry : member.readings)
            add_name(
                simulation, *entity, entry,
                [](const Simulation::Device& d) -> const auto& { return d.topics; }, made.reads);
          for (const Description::Entry& entry : member.actuators)
            add_name(
                simulation, *entity, entry,
                [](const Simulation::Device& d) -> const auto& { return d.commands; }, made.orders);
        }
      }
    }
  }
  return out;
}

Result<Inventory::Target> Inventory::target(std::string_view topic, std::string_view type,
                                            const std::function<bool(const Slot&)>& visible) const {
  const std::string wanted = type.empty() ? "" : long_name(type);
  if (topic.substr(0, 1) == "/") topic.remove_prefix(1);
  const Slot* of_other_type = nullptr;
  const auto fits = [&](const Slot& slot) {
    if (visible && !visible(slot)) return false;
    if (wanted.empty() || wanted == slot.info->name) return true;
    if (!of_other_type) of_other_type = &slot;
    return false;
  };
  for (const Slot& slot : slots)
    if (std::string_view(slot.name).substr(1) == topic && fits(slot))
      return Target{slot.level.empty() ? slot.device : slot.device + "/" + slot.level, &slot};
  for (const Slot& slot : slots)
    if (slot.device == topic && slot.active && fits(slot)) return Target{slot.device, &slot};
  constexpr std::string_view alias = "/cmd_vel";
  if (topic.size() > alias.size() && topic.substr(topic.size() - alias.size()) == alias) {
    const std::string prefix = std::string(topic.substr(0, topic.size() - alias.size() + 1));
    for (const Slot& slot : slots)
      if (starts_with(slot.device, prefix) && is_drive(slot) && fits(slot)) return Target{slot.device, &slot};
  }
  if (of_other_type)
    return Error{"'" + std::string(topic) + "' takes " + of_other_type->info->name + ", not " + wanted};
  std::vector<std::string> known;
  bool drives = false;
  for (const Slot& slot : slots) {
    if (visible && !visible(slot)) continue;
    known.push_back(slot.name.substr(1));
    if (known.empty() || known.back() != slot.device) known.push_back(slot.device);
    if (is_drive(slot)) {
      known.push_back(std::string(first_part(slot.device)) + "/cmd_vel");
      drives = true;
    }
  }
  // "/goal_pose", or that of another robot, is meant for one that has such a topic.
  const auto last_part = [](std::string_view name) { return name.substr(name.rfind('/') + 1); };
  const auto namesake = std::find_if(known.begin(), known.end(), [&](const std::string& name) {
    return last_part(name) == last_part(topic);
  });
  const std::string near = namesake != known.end() ? *namesake : nearest(topic, known);
  return Error{"nothing takes messages on '/" + std::string(topic.substr(0, 200)) + "'",
               !near.empty() ? "did you mean '/" + near + "'?"
               : drives  ? "robots take them as /ROBOT/cmd_vel, /ROBOT/DEVICE and what their programs read, "
                           "such as /ROBOT/goal_pose"
               : visible ? "a client commands what it has claimed"
                         : "nothing in this world takes commands"};
}

}  // namespace sandlot::server
