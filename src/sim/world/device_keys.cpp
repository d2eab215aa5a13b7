/// Mass, rate limit, delay and command errors of devices.
#include "sim/world/device_keys.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "messages/messages.h"
#include "sim/load/presets.h"

namespace sandlot {
namespace {

/// The part of a slot's name that follows the device: "velocity" of "/robot/motor/velocity/command".
std::string_view part_of(const TopicBase& slot) {
  std::string_view name = slot.name();
  name = name.substr(0, name.rfind('/'));
  return name.substr(name.rfind('/') + 1);
}

/// Quantities that the commands of a slot hold; none: its commands have no errors.
std::span<const Quantity> quantities_of(const TopicBase& slot) {
  static constexpr std::array all{Quantity::linear, Quantity::angular, Quantity::position, Quantity::velocity,
                                  Quantity::effort, Quantity::voltage, Quantity::pwm};
  static_assert(all.size() == quantity_count);
  const std::span<const Quantity> these(all);
  if (slot.queue_limit() > 0) return {};
  if (topic_cast<msg::Twist>(&slot)) return these.first(2);
  if (topic_cast<msg::JointState>(&slot)) return these.subspan(2, 3);
  if (topic_cast<msg::Float64>(&slot))
    for (std::size_t q = 2; q < quantity_count; ++q)
      if (part_of(slot) == quantity_names[q]) return these.subspan(q, 1);
  return {};
}

/// Calls visit(quantity, component, number) for the numbers of a command. @pre quantities_of(slot) are some
template <class Visit>
void for_each_number(TopicBase& slot, Visit&& visit) {
  if (auto* const twist = topic_cast<msg::Twist>(&slot)) {
    visit(Quantity::linear, 0, twist->message.linear.x);
    visit(Quantity::linear, 1, twist->message.linear.y);
    visit(Quantity::angular, 0, twist->message.angular.z);
  } else if (auto* const joints = topic_cast<msg::JointState>(&slot)) {
    const auto all = [&](Quantity q, std::vector<double>& numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i) visit(q, i, numbers[i]);
    };
    all(Quantity::position, joints->message.position);
    all(Quantity::velocity, joints->message.velocity);
    all(Quantity::effort, joints->message.effort);
  } else if (auto* const number = topic_cast<msg::Float64>(&slot)) {
    visit(quantities_of(slot).front(), 0, number->message.data);
  }
}

std::string channel_name(Quantity q, std::size_t component) {
  return std::string(quantity_names[static_cast<std::size_t>(q)]) + "/" + std::to_string(component);
}

std::int64_t period_ns(double rate_hz) { return static_cast<std::int64_t>(std::llround(1e9 / rate_hz)); }

}  // namespace

// ------------------------------------------------------------------------------------------------------------ reading

Result<std::unique_ptr<DeviceKeys>> take_device_keys(Node& config, bool kind_has_errors) {
  auto keys = std::make_unique<DeviceKeys>();
  bool any = false;
  Status status;
  const auto take = [&](const Field& field, auto& member) {
    const Node* const value = config.find(field.key);
    if (!value || !status || (kind_has_errors && std::string_view(field.key) == errors_field.key)) return;
    status = read_value(*value, field, member, std::string("/") + field.key);
    keys->places.emplace_back(field.key, value->place());
    config.erase(field.key);
    any = true;
  };
  DeviceKeysSpec::fields(keys->spec, take);
  if (!status) return std::move(status.error());
  if (!any) return std::unique_ptr<DeviceKeys>();
  return keys;
}

