#include "app/verbs/list/messages.h"

#include <fmt/format.h>

#include "base/text.h"

namespace sandlot::app {

using OrderedJson = nlohmann::ordered_json;

namespace {

/// "float32[]", "geometry_msgs/msg/Point[4]": the type of a field as ROS writes it.
std::string type_text(const MessageField& field) {
  std::string out = field.message ? field.message->name : name_of(field.type);
  if (field.count == MessageField::Count::array) out += "[" + std::to_string(field.length) + "]";
  if (field.count == MessageField::Count::sequence)
    out += field.length > 0 ? "[<=" + std::to_string(field.length) + "]" : "[]";
  return out;
}

void print_members(const MessageInfo& type) {
  for (const MessageConstant& constant : type.constants)
    fmt::print("    {:<40} {} = {}\n", name_of(constant.type), constant.name, constant.value);
  for (const MessageField& field : type.fields)
    fmt::print("    {:<40} {:<26} {}{}\n", type_text(field), field.name, field.help,
               field.unit.empty() || field.unit == "1" ? "" : " [" + field.unit + "]");
}

bool is_side_of_service(const MessageInfo& type) { return type.name.find("/srv/") != std::string::npos; }

OrderedJson message_json(const MessageInfo& type) {
  OrderedJson constants = OrderedJson::array(), fields = OrderedJson::array();
  for (const MessageConstant& constant : type.constants)
    constants.push_back(
        {{"name", constant.name}, {"type", name_of(constant.type)}, {"value", constant.value}});
  for (const MessageField& field : type.fields)
    fields.push_back(
        {{"name", field.name}, {"type", type_text(field)}, {"unit", field.unit}, {"help", field.help}});
  return {{"name", type.name}, {"constants", constants}, {"fields", fields}};
}

}  // namespace

Result<Types> choose_types(std::span<const std::string> names) {
  Types all{{}, {all_services().begin(), all_services().end()}};
  for (const MessageInfo* const type : all_messages())
    if (!is_side_of_service(*type)) all.messages.push_back(type);
  if (names.empty()) return all;
  Types out;
  std::vector<std::string> known;
  for (const MessageInfo* const type : all.messages) known.push_back(type->name);
  for (const ServiceInfo& service : all.services) known.emplace_back(service.name);
  for (const std::string& name : names) {
    // "Twist" is enough where only one package has it.
    const auto named = [&](std::string_view full) {
      return full == name || (name.find('/') == name.npos && full.ends_with("/" + name));
    };
    const std::size_t before = out.messages.size() + out.services.size();
    for (const MessageInfo* const type : all.messages)
      if (named(type->name)) out.messages.push_back(type);
    for (const ServiceInfo& service : all.services)
      if (named(service.name)) out.services.push_back(service);
    if (out.messages.size() + out.services.size() == before)
      return Error{"list messages: there is no type '" + name + "'", suggestion(name, known)};
  }
  return out;
}

void print_messages(const Types& types, bool verbose) {
  if (!types.messages.empty()) fmt::print("messages\n");
  for (const MessageInfo* const type : types.messages) {
    fmt::print("  {}\n", type->name);
    if (verbose) print_members(*type);
  }
  if (!types.services.empty()) fmt::print("services\n");
  for (const ServiceInfo& service : types.services) {
    fmt::print("  {}\n", service.name);
    if (!verbose) continue;
    print_members(*service.request);
    fmt::print("    ---\n");
    print_members(*service.response);
  }
}

OrderedJson messages_json(const Types& chosen) {
  OrderedJson types = OrderedJson::array(), services = OrderedJson::array();
  for (const MessageInfo* const type : chosen.messages) types.push_back(message_json(*type));
  for (const ServiceInfo& service : chosen.services)
    services.push_back({{"name", service.name},
                        {"request", message_json(*service.request)},
                        {"response", message_json(*service.response)}});
  return {{"messages", types}, {"services", services}};
}

}  // namespace sandlot::app
