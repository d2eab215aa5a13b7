#include "control/outputs.h"

#include <algorithm>
#include <utility>

namespace sandlot {
namespace {

bool is_name(std::string_view name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name.size() <= 100 && std::all_of(name.begin(), name.end(), fits);
}

}  // namespace

void Outputs::check(std::string_view name) {
  if (!status_) return;
  if (!is_name(name)) {
    status_ = Error{"'" + std::string(name.substr(0, 100)) + "' cannot be the name of a topic",
                    "letters, digits and _"};
    return;
  }
  const std::string topic = "/" + path_ + "/" + std::string(name);
  for (const Output& each : outputs_)
    if (each.topic->name() == topic)
      status_ = Error{"'" + topic + "' is published twice", "one of the two needs another name"};
}

void Outputs::check_input(std::string_view name, const std::string& topic) {
  if (!status_) return;
  if (!is_name(name)) {
    status_ = Error{"'" + std::string(name.substr(0, 100)) + "' cannot be the name of a topic",
                    "letters, digits and _"};
    return;
  }
  for (const Input& each : inputs_)
    if (each.topic->name() == topic)
      status_ = Error{"'" + topic + "' is read twice", "subscribe once and keep the handle"};
}

void Outputs::commit(Time now) {
  for (Output& output : outputs_) {
    if (!std::exchange(output.fresh, false)) continue;
    output.next->count = output.topic->count;
    output.next->republish(now);
    output.topic->copy_from(*output.next);
  }
}

void Outputs::adopt(Outputs& before) {
  for (Output& output : outputs_)
    for (Output& old : before.outputs_)
      if (old.topic && old.topic->name() == output.topic->name() &&
          std::string_view(old.topic->type()) == output.topic->type())
        output.topic = std::move(old.topic);
  for (Input& input : inputs_)
    for (Input& old : before.inputs_)
      if (old.topic && old.topic->name() == input.topic->name() &&
          std::string_view(old.topic->type()) == input.topic->type())
        input = std::move(old);
}

}  // namespace sandlot
