#include "controllers/selforg/guidance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "messages/registry.h"

namespace sandlot::controllers::selforg {
namespace {

std::vector<std::string> names_in(const std::vector<Description::Entry>& entries) {
  std::vector<std::string> names;
  for (const auto& entry : entries)
    names.push_back(entry.level.empty() ? entry.device : entry.device + "/" + entry.level);
  return names;
}

/// Whether messages of a type have a number at the path. A list may be too short for an index: that shows in its messages.
bool has_number(const std::string& type, std::span<const ValueStep> path) {
  const auto found = find_message(type);
  if (!found) return true;  // of a plugin: its messages show
  const MessageInfo* info = *found;
  const MessageField* field = nullptr;
  bool indexed = false;
  for (const ValueStep& step : path) {
    const bool list = field && field->count != MessageField::Count::one;
    if (step.key.empty()) {
      if (!list || indexed) return false;
      indexed = true;
      continue;
    }
    if (field) {
      if ((list && !indexed) || !field->message) return false;
      info = field->message;
    }
    const auto next = std::find_if(info->fields.begin(), info->fields.end(),
                                   [&](const MessageField& each) { return each.name == step.key; });
    if (next == info->fields.end()) return false;
    field = &*next;
    indexed = false;
  }
  const bool one = field && (field->count == MessageField::Count::one || indexed);
  return one && field->type != Wire::string &&
         (field->type != Wire::message || (field->message && field->message->is_time));
}

}  // namespace

const Description::Entry* entry_of(const std::vector<Description::Entry>& entries, std::string_view name) {
  for (const auto& entry : entries)
    if (entry.device == name || entry.device + "/" + entry.level == name) return &entry;
  return nullptr;
}

Error not_there(const std::vector<Description::Entry>& entries, const std::string& device,
                const std::string& path) {
  const auto names = names_in(entries);
  return {fmt::format("the robot has no '{}'", device), suggestion(device, names), {}, path};
}

Result<std::uint32_t> find_number(const Description& robot, const std::string& device,
                                  const std::string& text, const ValuePath& value, const std::string& path,
                                  const char* value_key) {
  const auto* const known = entry_of(robot.readings, device);
  if (!known) return not_there(robot.readings, device, path + "/device");
  for (const auto& each : robot.readings)
    if ((each.device == device || each.device + "/" + each.level == device) && has_number(each.type, value))
      return each.index;
  return Error{fmt::format("'{}' gives no number '{}'", device, text),
               fmt::format("'sandlot list messages' has the fields of {}", known->type),
               {},
               path + value_key};
}

Status RewardTerm::check(const Node& node, const std::string& path) const {
  if (min < max) return {};
  return node.error(fmt::format("an empty range: min {} is not below max {}", min, max), "", path + "/min");
}

Status Guidance::init(const GuidanceSpec& spec, const Description& robot,
                      ::sandlot::selforg::Controller& agent) {
  if (!spec.cross_motor.empty()) {
    if (!agent.teachable())
      return Error{fmt::format("agents of kind {} cannot be taught", agent.kind()),
                   "leave cross_motor out",
                   {},
                   "/cross_motor"};
    if (spec.cross_motor.size() != agent.motors())
      return Error{fmt::format("{} teachers for {} motors", spec.cross_motor.size(), agent.motors()),
                   "give one per motor, -1 for none",
                   {},
                   "/cross_motor"};
    std::vector<std::vector<std::size_t>> sources(spec.cross_motor.size());
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (spec.cross_motor[i] >= 0) sources[i].push_back(static_cast<std::size_t>(spec.cross_motor[i]));
    auto made = ::sandlot::selforg::CrossMotorTeaching::make(std::move(sources), spec.cross_motor_threshold);
    if (!made) return made.error().path = "/cross_motor", std::move(made).error();
    cross_ = std::move(*made);
  }
  if (!spec.reward.empty() && !agent.rewardable())
    return Error{
        fmt::format("agents of kind {} take no reward", agent.kind()), "leave reward out", {}, "/reward"};
  for (std::size_t i = 0; i < spec.reward.size(); ++i) {
    const RewardTerm& each = spec.reward[i];
    const std::string path = fmt::format("/reward/{}", i);
    Term term{.middle = (each.max + each.min) / 2,
              .scale = (each.max - each.min) / 2,
              .weight = each.weight,
              .magnitude = each.magnitude};
    for (std::size_t k = 0; k < each.values.size(); ++k) {
      const std::string key = fmt::format("/values/{}", k);
      auto value = parse_value_path(each.values[k]);
      if (!value) return value.error().path = path + key, std::move(value).error();
      SL_ASSIGN(term.topic, find_number(robot, each.device, each.values[k], *value, path, key.c_str()));
      term.values.push_back(std::move(*value));
    }
    terms_.push_back(std::move(term));
  }
  return {};
}

void Guidance::apply(const Observation& obs, ::sandlot::selforg::Controller& agent) {
  if (cross_) cross_->teach(*agent.teachable());
  if (terms_.empty()) return;
  double reward = 0;
  for (const Term& term : terms_) {
    const TopicBase& topic = obs.topic(term.topic);
    if (topic.count == 0) continue;
    double sum = 0;
    for (const ValuePath& path : term.values) {
      const ValueFound found = topic.value(path);
      if (found.is != ValueFound::Is::value) continue;
      sum += term.magnitude ? found.value * found.value : found.value;
    }
    if (term.magnitude) sum = std::sqrt(sum);
    reward += term.weight * std::clamp((sum - term.middle) / term.scale, -1.0, 1.0);
  }
  agent.rewardable()->set_reward(reward);
}

}  // namespace sandlot::controllers::selforg
