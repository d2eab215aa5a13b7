#include "app/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/watch/monitor.h"

namespace sandlot::app {

void TravelRecorder::look(const Simulation& simulation) {
  if (std::exchange(tick_, simulation.tick_index()) == simulation.tick_index()) return;
  std::size_t next = 0;  // as long as nobody leaves, robots come in the order of their first tick
  for (const auto& entity : simulation.entities()) {
    if (!entity->instance.is_robot) continue;
    const std::string& name = entity->instance.name;
    std::size_t index = next++;
    if (index >= robots_.size() || robots_[index].name != name) {
      const auto [known, fresh] = by_name_.emplace(name, robots_.size());
      if (fresh) robots_.push_back({.name = name});
      index = known->second;
    }
    Travel& travel = robots_[index];
    const Vec3 p = simulation.engine().pose(entity->id).p;
    constexpr double cell_m = 0.5;
    const std::pair cell{static_cast<int>(std::floor(p.x / cell_m)),
                         static_cast<int>(std::floor(p.y / cell_m))};
    if (!travel.started) {
      travel.lowest = travel.highest = p;
    } else {
      const Vec3 step = p - travel.last;
      travel.distance_m += std::sqrt(step.x * step.x + step.y * step.y);  // falling is not driving
    }
    travel.last = p;
    for (std::size_t i = 0; i < 3; ++i) {
      travel.lowest[i] = std::min(travel.lowest[i], p[i]);
      travel.highest[i] = std::max(travel.highest[i], p[i]);
    }
    if (std::exchange(travel.started, true) && cell == travel.cell) continue;
    travel.cell = cell;
    const auto place = std::lower_bound(travel.cells.begin(), travel.cells.end(), cell);
    if (place == travel.cells.end() || *place != cell) travel.cells.insert(place, cell);
  }
}

/// x y z [m], roll pitch yaw [rad] of a robot's model frame at the end; null when it is gone.
nlohmann::ordered_json pose_json(const Simulation& simulation, const std::string& robot) {
  const auto id = simulation.find_instance(robot);
  if (!id) return nullptr;
  const Pose X_WM = simulation.engine().pose(*id);
  const Vec3 rpy = rpy_from_quat(X_WM.q);
  return {X_WM.p.x, X_WM.p.y, X_WM.p.z, rpy.x, rpy.y, rpy.z};
}

/// Positions [rad or m] of a robot's moving joints at the end, by name.
nlohmann::ordered_json joints_json(const Simulation& simulation, const std::string& robot) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  const auto id = simulation.find_instance(robot);
  if (!id || !simulation.engine().capabilities().joints) return out;
  const model::Model& model = *simulation.find_entity(robot)->instance.model;
  const auto joints = simulation.engine().joints(*id);
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (model.joints[i].type != model::JointType::fixed)
      out[model.joints[i].name] = simulation.engine().joint_states()[joints[i].index].position;
  return out;
}