/// Judges the keys about energy.
template <class Report>
Status DeviceKeys::begin_energy(const Device& device, const Kind& kind, Report&& error) const {
  const EnergyMeter::Rates& rates = spec.energy;
  const struct {
    const char* key;
    bool set;
  } keys[] = {{"drain", rates.drain_W > 0},
              {"drain_per_use", rates.per_use_J > 0},
              {"efficiency", rates.efficiency != 1},
              {"rolling_resistance", rates.rolling_resistance > 0}};
  for (const auto& each : keys)
    if (each.set && !device.energy)
      return error(each.key, "the robot of '" + device.path + "' has no battery to draw from",
                   "give it a device of kind battery, or leave " + std::string(each.key) + " out");
  if (!device.energy) return {};
  const EnergyMeter& meter = *device.energy;
  if (rates.per_use_J > 0 && meter.use() == EnergyMeter::Use::nothing)
    return error("drain_per_use", "a " + std::string(kind.name) + " takes neither commands nor samples",
                 "give it a drain");
  if (rates.efficiency != 1 && !meter.moves())
    return error("efficiency",
                 "a " + std::string(kind.name) + " does no work that is drawn by its efficiency",
                 "leave efficiency out");
  if (rates.rolling_resistance > 0 && !meter.rides())
    return error("rolling_resistance", "a " + std::string(kind.name) + " does not drive on rails",
                 "leave rolling_resistance out");
  return {};
}

Status DeviceKeys::begin(Device& device, const Kind& kind, double sample_hz, bool samples, std::size_t joints,
                         std::uint64_t seed) {
  const auto error = [&](const char* key, std::string what, std::string fix) {
    Place place = device.decl.place;
    for (const auto& [name, written] : places)
      if (name == key && written.file) place = written;
    return Error{std::move(what), std::move(fix), place, std::string("/") + key};
  };
  const std::string a_kind = "a " + device.decl.kind;
  levels_ = kind.levels.size();
  if (spec.max_rate_hz > 0 && samples && device.commands.empty() && sample_hz > spec.max_rate_hz * (1 + 1e-9))
    return error(
        "max_rate",
        "rate " + number_text(sample_hz) + " Hz is above max_rate, " + number_text(spec.max_rate_hz) + " Hz",
        "lower the rate, or raise max_rate");
  if (spec.delay_s * sample_hz > static_cast<double>(most_held))
    return error("delay", "more than " + std::to_string(most_held) + " messages would be on their way",
                 "make delay times rate smaller");
  if (spec.delay_s > 0 && device.commands.empty() && device.topics.empty())
    return error("delay", a_kind + " takes no commands and publishes nothing that could be late",
                 "leave delay out");
  if (spec.errors != 1 && !spec.command_errors && spec.delay_s == 0)
    return error("errors", "this " + device.decl.kind + " has no errors that a factor could change",
                 "give it command_errors or a delay, or leave errors out");
  if (spec.on_request && !samples)
    return error("on_request", a_kind + " takes no samples", "leave on_request out");
  SL_TRY(begin_energy(device, kind, error));
  if (device.energy) device.energy->set_rates(spec.energy);
  if (!spec.command_errors) return {};

  std::array<bool, quantity_count> there{};
  ordered_.resize(device.commands.size());
  for (std::size_t i = 0; i < device.commands.size(); ++i) {
    const TopicBase& slot = *device.commands[i].topic;
    const std::span<const Quantity> quantities = quantities_of(slot);
    if (!quantities.empty()) ordered_[i] = slot.clone();
    for (const Quantity q : quantities) there[static_cast<std::size_t>(q)] = true;
  }
  std::vector<std::string> known;
  for (std::size_t q = 0; q < quantity_count; ++q)
    if (there[q]) known.emplace_back(quantity_names[q]);
  if (known.empty())
    return error("command_errors", a_kind + " takes no commands with numbers that could have errors",
                 "leave command_errors out");
  const Stream random(seed, device.key, Purpose::initial, 0);
  for (std::size_t q = 0; q < quantity_count; ++q) {
    const std::vector<StageSpec>& stages = spec.command_errors->of[q].stages;
    if (stages.empty()) continue;
    if (!there[q])
      return error("command_errors",
                   a_kind + " takes no commands of the quantity '" + quantity_names[q] + "'",
                   suggestion(quantity_names[q], known));
    const auto quantity = static_cast<Quantity>(q);
    const std::size_t of_joints = quantity == Quantity::position || quantity == Quantity::velocity ||
                                          quantity == Quantity::effort
                                      ? std::max<std::size_t>(joints, 1)
                                      : 1;
    chains_[q].resize(quantity == Quantity::linear ? 2 : of_joints);
    for (std::size_t i = 0; i < chains_[q].size(); ++i) {
      ChannelChain& chain = chains_[q][i];
      chain.reset(stages, random, "command/" + channel_name(quantity, i));
      // Delays and lags begin at rest, also when the first command comes in the first tick.
      constexpr double no_time_s = 1e-9;
      if (quantity != Quantity::position) chain.corrupt(stages, 0, no_time_s, random.fork(i));
    }
  }
  return {};
}

