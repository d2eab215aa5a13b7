#pragma once
/// The types of messages and services with their members, as text and JSON.
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "messages/registry.h"

namespace sandlot::app {

/// Types of messages and services, those of the names that were given, or all.
struct Types {
  std::vector<const MessageInfo*> messages;
  std::vector<ServiceInfo> services;
};
Result<Types> choose_types(std::span<const std::string> names);

void print_messages(const Types& types, bool verbose);
nlohmann::ordered_json messages_json(const Types& chosen);

}  // namespace sandlot::app
