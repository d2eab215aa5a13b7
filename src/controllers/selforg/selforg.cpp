#include "controllers/selforg/selforg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/base64.h"
#include "base/text.h"

namespace sandlot::controllers::selforg {
namespace {

constexpr std::string_view twist_components[] = {"linear.x", "linear.y", "angular.z"};

double& component_of(msg::Twist& twist, int component) {
  if (component == 0) return twist.linear.x;
  return component == 1 ? twist.linear.y : twist.angular.z;
}

/// Devices whose names fit a pattern, or the one name.
std::vector<std::string> devices_like(const std::vector<Description::Entry>& entries,
                                      const std::string& pattern) {
  if (pattern.find('*') == std::string::npos) return {pattern};
  std::vector<std::string> names;
  for (const auto& entry : entries)
    if (fits_pattern(entry.device, pattern) &&
        std::find(names.begin(), names.end(), entry.device) == names.end())
      names.push_back(entry.device);
  return names;
}

/// "position[2..4]" as position[2], position[3] and position[4].
std::vector<std::string> spread(const std::string& text) {
  const std::size_t dots = text.find(".."), open = text.rfind('[', dots), close = text.find(']', dots);
  if (dots == std::string::npos || open == std::string::npos || close == std::string::npos) return {text};
  const auto number = [&](std::size_t from, std::size_t to) {
    const std::string digits = text.substr(from, to - from);
    const bool whole = !digits.empty() && digits.size() < 5 &&
                       digits.find_first_not_of("0123456789") == std::string::npos;
    return whole ? std::stoi(digits) : -1;
  };
  const int first = number(open + 1, dots), last = number(dots + 2, close);
  std::vector<std::string> paths;
  if (first < 0 || last < first || last - first > 1000) return {text};
  for (int i = first; i <= last; ++i)
    paths.push_back(text.substr(0, open + 1) + std::to_string(i) + text.substr(close));
  return paths;
}

}  // namespace

Status Place::check(const Node& node, const std::string& path) const {
  if (min < max) return {};
  return node.error(fmt::format("an empty range: min {} is not below max {}", min, max), "", path + "/min");
}

Status SelfOrg::init(const Description& robot, const Node& config, Outputs& out) {
  SL_ASSIGN(spec_, read_spec<Spec>(config));
  robot_ = robot.robot;
  SL_TRY(find_sensors(robot));
  SL_TRY(find_motors(robot));
  x_.assign(sensors_.size(), 0);
  y_.assign(motors_.size(), 0);
  SL_ASSIGN(agent_, make_agent(0));
  SL_TRY(guidance_.init(spec_.guidance, robot, agent_->controller()));
  if (spec_.publish_interval == 0) return {};
  agent_->controller().channels([&](const so::Channel& channel) {
    if (channel.values.size() == 1 && channel.rows == 1 && channel.cols == 1 && channel.name == "t") return;
    Topic& topic = topics_.emplace_back();
    topic.name = channel.name;
    topic.publication = out.publish<msg::Float64MultiArray>(topic.name);
    const auto rows = static_cast<std::uint32_t>(channel.rows),
               cols = static_cast<std::uint32_t>(channel.cols);
    topic.message.layout.dim = {{"rows", rows, rows * cols}, {"columns", cols, cols}};
    topic.message.data.resize(channel.values.size());
  });
  return {};
}

Status SelfOrg::find_sensors(const Description& robot) {
  for (std::size_t i = 0; i < spec_.sensors.size(); ++i) {
    const Place& place = spec_.sensors[i];
    const std::string path = fmt::format("/sensors/{}", i);
    const auto devices = devices_like(robot.readings, place.device);
    if (devices.empty()) return not_there(robot.readings, place.device, path + "/device");
    for (const std::string& device : devices)
      for (const std::string& text : spread(place.value.empty() ? "data" : place.value)) {
        auto value = parse_value_path(text);
        if (!value) return value.error().path = path + "/value", std::move(value).error();
        SL_ASSIGN(const std::uint32_t topic, find_number(robot, device, text, *value, path, "/value"));
        sensors_.push_back(
            {topic, std::move(*value), (place.max + place.min) / 2, (place.max - place.min) / 2});
      }
  }
  return {};
}

Status SelfOrg::find_motors(const Description& robot) {
  if (spec_.motors.empty()) {
    for (const auto& entry : robot.actuators)
      if (entry.level.empty() && entry.type == msg::Float64::ros_type) {
        motors_.push_back({numbers_.size(), -1, 0, 1});
        SL_ASSIGN(const auto actuator, robot.actuator<msg::Float64>(entry.device));
        numbers_.push_back(actuator);
      }
    if (motors_.empty())
      return Error{fmt::format("robot '{}' has no device that takes a number", robot.robot), "list `motors`"};
    return {};
  }
  for (std::size_t i = 0; i < spec_.motors.size(); ++i) {
    const std::string path = fmt::format("/motors/{}", i);
    const auto devices = devices_like(robot.actuators, spec_.motors[i].device);
    if (devices.empty()) return not_there(robot.actuators, spec_.motors[i].device, path + "/device");
    for (const std::string& device : devices) SL_TRY(add_motor(robot, device, spec_.motors[i], path));
  }
  return {};
}

Status SelfOrg::add_motor(const Description& robot, const std::string& device, const Place& place,
                          const std::string& path) {
  const auto* const entry = entry_of(robot.actuators, device);
  if (!entry) return not_there(robot.actuators, device, path + "/device");
  const std::string name = entry->level.empty() ? entry->device : entry->device + "/" + entry->level;
  Motor motor{0, -1, (place.max + place.min) / 2, (place.max - place.min) / 2};
  if (entry->type == msg::Float64::ros_type) {
    motor.target = numbers_.size();
    SL_ASSIGN(const auto actuator, robot.actuator<msg::Float64>(name));
    numbers_.push_back(actuator);
  } else if (entry->type == msg::Twist::ros_type) {
    const auto found = std::find(std::begin(twist_components), std::end(twist_components), place.value);
    if (found == std::end(twist_components))
      return Error{fmt::format("'{}' takes a Twist, which has no '{}'", device, place.value),
                   "linear.x, linear.y or angular.z",
                   {},
                   path + "/value"};
    motor.component = static_cast<int>(found - std::begin(twist_components));
    SL_ASSIGN(const auto actuator, robot.actuator<msg::Twist>(name));
    while (motor.target < twists_.size() && twists_[motor.target].actuator.slot != actuator.slot)
      ++motor.target;
    if (motor.target == twists_.size()) twists_.push_back({actuator, {}});
  } else {
    return Error{fmt::format("'{}' takes a {}", device, entry->type),
                 "a motor takes a Float64 or a Twist",
                 {},
                 path + "/device"};
  }
  motors_.push_back(motor);
  return {};
}

Result<std::unique_ptr<so::WiredController>> SelfOrg::make_agent(std::uint64_t seed) const {
  so::AgentSpec spec;
  spec.controller = spec_.agent;
  spec.parameters = spec_.parameters;
  for (const Part& part : spec_.wiring) spec.wiring.push_back({part.kind, part.parameters});
  spec.noise = spec_.noise;
  spec.seed = seed;
  spec.name = robot_;
  SL_ASSIGN(auto made, so::WiredController::make(sensors_.size(), motors_.size(), spec));
  made->babble(spec_.babbling);
  return made;
}

/// The run's seed reaches a controller in its steps only. What was tuned or loaded meanwhile is kept.
void SelfOrg::begin(std::uint64_t seed) {
  seed_ = seed;
  auto made = make_agent(seed_);
  SL_CHECK(made);
  ByteWriter kept;
  if (phase_ == Phase::learned) {
    agent_->save(kept);
  } else {
    agent_->controller().save_parameters(kept);
    agent_->wiring().save_parameters(kept);
  }
  ByteReader taken(kept.bytes());
  if (phase_ == Phase::learned) {
    (*made)->load(taken);
  } else {
    (*made)->controller().load_parameters(taken);
    (*made)->wiring().load_parameters(taken);
  }
  SL_CHECK(taken.ok());
  agent_ = std::move(*made);
  phase_ = Phase::begun;
}

Status SelfOrg::check_learned(std::span<const std::byte> stored, const std::string& from) const {
  SL_ASSIGN(auto made, make_agent(seed_));
  return made->take_stored(stored, from);
}

Status SelfOrg::take_learned(std::span<const std::byte> stored, const std::string& from) {
  SL_ASSIGN(auto made, make_agent(seed_));
  SL_TRY(made->take_stored(stored, from));
  agent_ = std::move(made);
  spec_.noise = std::clamp(agent_->noise(), 0.0, 100.0);
  if (phase_ == Phase::new_one) phase_ = Phase::learned;
  return {};
}

void SelfOrg::step(const Observation& obs, Command& cmd) {
  if (phase_ != Phase::begun) begin(obs.random().bits64());
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const Sensor& sensor = sensors_[i];
    const TopicBase& topic = obs.topic(sensor.topic);
    x_[i] = 0;
    if (topic.count == 0) continue;
    const ValueFound found = topic.value(sensor.path);
    if (found.is == ValueFound::Is::value)
      x_[i] = std::isinf(found.value) ? std::copysign(1.0, found.value)
                                      : (found.value - sensor.middle) / sensor.scale;
  }
  agent_->set_noise(spec_.noise);
  guidance_.apply(obs, agent_->controller());
  agent_->step(x_, y_);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const Motor& motor = motors_[i];
    const double value = motor.middle + motor.scale * std::clamp(y_[i], -1.0, 1.0);
    if (motor.component < 0) cmd.set(numbers_[motor.target], msg::Float64{value});
    else component_of(twists_[motor.target].order, motor.component) = value;
  }
  for (const TwistTarget& target : twists_) cmd.set(target.actuator, target.order);
  if (spec_.publish_interval > 0 &&
      (agent_->steps() - 1) % static_cast<std::uint64_t>(spec_.publish_interval) == 0)
    publish(cmd);
}