// ----------------------------------------------------------------------------------------------------------- commands

Status DeviceKeys::take_command(Device& device, std::size_t slot, std::span<const std::byte> bytes, Time now,
                                double all_errors, bool explain) {
  if (spec.max_rate_hz > 0 && state.accepted >= Time{} &&
      (now - state.accepted).ns + 1 < period_ns(spec.max_rate_hz))
    return explain ? Error{"'" + device.path + "' takes at most " + number_text(spec.max_rate_hz) +
                           " commands per second"}
                   : Error{};
  const Time delay = Time::from_s(spec.delay_s * all_errors);
  if (delay <= Time{} && commands_.empty()) {
    if (!explain && is_full(*device.commands[slot].topic)) return Error{};
    return apply(device, slot, bytes, now);
  }
  SL_TRY(device.commands[slot].topic->check(bytes));
  if (!hold(commands_, now + delay, slot, bytes))
    return explain ? Error{"'" + device.path + "' has too many commands on their way"} : Error{};
  return {};
}

Status DeviceKeys::take_request(const Device& device, Time at, Time last, bool first) {
  if (spec.max_rate_hz <= 0 || first || (at - last).ns + 1 >= period_ns(spec.max_rate_hz)) return {};
  count_refused();
  return Error{"'" + device.path + "' takes at most " + number_text(spec.max_rate_hz) +
               " samples per second"};
}

const TopicBase* DeviceKeys::latest_command(const Device& device, std::size_t slot) const {
  const auto held = std::find_if(commands_.rbegin(), commands_.rend(),
                                 [&](const Held& each) { return each.slot == slot; });
  if (held != commands_.rend()) {
    newest_.resize(device.commands.size());
    if (!newest_[slot]) newest_[slot] = device.commands[slot].topic->clone();
    SL_CHECK(newest_[slot]->assign(held->bytes));
    newest_[slot]->stamp = held->due;
    newest_[slot]->count = device.commands[slot].topic->count + 1;
    return newest_[slot].get();
  }
  const TopicBase* const raw = slot < ordered_.size() ? ordered_[slot].get() : nullptr;
  return raw ? raw : device.commands[slot].topic.get();
}

/// Appends to a line; false: no room.
bool DeviceKeys::hold(std::vector<Held>& line, Time due, std::size_t slot, std::span<const std::byte> bytes) {
  if (line.size() >= most_held || held_bytes_ + bytes.size() > most_held_bytes) return false;
  if (spare_.empty()) spare_.emplace_back();
  Held& held = line.emplace_back(std::move(spare_.back()));
  spare_.pop_back();
  held.due = line.size() > 1 ? std::max(due, line[line.size() - 2].due)
                             : due;  // a shorter delay overtakes nothing
  held.slot = static_cast<std::uint32_t>(slot);
  held.bytes.assign(bytes.begin(), bytes.end());
  held_bytes_ += bytes.size();
  return true;
}

void DeviceKeys::drop_first(std::vector<Held>& line) {
  held_bytes_ -= line.front().bytes.size();
  spare_.push_back(std::move(line.front()));
  line.erase(line.begin());
}

/// Puts a command into its slot, or where its errors are computed from.
Status DeviceKeys::apply(Device& device, std::size_t slot, std::span<const std::byte> bytes, Time now) {
  TopicBase* const raw = slot < ordered_.size() ? ordered_[slot].get() : nullptr;
  TopicBase& to = raw ? *raw : *device.commands[slot].topic;
  SL_TRY(to.assign(bytes));
  to.stamp = now;
  ++to.count;
  if (raw) latest_ = static_cast<std::uint32_t>(slot) + 1;
  else if (topic_cast<msg::DriveManeuver>(&to))
    latest_ = 0;  // it ends the command whose errors were computed
  return {};
}

