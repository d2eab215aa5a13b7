/// Commands about the controllers of robots: which there are, and how they come, start, stop and go while the run goes on. All
/// that changes something is a call of the robot's controller manager (sim/world/controllers.h).
#include <map>

#include "base/json_writer.h"
#include "base/text.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "files/text.h"
#include "messages/cdr.h"
#include "messages/controller_manager_msgs.h"
#include "messages/registry.h"
#include "sim/world/controllers.h"
#include "sim/world/lookup.h"

namespace sandlot::console {
namespace {

namespace cm = msg::controller_manager;

constexpr const char* acts[] = {"load", "configure", "start", "stop", "unload"};
constexpr std::size_t most_file_bytes = 1u << 20;

bool is_act(std::string_view word) {
  return std::find(std::begin(acts), std::end(acts), word) != std::end(acts);
}

/// A robot and the name of one of its controllers: "rover/weave".
struct Address {
  std::string robot, name;
};

Result<Address> address_of(CommandCall& call, std::string_view word) {
  if (word.substr(0, 1) == "/") word.remove_prefix(1);
  const std::size_t slash = word.find('/');
  if (slash == std::string_view::npos)
    return Error{"'" + std::string(word.substr(0, 100)) + "' names no controller", "write ROBOT/CONTROLLER"};
  Address out{std::string(word.substr(0, slash)), std::string(word.substr(slash + 1))};
  const auto robot = entity_named(call.simulation(), out.robot);
  if (robot && (*robot)->instance.is_robot) return out;
  call.unknown_thing = true;
  if (!robot) return robot.error();
  return Error{"'" + out.robot + "' is not a robot", "robots have controllers"};
}

template <class Asked>
PendingRequest request_of(const std::string& robot, const char* service, const Asked& asked,
                          std::string text) {
  CallRequest made{robot + "/" + std::string(controller_manager_name), service, {}};
  write_cdr(message_info<Asked>(), &asked, made.bytes);
  return {std::move(made), std::move(text)};
}

/// @param words  a robot, or nothing: all
CommandResult list_controllers(CommandCall& call, std::span<const std::string> words, bool as_json) {
  std::vector<const Simulation::Entity*> robots;
  if (words.empty()) {
    for (const auto& entity : call.simulation().entities())
      if (entity->instance.is_robot) robots.push_back(entity.get());
  } else {
    SL_ASSIGN(robots, match_things(call, words.front()));
  }
  std::string text, json_text;
  JsonWriter json(json_text);
  json.begin_list();
  for (const Simulation::Entity* const robot : robots)
    for (const ControllerView& each : controllers_of(call.simulation(), *robot)) {
      const std::string path = robot->instance.name + "/" + each.name;
      json.object([&] {
        json.key("path").text(path);
        json.key("kind").text(each.kind);
        json.key("state").text(name_of(each.state));
        json.key("program").flag(each.program);
        json.key("claims").list([&] {
          for (const std::string& claim : each.claims) json.text(claim);
        });
      });
      text += (text.empty() ? "" : "\n") + path + "  " + each.kind + "  " + name_of(each.state);
      for (std::size_t i = 0; i < each.claims.size(); ++i)
        text += (i ? ", " : "  commands ") + each.claims[i];
    }
  json.end_list();
  if (as_json) return std::optional(std::move(json_text));
  return std::optional(text.empty() ? std::string("there are none") : text);
}

CommandResult load_controller(CommandCall& call) {
  if (call.words.size() < 3)
    return Error{"'controllers load' needs a name and a kind",
                 "controllers load ROBOT/NAME KIND {KEY: VALUE}, or a FILE.yaml"};
  SL_ASSIGN(const Address address, address_of(call, call.words[1]));
  cm::LoadController::Request asked;
  asked.name = address.name;
  const std::string& what = call.words[2];
  if (what.ends_with(".yaml") || what.ends_with(".yml")) {
    if (call.words.size() > 3) return Error{"a file has the keys: nothing follows it"};
    SL_ASSIGN(const std::string file, file_within(call.options, what));
    SL_ASSIGN(asked.parameters, read_text_file(file, most_file_bytes));
    asked.file = what;
  } else {
    asked.kind = what;
    if (call.words.size() > 3) asked.parameters = call.rest(3);
    asked.file = "keys";
  }
  return submit(call, {request_of(address.robot, "load_controller", asked, call.words[1] + " loaded")});
}

/// `start A B stop C`: one switch for each robot.
CommandResult switch_over(CommandCall& call) {
  std::map<std::string, cm::SwitchController::Request> switches;
  bool starts = true;
  for (const std::string& word : call.words) {
    if (word == "start" || word == "stop") {
      starts = word == "start";
      continue;
    }
    SL_ASSIGN(Address address, address_of(call, word));
    cm::SwitchController::Request& asked = switches[address.robot];
    (starts ? asked.activate_controllers : asked.deactivate_controllers).push_back(std::move(address.name));
  }
  if (switches.empty()) return Error{"no controller is named", "controllers start ROBOT/CONTROLLER"};
  std::vector<PendingRequest> requests;
  for (const auto& [robot, asked] : switches) {
    std::string text;
    for (const bool started : {false, true})
      for (const std::string& name : started ? asked.activate_controllers : asked.deactivate_controllers)
        text += (text.empty() ? "" : ", ") + robot + "/" + name + (started ? " started" : " stopped");
    requests.push_back(request_of(robot, "switch_controller", asked, std::move(text)));
  }
  return submit(call, std::move(requests));
}

}  // namespace

CommandResult cmd_controllers(CommandCall& call) {
  const bool acts_on = call.words.size() > 1 && is_act(call.words.front());
  if (!acts_on) {
    // The keys of `load` are taken letter by letter, so the flag comes here as a word.
    const bool as_json = call.json || (!call.words.empty() && call.words.back() == "--json");
    const std::span<const std::string> words = call.words.first(call.words.size() -
                                                                (as_json && !call.json ? 1 : 0));
    if (words.size() > 1)
      return Error{"'" + words.front().substr(0, 60) + "' is nothing that is done to controllers",
                   suggestion(words.front(), std::vector<std::string>(std::begin(acts), std::end(acts)))};
    if (!words.empty() && is_act(words.front()) && !call.simulation().find_entity(words.front()))
      return Error{"'controllers " + words.front() + "' needs a controller", "ROBOT/CONTROLLER"};
    return list_controllers(call, words, as_json);
  }
  if (!call.caller.may_steer) return Error{"this is for those who may steer; you may watch"};
  const std::string& act = call.words.front();
  if (act == "load") return load_controller(call);
  if (act == "start" || act == "stop") return switch_over(call);
  std::vector<PendingRequest> requests;
  for (const std::string& word : call.words.subspan(1)) {
    SL_ASSIGN(const Address address, address_of(call, word));
    if (act == "configure")
      requests.push_back(request_of(address.robot, "configure_controller",
                                    cm::ConfigureController::Request{address.name}, word + " configured"));
    else
      requests.push_back(request_of(address.robot, "unload_controller",
                                    cm::UnloadController::Request{address.name}, word + " unloaded"));
  }
  return submit(call, std::move(requests));
}

}  // namespace sandlot::console
