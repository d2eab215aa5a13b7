#include "record/agent_log.h"

#include <fmt/format.h>

#include "base/text.h"
#include "sim/watch/parameters.h"

namespace sandlot {
namespace {

using controllers::selforg::SelfOrg;

struct Found {
  std::string path;
  const SelfOrg* agent;
};

std::vector<Found> agents_of(const Simulation& simulation) {
  std::vector<Found> out;
  const auto add = [&](const auto& programs) {
    for (const auto& each : programs)
      if (const auto* const agent = dynamic_cast<const SelfOrg*>(each->controller.get()))
        out.push_back({each->path, agent});
  };
  for (const auto& entity : simulation.entities()) add(entity->programs);
  for (const Simulation::Team& team : simulation.teams()) add(team.programs);
  return out;
}

}  // namespace

std::vector<AgentLogDecl> declared_agent_logs(const Simulation& simulation) {
  std::vector<AgentLogDecl> out;
  for (const Found& each : agents_of(simulation))
    if (const auto& log = each.agent->spec().log)
      out.push_back({each.path, log->file, {.interval = log->interval, .channels = log->values}});
  return out;
}

AgentLogDecl parse_agent_log(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return {"", std::string(text)};
  return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

Result<std::unique_ptr<AgentLog>> AgentLog::open(const Simulation& simulation, AgentLogDecl decl) {
  std::vector<std::string> fitting, known;
  for (const Found& each : agents_of(simulation)) {
    known.push_back(each.path);
    if (decl.agent.empty() || each.path == decl.agent || first_part(each.path) == decl.agent)
      fitting.push_back(each.path);
  }
  if (decl.file.empty())
    return Error{"a log of an agent without a file", "--agent-log rover/controller=rover.log"};
  if (known.empty())
    return Error{"the world has no agents to log (controllers of kind selforg)", "leave --agent-log out"};
  if (fitting.empty())
    return Error{fmt::format("there is no agent '{}'", decl.agent), suggestion(decl.agent, known)};
  if (fitting.size() > 1)
    return Error{fmt::format("there are {} agents to log into '{}'", fitting.size(), decl.file),
                 fmt::format("name one: --agent-log {}={}", fitting.front(), decl.file)};
  decl.agent = fitting.front();
  return std::unique_ptr<AgentLog>(new AgentLog(simulation, std::move(decl)));
}

const selforg::WiredController* AgentLog::agent() const {
  const auto* const programs = simulation_.programs_of(first_part(decl_.agent));
  if (!programs) return nullptr;
  for (const auto& each : *programs)
    if (each->path == decl_.agent)
      if (const auto* const found = dynamic_cast<const SelfOrg*>(each->controller.get()))
        return &found->agent();
  return nullptr;
}

Status AgentLog::begin() {
  const auto* const found = agent();
  if (!found) return Error{fmt::format("there is no agent '{}' any more", decl_.agent)};
  SL_TRY(log_.open(decl_.file, decl_.spec, *found));
  write_step();
  return {};
}

void AgentLog::on_frame(const std::shared_ptr<const Frame>& frame) {
  for (const LogEntry& entry : frame->log) {
    if (entry.refused || entry.target != decl_.agent || entry.kind == LogEntry::command) continue;
    ByteReader r(entry.bytes);
    Request request;
    if (!read_request(r, request)) continue;
    const auto* const set = std::get_if<ParameterRequest>(&request);
    if (!set) continue;
    if (set->field == SelfOrg::learned_field) log_.comment("loaded a stored agent");
    else log_.comment(value_path(set->field) + "=" + (set->value.is_scalar() ? set->value.text() : "..."));
  }
  write_step();
}

/// A robot that has left the world writes nothing more.
void AgentLog::write_step() {
  const auto* const found = agent();
  if (!found || found->steps() == steps_) return;
  steps_ = found->steps();
  log_.step(simulation_.now().s(), *found);
}

}  // namespace sandlot