/// Topics are in the order of the channels.
void SelfOrg::publish(Command& cmd) {
  std::size_t at = 0;
  agent_->controller().channels([&](const so::Channel& channel) {
    if (at >= topics_.size() || topics_[at].name != channel.name) return;
    Topic& topic = topics_[at++];
    // ROS arrays are row after row.
    for (std::size_t i = 0; i < channel.rows; ++i)
      for (std::size_t j = 0; j < channel.cols; ++j)
        topic.message.data[i * channel.cols + j] = channel.values[i + j * channel.rows];
    cmd.publish(topic.publication, topic.message);
  });
}

Status SelfOrg::set_parameter(std::string_view path, const Node& value) {
  const std::string_view first = first_part(path);
  const std::string_view rest = first.size() < path.size() ? path.substr(first.size() + 1)
                                                           : std::string_view();
  if (first == "parameters" && !rest.empty()) return agent_->controller().set_parameter(rest, value);
  if (first == "wiring" && !rest.empty()) {
    const bool indexed = !is_sequence() && starts_with(rest, "0/");
    return agent_->wiring().set_parameter(indexed ? rest.substr(2) : rest, value);
  }
  if (path == learned_field) {
    const auto stored = value.is_scalar() ? from_base64(value.text()) : std::nullopt;
    if (!stored) return value.error("'learned' takes a stored agent in Base64", "load it by the console");
    return take_learned(std::as_bytes(std::span(*stored)), "learned");
  }
  Spec changed = spec_;
  SL_TRY(set_tunable(changed, path, value));
  spec_ = std::move(changed);
  return {};
}