void DeviceKeys::prepare_commands(Device& device, const Turn& turn, bool takes_commands) {
  while (!commands_.empty() && commands_.front().due <= turn.begin) {
    const Held& held = commands_.front();
    Slot& slot = device.commands[held.slot];
    const bool possible = takes_commands && is_active(device, slot) && !is_full(*slot.topic);
    if (!possible || !apply(device, held.slot, held.bytes, turn.begin)) count_refused();
    drop_first(commands_);
  }
  if (spec.command_errors) corrupt_command(device, turn);
}

/// The slot that the latest command belongs into at the levels that are active now. Null: none; it is forgotten then.
DeviceKeys::Slot* DeviceKeys::target_of(Device& device, std::size_t slot) const {
  if (is_active(device, device.commands[slot])) return &device.commands[slot];
  const TopicBase& command = *ordered_[slot];
  for (std::size_t i = 0; i < device.commands.size(); ++i) {
    Slot& other = device.commands[i];
    if (!ordered_[i] || !is_active(device, other) || std::string_view(other.topic->type()) != command.type())
      continue;
    if (std::ranges::equal(quantities_of(*other.topic), quantities_of(command))) return &other;
  }
  return nullptr;
}

/// In every tick the chains see what was commanded, and the device gets what comes out as its command.
void DeviceKeys::corrupt_command(Device& device, const Turn& turn) {
  const Stream random(turn.seed, device.key, Purpose::actuation, turn.tick);
  const double dt_s = turn.length.s();
  const auto out = [&](Quantity quantity, std::size_t component, double number) {
    const auto q = static_cast<std::size_t>(quantity);
    if (component >= chains_[q].size()) return number;
    const double y = chains_[q][component].corrupt(spec.command_errors->of[q].stages, number, dt_s, random,
                                                   turn.errors);
    return std::isfinite(y) ? y : number;
  };
  if (latest_ > 0) {
    const std::size_t given = latest_ - 1;
    if (Slot* const slot = target_of(device, given)) {
      TopicBase& command = *slot->topic;
      const std::uint64_t count = command.count;
      command.copy_from(*ordered_[given]);
      command.count = count + 1;  // a command of this tick
      for_each_number(command,
                      [&](Quantity q, std::size_t i, double& number) { number = out(q, i, number); });
      return;
    }
    latest_ = 0;
  }
  // Nothing is commanded: delays and lags begin at rest.
  for (std::size_t q = 0; q < quantity_count; ++q)
    if (static_cast<Quantity>(q) != Quantity::position)
      for (std::size_t i = 0; i < chains_[q].size(); ++i) (void)out(static_cast<Quantity>(q), i, 0);
}

// ----------------------------------------------------------------------------------------------------------- messages

void DeviceKeys::remember_messages(const Device& device) {
  if (before_.empty())
    for (const Slot& slot : device.topics) before_.push_back(slot.topic->clone());
  for (std::size_t i = 0; i < before_.size(); ++i) before_[i]->copy_from(*device.topics[i].topic);
}

void DeviceKeys::hold_back_messages(Device& device, Time now, double all_errors) {
  const Time due = now + Time::from_s(spec.delay_s * all_errors);
  for (std::size_t i = 0; i < before_.size(); ++i) {
    TopicBase& topic = *device.topics[i].topic;
    if (topic.count == before_[i]->count) continue;
    scratch_.clear();
    topic.save(scratch_);
    if (!hold(messages_, due, i, scratch_.bytes())) count_refused();
    topic.copy_from(*before_[i]);
  }
}

void DeviceKeys::publish_messages(Device& device, Time now, bool dead) {
  while (!messages_.empty() && messages_.front().due <= now) {
    const Held& held = messages_.front();
    TopicBase& topic = *device.topics[held.slot].topic;
    if (!dead) {
      const std::uint64_t count = topic.count;
      ByteReader r(held.bytes);
      topic.load(r);
      SL_CHECK(r.ok());
      topic.stamp = now;
      topic.count = count + 1;
    }
    drop_first(messages_);
  }
}

// -------------------------------------------------------------------------------------------------------------- State

