#include "run/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "run/fields_json.h"
#include "run/travel.h"
#include "sim/session/session.h"
#include "sim/watch/monitor.h"

namespace sandlot {
namespace {

double rounded(double x, double unit) { return std::round(x / unit) * unit; }

std::optional<std::array<double, 6>> pose_of(const Simulation& simulation, const std::string& robot) {
  const auto id = simulation.find_instance(robot);
  if (!id) return std::nullopt;
  const Pose X_WM = simulation.engine().pose(*id);
  const Vec3 rpy = rpy_from_quat(X_WM.q);
  return std::array{X_WM.p.x, X_WM.p.y, X_WM.p.z, rpy.x, rpy.y, rpy.z};
}

/// Positions of a robot's moving joints; nothing when it is gone.
std::vector<Named<double>> joints_of(const Simulation& simulation, const std::string& robot) {
  std::vector<Named<double>> out;
  const auto id = simulation.find_instance(robot);
  if (!id || !simulation.engine().capabilities().joints) return out;
  const model::Model& model = *simulation.find_entity(robot)->instance.model;
  const auto joints = simulation.engine().joints(*id);
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (model.joints[i].type != model::JointType::fixed)
      out.push_back({model.joints[i].name, simulation.engine().joint_states()[joints[i].index].position});
  return out;
}

}  // namespace

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

Summary summarise(const Simulation& simulation, const RunReport& report, const TravelMeter& travel) {
  const model::Setup& setup = simulation.setup();
  const double ticks = static_cast<double>(std::max<std::uint64_t>(report.ticks, 1));
  Summary out;
  out.name = setup.name;
  out.physics = setup.engine;
  out.seed = setup.seed;
  out.ticks = report.ticks;
  out.sim_s = report.sim_s;
  out.wall_s = report.wall_s;
  out.real_time_factor = report.wall_s > 0 ? report.sim_s / report.wall_s : 0.0;
  out.late_ticks = report.late_ticks;
  if (setup.clock.mode == model::Clock::Mode::continuous)
    out.step = {report.ticks ? report.sim_s / ticks : 0.0, report.shortest.s(), report.longest.s()};
  for (std::size_t i = 0; i < phase_names.size(); ++i)
    out.phase_us.push_back(
        {phase_names[i], rounded(static_cast<double>(simulation.phase_times().ns[i]) * 1e-3 / ticks, 1e-3)});
  out.end_tick = simulation.tick_index();
  out.end_s = simulation.now().s();
  out.stopped = simulation.stop_reason().value_or("");
  out.state_hash = {simulation.state_hash()};
  for (const SubHash& sub : simulation.sub_hashes()) out.sub_hashes.push_back({sub.path, {sub.hash}});
  out.profile = Simulation::profile();
  for (const TravelMeter::Travel& robot : travel.robots()) {
    const Vec3 extent = robot.highest - robot.lowest;
    out.robots.push_back({.name = robot.name,
                          .distance_m = rounded(robot.distance_m, 1e-3),
                          .extent_m = {rounded(extent.x, 1e-3), rounded(extent.y, 1e-3)},
                          .covered_m2 = robot.covered_m2(),
                          .pose = pose_of(simulation, robot.name),
                          .joints = joints_of(simulation, robot.name)});
  }
  const EngineCounters counters = simulation.engine().counters();
  out.engine = {counters.solver_messages, counters.contacts, counters.awake_bodies};
  out.refused_commands = simulation.refused_commands();
  for (const auto& entity : simulation.entities())
    for (const auto& device : entity->devices)
      if (device->keys && device->keys->state.refused > 0)
        out.refused_by_device.push_back({device->path, device->keys->state.refused});
  for (const Monitor::Event& event : simulation.monitor().events()) {
    EventSummary& added = out.events.emplace_back(EventSummary{event.decl.name, event.count, {}, {}});
    if (event.count > 0) added.first_s = event.first.s(), added.last_s = event.last.s();
  }
  for (const Monitor::Criterion& criterion : simulation.monitor().criteria()) {
    const auto value = simulation.monitor().judge(criterion);
    const auto success = simulation.monitor().succeeds(criterion);
    for (const Error* const error : {value ? nullptr : &value.error(), success ? nullptr : &success.error()})
      if (error) out.errors.push_back(error->text());
    const CriterionSummary found{value ? *value : std::nullopt, success ? *success : std::nullopt};
    if (!criterion.team.empty()) out.criteria.push_back({criterion.team, found});
    else out.criterion = found.value, out.success = found.success;
  }
  std::map<std::string, std::vector<std::string>> teams;
  for (const model::Instance* instance : simulation.instances())
    if (!instance->team.empty()) teams[instance->team].push_back(instance->name);
  for (auto& [team, robots] : teams) out.teams.push_back({team, std::move(robots)});
  return out;
}

nlohmann::ordered_json as_json(const Summary& summary) { return fields_json(summary); }

std::string as_json_text(const Summary& summary) { return json_text(as_json(summary)) + "\n"; }

std::string as_text(const Summary& s) {
  std::string out;
  out += fmt::format("scenario   {} ({}, seed {})\n", s.name, s.physics, s.seed);
  out += fmt::format("simulated  {:.3f} s in {:.3f} s, {:.1f} x real time, {} ticks\n", s.sim_s, s.wall_s,
                     s.real_time_factor, s.ticks);
  if (s.step)
    out += fmt::format("clock      continuous: steps of {:.3g} ms, from {:.3g} to {:.3g}; {} were cut\n",
                       1e3 * s.step->mean_s, 1e3 * s.step->min_s, 1e3 * s.step->max_s, s.late_ticks);
  out += "per tick  ";
  for (const auto& [name, us] : s.phase_us) out += fmt::format(" {} {:.1f}", name, us);
  out += " us\n";
  constexpr std::size_t most_robots = 12;
  for (std::size_t i = 0; i < std::min(most_robots, s.robots.size()); ++i)
    out += fmt::format("robot      {}: drove {:.2f} m, covered {:.2f} m^2\n", s.robots[i].name,
                       s.robots[i].distance_m, s.robots[i].covered_m2);
  if (s.robots.size() > most_robots) out += fmt::format("           ... {} robots in all\n", s.robots.size());
  for (const EventSummary& event : s.events) {
    out += fmt::format("event      {}: ", event.name);
    if (event.count == 0) out += "did not happen\n";
    else if (event.count == 1) out += fmt::format("at {} s\n", *event.first_s);
    else out += fmt::format("{} times, first at {} s\n", event.count, *event.first_s);
  }
  const auto judged = [](std::optional<double> value, std::optional<bool> success) {
    return (value ? fmt::format("{:.6g}", *value) : "no value") +
           (success ? *success ? ", success" : ", no success" : "") + "\n";
  };
  if (s.criterion || s.success) out += "criterion  " + judged(s.criterion, s.success);
  for (const auto& [team, found] : s.criteria)
    out += "criterion  " + team + ": " + judged(found.value, found.success);
  if (s.recording)
    out += fmt::format("recording  {}: {} messages, {:.2f} MB\n", s.recording->file, s.recording->messages,
                       1e-6 * static_cast<double>(s.recording->bytes));
  constexpr std::size_t most_clients = 12;
  for (std::size_t i = 0; i < std::min(most_clients, s.clients.size()); ++i) {
    const ClientSummary& client = s.clients[i];
    out += fmt::format("client     {} in {} {}", client.name.empty() ? "(no name)" : client.name, client.role,
                       client.drives.empty() ? client.mode : client.drives + ", " + client.mode);
    if (client.mode == "lockstep") out += fmt::format(": missed {} of {} steps", client.misses, client.steps);
    else out += fmt::format(": {} commands, stopped {} times", client.commands, client.stops);
    if (client.latency)
      out += fmt::format("; answers took {:.3g} ms, 99 % at most {:.3g} ms", 1e3 * client.latency->mean_s,
                         1e3 * client.latency->p99_s);
    out += "\n";
  }
  if (s.clients.size() > most_clients)
    out += fmt::format("           ... {} clients in all\n", s.clients.size());
  if (s.refbox) {
    for (const RefboxTeamSummary& team : s.refbox->teams)
      out += fmt::format("refbox     {}: {} connections ({}), {} words, {} world states, {} wrong messages\n",
                         team.team, team.connections, team.protocol, team.words, team.world_states,
                         team.wrong + team.dropped);
    if (s.refbox->refused > 0) out += fmt::format("refbox     sent away {} connections\n", s.refbox->refused);
  }
  const char* const from_outside = s.errors.empty() ? "by request" : "by an error";
  out += fmt::format("stopped    {}\n", s.stopped.empty() ? from_outside : s.stopped);
  out += fmt::format("state      {} ({})\n", hash_text(s.state_hash.value), s.profile);
  for (const std::string& error : s.errors) out += fmt::format("error      {}\n", error);
  return out;
}

}  // namespace sandlot
