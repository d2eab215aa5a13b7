#include "programs/answer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "messages/command.h"

namespace sandlot::programs {
namespace {

using Json = nlohmann::json;

/// Whether brackets are nested deeper than `most`: the library writes and destroys values recursively.
bool is_deep(std::string_view text, int most) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      else if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (++depth > most) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

Result<const Named*> find(std::span<const Named> all, const std::string& name, const char* what) {
  std::vector<std::string> known;
  for (const Named& each : all) {
    if (each.name == name) return &each;
    known.push_back(each.name);
  }
  return Error{"there is no " + std::string(what) + " '" + name.substr(0, 100) + "'",
               suggestion(name, known)};
}

/// The name of the actuator of a device that takes a type; the device's own if none does.
std::string named_by_type(std::span<const Named> actuators, std::string device, const std::string& type) {
  for (const Named& each : actuators)
    if (each.type == type &&
        (each.name == device || each.name == device + "/" + type.substr(type.rfind('/') + 1)))
      return each.name;
  return device;
}

Error wrong(const char* key, const char* what) {
  return {"'" + std::string(key) + "' of the answer is not " + what};
}

}  // namespace

std::vector<Named> names_of(const std::vector<Description::Entry>& entries) {
  std::vector<Named> out;
  const auto taken = [&](const std::string& name) {
    return std::any_of(out.begin(), out.end(), [&](const Named& each) { return each.name == name; });
  };
  for (const Description::Entry& entry : entries) {
    std::string name = entry.device + (entry.level.empty() ? "" : "/" + entry.level);
    if (taken(name)) name += "/" + entry.type.substr(entry.type.rfind('/') + 1);
    if (!taken(name)) out.push_back({std::move(name), entry.index, entry.type, entry.level.empty()});
  }
  return out;
}

Result<Program::Resumed> read_answer(std::string_view line, std::span<const Named> readings,
                                     std::span<const Named> actuators,
                                     std::span<const TopicBase* const> forms, Command& cmd) {
  constexpr int most_nested = 32;
  constexpr std::size_t most_orders = 1000;
  if (is_deep(line, most_nested)) return Error{"the answer is nested more than 32 deep"};
  Json answer;
  try {
    answer = Json::parse(line);
  } catch (const Json::exception& e) {  // the library's only way to report the place
    return Error{std::string("the answer is not JSON: ") + e.what()};
  }
  if (!answer.is_object()) return Error{"the answer is not a JSON object", R"(such as {"orders": {}})"};
  Command ordered;
  Program::Resumed out;
  const auto order = [&](const std::string& name, const Json& message) -> Status {
    SL_ASSIGN(const Named* const actuator, find(actuators, name, "actuator"));
    const TopicBase* const form = actuator->index < forms.size() ? forms[actuator->index] : nullptr;
    if (!form) return Error{"'" + name + "' takes no orders now"};
    auto bytes = command_from_document(*form, message);
    if (!bytes) {
      bytes.error().what = "order for '" + name + "': " + bytes.error().what;
      return std::move(bytes.error());
    }
    ordered.set_bytes(actuator->index, *bytes);
    return {};
  };
  for (const auto& [key, value] : answer.items()) {
    if (key == "orders") {
      if (!value.is_object() && !value.is_array())
        return wrong("orders", "an object of messages by device, or a list of pairs of both");
      if (value.size() > most_orders) return Error{"the answer has more than 1000 orders"};
      if (value.is_object()) {
        for (const auto& [name, message] : value.items()) SL_TRY(order(name, message));
      } else {
        for (const Json& each : value) {
          const bool typed = each.is_array() && each.size() == 3 && each[2].is_string();
          if (!each.is_array() || (each.size() != 2 && !typed) || !each[0].is_string())
            return wrong("orders", "a list of pairs of a device's name and a message");
          std::string name = each[0].get<std::string>();
          if (typed) name = named_by_type(actuators, std::move(name), each[2].get<std::string>());
          SL_TRY(order(name, each[1]));
        }
      }
    } else if (key == "samples") {
      if (!value.is_array() || value.size() > most_orders)
        return wrong("samples", "a list of names of readings");
      for (const Json& name : value) {
        if (!name.is_string()) return wrong("samples", "a list of names of readings");
        SL_ASSIGN(const Named* const reading, find(readings, name.get<std::string>(), "reading"));
        ordered.request_sample_of(reading->index);
      }
    } else if (key == "wait") {
      if (value.is_null()) continue;
      if (value.is_string()) {
        SL_ASSIGN(const Named* const reading, find(readings, value.get<std::string>(), "reading"));
        out.waiting_for = Program::Waiting::message;
        out.reading = reading->index;
      } else if (value.is_number() && value.get<double>() >= 0 && value.get<double>() <= 2e9) {
        out.waiting_for = Program::Waiting::time;
        out.until = Time::from_s(value.get<double>());
      } else {
        return wrong("wait", "a time in seconds or the name of a reading");
      }
    } else {
      return Error{"the answer has the key '" + key.substr(0, 60) + "', which is not known",
                   "known are: orders, samples, wait"};
    }
  }
  for (const Command::Order& order : ordered.orders())
    if (order.is_sample()) cmd.request_sample_of(order.reading());
    else cmd.set_bytes(order.slot, ordered.bytes(order));
  return out;
}

void stop_drives(std::span<const Named> actuators, Command& cmd) {
  for (const Named& actuator : actuators) {
    if (!actuator.any_level) continue;
    if (const auto still = standstill(actuator.type)) cmd.set_bytes(actuator.index, *still);
  }
}

}  // namespace sandlot::programs