void DeviceKeys::save(const Device& device, ByteWriter& w) const {
  if (device.energy)
    EnergyMeter::Rates::fields(spec.energy, [&](const Field&, const double& number) { write(w, number); });
  write_tunables(w, spec);
  write(w, spec.errors);
  write(w, state);
  for (const auto* const line : {&commands_, &messages_}) {
    write(w, static_cast<std::uint32_t>(line->size()));
    for (const Held& held : *line) {
      write(w, held.due);
      write(w, held.slot);
      write(w, held.bytes);
    }
  }
  if (!spec.command_errors) return;
  write(w, latest_);
  for (const auto& command : ordered_)
    if (command) command->save(w);
  for (const auto& components : chains_)
    for (const ChannelChain& chain : components) write(w, chain);
}

bool DeviceKeys::load_line(std::vector<Held>& line, ByteReader& r, std::size_t slots) {
  std::uint32_t size = 0;
  read(r, size);
  if (!r.ok() || size > most_held) return false;
  line.clear();
  constexpr std::int64_t longest_ns = std::int64_t{1} << 61;
  Time before;
  for (std::uint32_t i = 0; i < size; ++i) {
    Held held;
    read(r, held.due);
    read(r, held.slot);
    read(r, held.bytes);
    held_bytes_ += held.bytes.size();
    if (!r.ok() || held.slot >= slots || held.due < before || held.due.ns > longest_ns ||
        held_bytes_ > most_held_bytes)
      return false;
    before = held.due;
    line.push_back(std::move(held));
  }
  return true;
}

bool DeviceKeys::load(Device& device, ByteReader& r, Time now, const std::function<bool()>& fits) {
  if (device.energy) {
    EnergyMeter::Rates::fields(spec.energy, [&](const Field& field, double& number) {
      read(r, number);
      if (!(number >= field.min && number <= field.max)) r.fail();
    });
    device.energy->set_rates(spec.energy);
  }
  read_tunables(r, spec);
  read(r, spec.errors);
  read(r, state);
  if (!r.ok() || !(spec.errors >= errors_field.min && spec.errors <= errors_field.max) ||
      state.accepted > now || state.accepted < Time{-1})
    return false;
  held_bytes_ = 0;
  if (!load_line(commands_, r, device.commands.size()) || !load_line(messages_, r, device.topics.size()))
    return false;
  for (const Held& held : commands_)
    if (!device.commands[held.slot].topic->check(held.bytes)) return false;
  // A held message becomes the device's own, which may trust its lengths.
  for (const Held& held : messages_) {
    TopicBase& topic = *device.topics[held.slot].topic;
    const auto now_there = topic.clone();
    ByteReader bytes(held.bytes);
    topic.load(bytes);
    const bool sound = bytes.ok() && bytes.remaining() == 0 && fits();
    topic.copy_from(*now_there);
    if (!sound) return false;
  }
  if (!spec.command_errors) return true;
  read(r, latest_);
  for (const auto& command : ordered_) {
    if (!command) continue;
    command->load(r);
    if (!r.ok() || !check_command(command->info(), command->data())) return false;
  }
  if (!r.ok() || latest_ > ordered_.size() || (latest_ > 0 && !ordered_[latest_ - 1])) return false;
  for (auto& components : chains_)
    for (ChannelChain& chain : components) read(r, chain);
  return r.ok();
}

// --------------------------------------------------------------------------------------------------------- parameters

bool is_device_key(std::string_view field, bool kind_has_errors) {
  const std::string_view key = field.substr(0, field.find('/'));
  bool known = false;
  const DeviceKeysSpec any;
  DeviceKeysSpec::fields(any, [&](const Field& each, const auto&) { known = known || key == each.key; });
  return known && !(kind_has_errors && key == errors_field.key);
}

