#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "messages/geometry_msgs.h"
#include "messages/std_msgs.h"
#include "sim/world/faults.h"
#include "sim/world/simulation.h"

namespace sandlot {

std::uint64_t Simulation::submit(Request request, Source source) {
  const std::lock_guard lock(inbox_mutex_);
  inbox_.push_back({source, next_sequence_, std::move(request)});
  return next_sequence_++;
}

LogEntry& Simulation::log_entry(std::uint8_t kind, const Source& source, std::uint64_t sequence) {
  if (spare_log_.empty()) spare_log_.emplace_back();
  LogEntry& entry = log_.emplace_back(std::move(spare_log_.back()));
  spare_log_.pop_back();
  entry.kind = kind;
  entry.source = source;
  entry.sequence = sequence;
  entry.target.clear();
  entry.type.clear();
  entry.bytes.clear();
  entry.refused = false;
  entry.why.clear();
  return entry;
}

void Simulation::log_request(const Request& request, const Outcome& outcome) {
  LogEntry& entry = log_entry(static_cast<std::uint8_t>(request.index()), outcome.source, outcome.sequence);
  entry.target = request_target(request);
  entry.refused = !outcome.status;
  if (entry.refused) entry.why = outcome.status.error().text();
  if (const auto* command = std::get_if<CommandRequest>(&request)) {
    entry.type = command->type;
    entry.bytes = command->bytes;
  } else {
    ByteWriter w;
    write_request(w, request);
    entry.bytes = std::move(w.buffer());
  }
}

Status Simulation::carry_out(Request& request, const Source& source) {
  if (const auto* command = std::get_if<CommandRequest>(&request)) return apply_command(*command, source);
  if (const auto* parameter = std::get_if<ParameterRequest>(&request)) {
    if (Device* device = find_device(parameter->target)) {
      if (parameter->field == failure_field) {
        SL_ASSIGN(const FailureOrder order, read_failure_order(parameter->value));
        Pool& pool = pools_[device->kind];
        return order_failure(*device, *pool.pool, pool.faulty, order);
      }
      SL_TRY(pools_[device->kind].pool->set_parameter(device->index, parameter->field, parameter->value));
      plan_next_sample(*device);
      return {};
    }
    if (ProgramEntry* program = find_program(parameter->target))
      return program->program->set_parameter(parameter->field, parameter->value);
    if (parameter->target == "sim") return set_errors(nullptr, parameter->field, parameter->value);
    if (Entity* const entity = find_entity(parameter->target))
      return set_errors(entity, parameter->field, parameter->value);
    return Error{"there is no device or program '" + parameter->target + "'"};
  }
  if (const auto* level = std::get_if<LevelRequest>(&request)) return set_levels(*level);
  if (auto* spawn = std::get_if<SpawnRequest>(&request)) {
    Diagnostics ignored;
    SL_TRY(add_entity(spawn->instance, ignored));
    ++revision_;
    rebuild_scene();
    rebuild_sight(ignored);
    return {};
  }
  if (const auto* removal = std::get_if<DeleteRequest>(&request)) {
    for (std::size_t i = 0; i < entities_.size(); ++i) {
      if (entities_[i]->instance.name != removal->name) continue;
      remove_entity(i);
      ++revision_;
      rebuild_scene();
      Diagnostics ignored;
      rebuild_sight(ignored);
      return {};
    }
    return Error{"there is nothing named '" + removal->name + "'"};
  }
  if (const auto* pose = std::get_if<PoseRequest>(&request)) {
    const Entity* const entity = find_entity(pose->name);
    if (!entity) return Error{"there is nothing named '" + pose->name + "'"};
    if (!is_finite(pose->X_WM) || norm(pose->X_WM.q) < 1e-6) return Error{"the pose is not finite"};
    engine_->set_pose(entity->id, {pose->X_WM.p, normalised(pose->X_WM.q)});
    if (entity->instance.model->is_static) ++revision_;  // viewers and /tf_static are told of it once
    return {};
  }
  if (const auto* pull = std::get_if<PullRequest>(&request)) return start_pull(*pull);
  if (const auto* load = std::get_if<LoadDeviceRequest>(&request)) return mount_device(*load);
  if (const auto* unload = std::get_if<UnloadDeviceRequest>(&request)) return unmount_device(*unload);
  const auto& sample = std::get<SampleRequest>(request);
  Device* const device = find_device(sample.device);
  if (!device) return Error{"there is no device '" + sample.device + "'"};
  pools_[device->kind].timing[device->index].requested = true;
  return {};
}

Status Simulation::start_pull(const PullRequest& request) {
  const Entity* const entity = find_entity(request.name);
  if (!entity) return Error{"there is nothing named '" + request.name + "'"};
  const model::Model& model = *entity->instance.model;
  std::erase_if(pulls_, [&](const Pull& pull) { return pull.serial == entity->serial; });
  if (request.hold <= Time{}) return {};
  if (model.is_static || entity->instance.motion)
    return Error{"'" + request.name + "' cannot be moved by forces"};
  const auto link = request.link.empty() ? std::optional<std::uint32_t>(0) : model.find_link(request.link);
  if (!link) {
    std::vector<std::string> known;
    for (const model::Link& each : model.links) known.push_back(each.name);
    return Error{"'" + request.name + "' has no link '" + request.link + "'",
                 suggestion(request.link, known)};
  }
  if (!is_finite(request.point_L) || !is_finite(request.target_W) || norm(request.point_L) > 1e6 ||
      norm(request.target_W) > 1e6)
    return Error{"the pull is not finite"};
  if (request.hold > Time::from_s(longest_pull_s))
    return Error{"a pull lasts " + number_text(longest_pull_s) + " s at most", "ask again before it ends"};
  pulls_.push_back({entity->serial, *link, request.point_L, request.target_W, now_ + request.hold});
  return {};
}

Simulation::Slot* Simulation::active_command_slot(Device& device, std::string_view type,
                                                  std::string_view level) {
  const auto& levels = pools_[device.kind].kind->levels;
  for (Slot& slot : device.commands) {
    if (type != slot.topic->type()) continue;
    const bool always = slot.level >= levels.size();
    if (!level.empty() && (always || level != levels[slot.level].name)) continue;
    if (always || (device.levels >> slot.level & 1)) return &slot;
  }
  return nullptr;
}

namespace {

/// A velocity or a single number has no "leave that as it is", as NaN is in a list of joints: it asks for what nobody can do,
/// and would stay in the state and in its snapshots.
template <class Message>
bool is_finite_message(std::span<const std::byte> bytes) {
  static_assert(sizeof(Message) % sizeof(double) == 0);
  ByteReader r(bytes);
  for (std::size_t i = 0; i < sizeof(Message) / sizeof(double); ++i) {
    double x = 0;
    read(r, x);
    if (r.ok() && !std::isfinite(x)) return false;
  }
  return true;
}

}  // namespace

Status Simulation::give_command(Slot& slot, std::span<const std::byte> bytes) {
  const TopicBase* const topic = slot.topic.get();
  if ((topic_cast<msg::Twist>(topic) && !is_finite_message<msg::Twist>(bytes)) ||
      (topic_cast<msg::Float64>(topic) && !is_finite_message<msg::Float64>(bytes)))
    return Error{"the command is not finite", "numbers; what is to stay as it is needs no command"};
  if (!slot.topic->assign(bytes)) return Error{"the bytes are no " + std::string(slot.topic->type())};
  slot.topic->stamp = now_;
  ++slot.topic->count;
  return {};
}

/// Whoever drives a device from outside is not disturbed by the robot's controllers for a while.
bool Simulation::is_held(const Device& device) const {
  return std::any_of(holds_.begin(), holds_.end(),
                     [&](const Hold& hold) { return hold.device == device.key; });
}

void Simulation::hold(const Device& device) {
  std::erase_if(holds_, [&](const Hold& hold) { return hold.device == device.key; });
  holds_.push_back({device.key, now_ + Time::from_s(held_s)});
}

Status Simulation::apply_command(const CommandRequest& command, const Source& source) {
  const std::string_view target = command.target;
  Device* device = find_device(target);
  std::string_view level;
  if (!device) {
    if (const std::size_t slash = target.rfind('/'); slash != std::string_view::npos) {
      device = find_device(target.substr(0, slash));
      level = target.substr(slash + 1);
    }
  }
  if (!device) return ++refused_commands_, Error{"there is no device '" + command.target + "'"};
  Slot* const slot = active_command_slot(*device, command.type, level);
  if (!slot) {
    ++refused_commands_;
    return Error{"'" + command.target + "' takes no " + command.type + " at its active level"};
  }
  const bool by_program = source.kind == Source::Kind::program;
  Status status = by_program && is_held(*device) ? Error{"'" + command.target + "' is driven from outside"}
                  : !takes_commands(*device)     ? Error{"'" + command.target + "' has failed"}
                                                 : give_command(*slot, command.bytes);
  if (!status) ++refused_commands_;
  else if (!by_program) hold(*device);
  return status;
}

void Simulation::apply_program_orders() {
  if (!options_.run_programs)
    return;  // a snapshot may hold orders; the log that drives this run has them too
  gather_programs();
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    ProgramEntry& program = *programs_[i];
    // Programs lie all over the memory; see control().
    if (i + 16 < programs_.size()) {
      __builtin_prefetch(&programs_[i + 16]->routes);
      __builtin_prefetch(&programs_[i + 16]->command);
      const ProgramEntry& next = *programs_[i + 8];
      __builtin_prefetch(next.routes.data());
      __builtin_prefetch(next.command.orders().data());
    }
    for (const Command::Order& order : program.command.orders()) {
      const Route& route = program.routes[order.slot];
      const bool taken = route.slot && (holds_.empty() || !is_held(*route.device)) &&
                         takes_commands(*route.device);
      Slot* const slot = taken ? route.slot : nullptr;
      const std::span<const std::byte> bytes = program.command.bytes(order);
      // A level that was switched off under a controller's feet, a device that somebody drives by hand: its commands
      // are refused and counted.
      const bool refused = !slot || !give_command(*slot, bytes);
      if (refused) ++refused_commands_;
      if (!wants_.log) continue;
      const Entity& entity = *owners_[i];
      const Description::Entry& entry = program.description->actuators[order.slot];
      LogEntry& logged = log_entry(LogEntry::command, {Source::Kind::program, entity.serial}, program.steps);
      logged.target.append(entity.instance.name).append("/").append(sanitised(entry.device));
      if (!entry.level.empty()) logged.target.append("/").append(entry.level);
      logged.type = entry.type;
      logged.bytes.assign(bytes.begin(), bytes.end());
      logged.refused = refused;
    }
    program.command.clear();
  }
}

Status Simulation::set_levels(const LevelRequest& request) {
  Device* const device = find_device(request.device);
  if (!device) return Error{"there is no device '" + request.device + "'"};
  Pool& pool = pools_[device->kind];
  std::vector<std::string> known;
  for (const LevelInfo& level : pool.kind->levels) known.emplace_back(level.name);
  std::uint32_t bits = 0;
  for (const std::string& name : request.levels) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      return Error{"device '" + request.device + "' has no level '" + name + "'", suggestion(name, known)};
    bits |= 1u << (found - known.begin());
  }
  if (bits == 0) return Error{"a device needs at least one active level", suggestion("", known)};
  SL_TRY(pool.pool->switch_level(device->index, device->levels, bits, context()));
  set_active_levels(*device, bits);
  ++revision_;
  point_programs_at_active_levels(
      *find_entity(std::string_view(request.device).substr(0, request.device.find('/'))));
  return {};
}

}  // namespace sandlot
