/// Commands about robots that learn: what agents there are, and what they have learned in files.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "base/atomic_file.h"
#include "base/base64.h"
#include "base/json_writer.h"
#include "base/text.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "controllers/selforg/selforg.h"
#include "selforg/store.h"

namespace sandlot::console {
namespace {

namespace fs = std::filesystem;
using controllers::selforg::SelfOrg;

struct Agent {
  std::string path;  ///< "rover/controller"
  std::string kind;
  const SelfOrg* learns = nullptr;  ///< null: a program without a file of what it has learned
};

/// Programs of all robots, then those of teams.
std::vector<Agent> agents_of(const Simulation& simulation) {
  std::vector<Agent> out;
  const auto add = [&](const auto& programs) {
    for (const auto& each : programs)
      out.push_back({each->path, each->decl.kind, dynamic_cast<const SelfOrg*>(each->controller.get())});
  };
  for (const auto& entity : simulation.entities()) add(entity->programs);
  for (const Simulation::Team& team : simulation.teams()) add(team.programs);
  return out;
}

/// The agent of that path, or the only one of that robot.
Result<Agent> agent_named(CommandCall& call, std::string_view name) {
  std::vector<std::string> known;
  std::vector<Agent> of_robot;
  for (const Agent& agent : agents_of(call.simulation())) {
    if (agent.path == name) {
      if (agent.learns) return agent;
      return Error{
          fmt::format("'{}' is a program of kind '{}', which keeps nothing that could be stored alone",
                      agent.path, agent.kind),
          "`store FILE` keeps the state of the whole run"};
    }
    if (!agent.learns) continue;
    known.push_back(agent.path);
    if (first_part(agent.path) == name) of_robot.push_back(agent);
  }
  if (of_robot.size() == 1) return of_robot.front();
  call.unknown_thing = true;
  if (of_robot.size() > 1)
    return Error{fmt::format("'{}' has {} agents", name, of_robot.size()),
                 fmt::format("name one: {}", of_robot.front().path)};
  return Error{fmt::format("there is no agent '{}'", name.substr(0, 100)),
               known.empty() ? "the world has no agents that learn (controllers of kind selforg)"
                             : suggestion(name, known)};
}

bool is_stored_agent(const std::string& file) {
  std::string head(7, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head == "SELFAGT";
}

/// "2 sensors, 1 motor": sizes of the agent towards the robot.
std::string sizes_of(const selforg::WiredController& agent) {
  const auto counted = [](std::size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  return counted(agent.robot_sensors(), "sensor") + ", " + counted(agent.robot_motors(), "motor");
}

}  // namespace

CommandResult list_agents(CommandCall& call) {
  std::string text, json_text;
  JsonWriter json(json_text);
  json.begin_list();
  for (const Agent& each : agents_of(call.simulation())) {
    json.object([&] {
      json.key("path").text(each.path);
      json.key("kind").text(each.kind);
      if (!each.learns) return;
      const selforg::WiredController& agent = each.learns->agent();
      json.key("agent").text(agent.controller().kind());
      json.key("wiring").text(agent.wiring().kind());
      json.key("sensors").integer(agent.robot_sensors());
      json.key("motors").integer(agent.robot_motors());
      json.key("steps").integer(agent.steps());
    });
    text += (text.empty() ? "" : "\n") + each.path + "  " + each.kind;
    if (each.learns)
      text += fmt::format("  {}, {}, {} steps", each.learns->agent().kinds(), sizes_of(each.learns->agent()),
                          each.learns->agent().steps());
  }
  json.end_list();
  if (call.json) return std::optional(std::move(json_text));
  return std::optional(text.empty() ? std::string("the world has none") : text);
}

CommandResult store_agent(CommandCall& call) {
  SL_ASSIGN(const Agent agent, agent_named(call, call.words[0]));
  SL_ASSIGN(const std::string file, file_within(call.options, call.words[1]));
  std::error_code failed;
  if (fs::exists(file, failed) && !is_stored_agent(file))
    return Error{"'" + file + "' is there and is not a stored agent", "give another name"};
  const std::vector<std::byte> bytes = agent.learns->agent().stored();
  SL_TRY(write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  return std::optional(
      fmt::format("{} stored in {} after {} steps", agent.path, file, agent.learns->agent().steps()));
}

/// What the file holds is input of the run: a request that is logged, so that a replay needs no file.
CommandResult load_agent(CommandCall& call) {
  SL_ASSIGN(const Agent agent, agent_named(call, call.words[0]));
  SL_ASSIGN(const std::string file, file_within(call.options, call.words[1]));
  std::error_code failed;
  if (!fs::is_regular_file(file, failed)) return Error{"there is no file '" + file + "'"};
  SL_ASSIGN(const std::string text, selforg::read_stored_file(file));
  const auto bytes = std::as_bytes(std::span(text));
  SL_TRY(agent.learns->check_learned(bytes, file));
  std::string base64;
  add_base64(bytes, base64);
  return submit(call, {{ParameterRequest{agent.path, SelfOrg::learned_field, Node::scalar(std::move(base64))},
                        fmt::format("{} goes on from {}", agent.path, file)}});
}

}  // namespace sandlot::console