std::string hex(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

nlohmann::ordered_json summarise(const Simulation& simulation, const RunReport& report,
                                 const TravelRecorder& travel, const Diagnostics& diagnostics,
                                 const std::vector<Error>& errors) {
  using Json = nlohmann::ordered_json;
  const auto rounded = [](double x, double unit) { return std::round(x / unit) * unit; };
  Json json;
  json["name"] = simulation.setup().name;
  json["physics"] = simulation.setup().engine;
  json["seed"] = simulation.setup().seed;
  json["ticks"] = report.ticks;
  json["sim_seconds"] = report.sim_s;
  json["wall_seconds"] = report.wall_s;
  json["real_time_factor"] = report.wall_s > 0 ? report.sim_s / report.wall_s : 0.0;
  json["late_ticks"] = report.late_ticks;
  if (simulation.setup().clock.mode == model::Clock::Mode::continuous)
    json["step_s"] = {{"mean", report.ticks ? report.sim_s / static_cast<double>(report.ticks) : 0.0},
                      {"min", report.shortest.s()},
                      {"max", report.longest.s()}};
  Json phases;
  const double ticks = static_cast<double>(std::max<std::uint64_t>(report.ticks, 1));
  for (std::size_t i = 0; i < phase_names.size(); ++i)
    phases[phase_names[i]] = rounded(static_cast<double>(simulation.phase_times().ns[i]) * 1e-3 / ticks,
                                     1e-3);
  json["phase_us"] = phases;
  json["end_tick"] = simulation.tick_index();
  json["end_time"] = simulation.now().s();
  json["stopped"] = simulation.stop_reason().value_or("");
  json["state_hash"] = hex(simulation.state_hash());
  Json sub_hashes = Json::object();
  for (const SubHash& sub : simulation.sub_hashes()) sub_hashes[sub.path] = hex(sub.hash);
  json["sub_hashes"] = sub_hashes;
  json["profile"] = Simulation::profile();
  Json robots = Json::array();
  std::map<std::string, std::vector<std::string>> teams;
  for (const model::Instance* instance : simulation.instances())
    if (!instance->team.empty()) teams[instance->team].push_back(instance->name);
  for (const TravelRecorder::Travel& t : travel.robots()) {
    const Vec3 extent = t.highest - t.lowest;
    robots.push_back({{"name", t.name},
                      {"distance_m", rounded(t.distance_m, 1e-3)},
                      {"extent_m", {rounded(extent.x, 1e-3), rounded(extent.y, 1e-3)}},
                      {"covered_m2", 0.25 * static_cast<double>(t.cells.size())},
                      {"pose", pose_json(simulation, t.name)},
                      {"joints", joints_json(simulation, t.name)}});
  }
  json["robots"] = robots;
  const EngineCounters counters = simulation.engine().counters();
  json["engine"] = {{"solver_messages", counters.solver_messages},
                    {"contacts", counters.contacts},
                    {"awake_bodies", counters.awake_bodies}};
  json["refused_commands"] = simulation.refused_commands();
  Json events = Json::array();
  for (const Monitor::Event& event : simulation.monitor().events())
    events.push_back({{"name", event.decl.name},
                      {"count", event.count},
                      {"first", event.count ? Json(event.first.s()) : Json(nullptr)},
                      {"last", event.count ? Json(event.last.s()) : Json(nullptr)}});
  json["events"] = events;
  json["criterion"] = nullptr;
  json["teams"] = Json(teams);
  Json warnings = Json::array(), failures = Json::array();
  for (const Error& warning : diagnostics.warnings) warnings.push_back(warning.text());
  for (const Error& error : errors) failures.push_back(error.text());
  json["warnings"] = warnings;
  json["errors"] = failures;
  return json;
}

std::string as_text(const nlohmann::ordered_json& s) {
  std::string out;
  out += fmt::format("scenario   {} ({}, seed {})\n", s["name"].get<std::string>(),
                     s["physics"].get<std::string>(), s["seed"].get<std::uint64_t>());
  out += fmt::format("simulated  {:.3f} s in {:.3f} s, {:.1f} x real time, {} ticks\n",
                     s["sim_seconds"].get<double>(), s["wall_seconds"].get<double>(),
                     s["real_time_factor"].get<double>(), s["ticks"].get<std::uint64_t>());
  if (s.contains("step_s"))
    out += fmt::format("clock      continuous: steps of {:.3g} ms, from {:.3g} to {:.3g}; {} were cut\n",
                       1e3 * s["step_s"]["mean"].get<double>(), 1e3 * s["step_s"]["min"].get<double>(),
                       1e3 * s["step_s"]["max"].get<double>(), s["late_ticks"].get<std::uint64_t>());
  out += "per tick  ";
  for (const auto& [name, us] : s["phase_us"].items())
    out += fmt::format(" {} {:.1f}", name, us.get<double>());
  out += " us\n";
  std::size_t shown = 0;
  for (const auto& robot : s["robots"]) {
    if (++shown > 12) {
      out += fmt::format("           ... {} robots in all\n", s["robots"].size());
      break;
    }
    out += fmt::format("robot      {}: drove {:.2f} m, covered {:.2f} m^2\n",
                       robot["name"].get<std::string>(), robot["distance_m"].get<double>(),
                       robot["covered_m2"].get<double>());
  }
  for (const auto& event : s["events"]) {
    const auto count = event["count"].get<std::uint64_t>();
    out += fmt::format("event      {}: ", event["name"].get<std::string>());
    if (count == 0) out += "did not happen\n";
    else if (count == 1) out += fmt::format("at {} s\n", event["first"].get<double>());
    else out += fmt::format("{} times, first at {} s\n", count, event["first"].get<double>());
  }
  if (s.contains("recording")) {
    const auto& r = s["recording"];
    out += fmt::format("recording  {}: {} messages, {:.2f} MB\n", r["file"].get<std::string>(),
                       r["messages"].get<std::uint64_t>(), 1e-6 * r["bytes"].get<double>());
  }
  out += fmt::format("stopped    {}\n", s["stopped"].get<std::string>().empty()
                                            ? (s["errors"].empty() ? "by request" : "by an error")
                                            : s["stopped"].get<std::string>());
  out += fmt::format("state      {} ({})\n", s["state_hash"].get<std::string>(),
                     s["profile"].get<std::string>());
  for (const auto& error : s["errors"]) out += fmt::format("error      {}\n", error.get<std::string>());
  return out;
}

}  // namespace sandlot::app