Status set_device_key(SimulationParts::Device& device, std::string_view field, const Node& value) {
  const std::string key(field.substr(0, field.find('/')));
  if (!device.keys)
    return Error{"'" + device.path + "' has no '" + key + "' that could change",
                 "give it to the device in the scenario", value.place()};
  DeviceKeys& keys = *device.keys;
  bool about_energy = false;
  EnergyMeter::Rates::fields(keys.spec.energy,
                             [&](const Field& each, const double&) { about_energy |= key == each.key; });
  if (about_energy && !device.energy)
    return Error{"the robot of '" + device.path + "' has no battery to draw from", "", value.place()};
  DeviceKeysSpec changed = keys.spec;
  SL_TRY(set_tunable(changed, field, value));
  keys.spec = std::move(changed);
  if (device.energy) device.energy->set_rates(keys.spec.energy);
  return {};
}

std::vector<FieldInfo> device_key_fields(const Kind& kind) {
  std::vector<FieldInfo> out;
  const bool takes_commands = std::any_of(kind.levels.begin(), kind.levels.end(),
                                          [](const LevelInfo& level) { return *level.command != '\0'; });
  const std::vector<FieldInfo> own = kind.describe();
  const bool has_errors = std::any_of(own.begin(), own.end(),
                                      [](const FieldInfo& field) { return field.path == errors_field.key; });
  for (FieldInfo& field : describe_fields<DeviceKeysSpec>()) {
    if (!takes_commands && (starts_with(field.path, "command_errors") || field.path == "efficiency" ||
                            field.path == "rolling_resistance"))
      continue;
    if (has_errors && field.path == errors_field.key) continue;
    out.push_back(std::move(field));
  }
  return out;
}

// --------------------------------------------------------------------------------------------------------------- mass

namespace {

/// Adds a point mass at a point of the link.
void add_point_mass(model::Inertial& inertial, double mass_kg, Vec3 point_L) {
  const double sum_kg = inertial.mass_kg + mass_kg;
  const Vec3 centre_L = (inertial.X_LCo.p * inertial.mass_kg + point_L * mass_kg) * (1 / sum_kg);
  const auto add = [&](double m, Vec3 from_L) {  // parallel-axis theorem, in the axes of the tensor
    const Vec3 r = rotate_inverse(normalised(inertial.X_LCo.q), from_L - centre_L);
    inertial.moments += Vec3{r.y * r.y + r.z * r.z, r.x * r.x + r.z * r.z, r.x * r.x + r.y * r.y} * m;
    inertial.products -= Vec3{r.x * r.y, r.x * r.z, r.y * r.z} * m;
  };
  add(inertial.mass_kg, inertial.X_LCo.p);
  add(mass_kg, point_L);
  inertial.X_LCo.p = centre_L;
  inertial.mass_kg = sum_kg;
}

}  // namespace

Result<std::vector<PointMass>> masses_of_devices(
    const model::Instance& instance, const std::function<const Kind*(std::string_view)>& kind_of) {
  std::vector<PointMass> out;
  for (const model::DeviceDecl& decl : instance.devices) {
    if (!decl.config.is_map()) continue;
    Node with_preset;
    const Node* value = decl.config.find("mass");
    if (const Kind* const kind = kind_of(decl.kind); !value && kind && decl.config.find("preset")) {
      with_preset = decl.config;
      SL_TRY(lay_preset(with_preset, *kind));
      value = std::as_const(with_preset).find("mass");
    }
    if (!value) continue;
    DeviceKeysSpec spec;
    Status status;
    DeviceKeysSpec::fields(spec, [&](const Field& field, auto& member) {
      if (std::string_view(field.key) == "mass") status = read_value(*value, field, member, "/mass");
    });
    if (!status) return std::move(status.error());
    if (spec.mass_kg == 0) continue;
    if (instance.model->is_static || instance.motion)
      return value->error("'" + instance.name + "' is not moved by forces, so that a mass has no effect",
                          "leave mass out", "/mass");
    if (decl.link >= instance.model->links.size())
      return Error{"device '" + decl.name + "' is on a link that is not there", "", decl.place};
    out.push_back({decl.link, spec.mass_kg, decl.X_LS.p});
  }
  return out;
}

std::shared_ptr<const model::Model> model_with_masses(const model::Model& model,
                                                      std::span<const PointMass> masses) {
  auto out = std::make_shared<model::Model>(model);
  for (const PointMass& each : masses)
    add_point_mass(out->links[each.link].inertial, each.mass_kg, each.point_L);
  return out;
}

}  // namespace sandlot