/// A single wiring has the index 0, which may be left out.
ValueFound SelfOrg::wiring_value(ValuePart part, std::span<const ValueStep> path) const {
  const bool indexed = path.size() > 1 && path[0].key.empty() && path[0].index == 0;
  return agent_->wiring().value(part, indexed && !is_sequence() ? path.subspan(1) : path);
}

ValueFound SelfOrg::value(ValuePart part, std::span<const ValueStep> path) const {
  if (part == ValuePart::state) {
    if (path.size() > 1 && path[0].key == "wiring") return wiring_value(part, path.subspan(1));
    if (path.size() == 1 && path[0].key == "bad_sensors")
      return {ValueFound::Is::value, static_cast<double>(agent_->controller().bad_sensors())};
    return agent_->controller().value(part, path);
  }
  if (path.size() > 1 && path[0].key == "parameters")
    return agent_->controller().value(part, path.subspan(1));
  if (path.size() > 1 && path[0].key == "wiring") return wiring_value(part, path.subspan(1));
  return value_at(spec_, path);
}

void SelfOrg::list_values(ValuePart part, const ValueVisit& visit) const {
  const auto of_wiring = [&](ValueEntry entry) {
    entry.path = (is_sequence() ? "wiring" : "wiring[0].") + entry.path;
    visit(std::move(entry));
  };
  if (part == ValuePart::state) {
    agent_->controller().list_values(part, visit);
    return agent_->wiring().list_values(part, of_wiring);
  }
  sandlot::list_values(spec_, "", "", "", visit);
  agent_->controller().list_values(part, [&](ValueEntry entry) {
    entry.path = "parameters." + entry.path;
    visit(std::move(entry));
  });
  agent_->wiring().list_values(part, of_wiring);
}

void SelfOrg::save(ByteWriter& w) const {
  write(w, spec_.noise);  // the only tunable of the spec itself
  write(w, phase_);
  write(w, seed_);
  for (const TwistTarget& target : twists_) write(w, target.order);
  agent_->save(w);
}

void SelfOrg::load(ByteReader& r) {
  Phase phase{};
  std::uint64_t seed = 0;
  double noise = 0;
  read(r, noise);
  if (!(noise >= 0 && noise <= 100)) r.fail();
  read(r, phase);
  if (phase > Phase::learned) r.fail();
  read(r, seed);
  std::vector<TwistTarget> twists = twists_;
  for (TwistTarget& target : twists) read(r, target.order);
  if (!r.ok()) return;
  auto made = make_agent(seed);
  SL_CHECK(made);
  (*made)->load(r);
  if (!r.ok()) return;
  spec_.noise = noise;
  phase_ = phase;
  seed_ = seed;
  twists_ = std::move(twists);
  agent_ = std::move(*made);
}

namespace {

/// The keys, and the parameters of all kinds of agents: an agent has the values of its own kind only. Ranges of a name that
/// several kinds have are united; the agent checks its own.
std::vector<FieldInfo> describe_agent() {
  std::vector<FieldInfo> all = describe_fields<Spec>();
  const std::size_t own = all.size();
  for (const so::ControllerKind& each : so::controller_kinds())
    for (FieldInfo field : each.create()->describe()) {
      field.required = false;
      field.path = "parameters/" + field.path;
      const auto known = std::find_if(all.begin() + static_cast<std::ptrdiff_t>(own), all.end(),
                                      [&](const FieldInfo& other) { return other.path == field.path; });
      if (known == all.end()) {
        all.push_back(std::move(field));
      } else {
        known->min = std::min(known->min, field.min);
        known->max = std::max(known->max, field.max);
      }
    }
  return all;
}

}  // namespace

extern const ControllerKind kind;
constinit const ControllerKind kind = {
    .name = "selforg",
    .help = "Finds behaviour by itself: homeokinesis and its kin.",
    .describe = describe_agent,
    .create = []() -> std::unique_ptr<Controller> { return std::make_unique<SelfOrg>(); },
};

}  // namespace sandlot::controllers::selforg
