#include "draw/run_drawing.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/math.h"
#include "messages/messages.h"

namespace sandlot::draw {
namespace {

constexpr std::size_t max_path_points = 20'000;
constexpr double jump_m = 0.5;  // a longer step in one tick is a change of pose from outside

Pose sensor_pose(const Simulation& simulation, const Simulation::Entity& entity,
                 const Simulation::Device& device) {
  const BodyId body = simulation.engine().bodies(entity.id)[device.decl.link];
  return simulation.engine().states()[body.index].X_WB * device.decl.X_LS;
}

Plan::Scan to_scan(const msg::LaserScan& scan, const Pose& X_WS) {
  Plan::Scan out;
  out.origin_m = X_WS.p;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double angle = static_cast<double>(scan.angle_min) +
                         static_cast<double>(i) * static_cast<double>(scan.angle_increment);
    const auto range = static_cast<double>(scan.ranges[i]);
    // +inf: free up to the end; -inf and NaN: nothing known beyond the sensor itself.
    const bool hit = std::isfinite(range);
    const double reach = hit ? range : range > 0 ? static_cast<double>(scan.range_max) : 0.0;
    const math::SinCos a = math::sincos(angle);
    out.ends_m.push_back(X_WS * Vec3{reach * a.cos, reach * a.sin, 0});
    out.hit.push_back(hit);
  }
  return out;
}

/// Visuals of an instance; its collision shapes in grey for links without visuals.
void add_solids(const Simulation& simulation, const Simulation::Entity& entity,
                std::vector<Plan::Solid>& out) {
  const model::Model& model = *entity.instance.model;
  const auto bodies = simulation.engine().bodies(entity.id);
  const auto states = simulation.engine().states();
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    const model::Link& link = model.links[l];
    const Pose X_WL = states[bodies[l].index].X_WB;
    for (const model::Visual& visual : link.visuals)
      out.push_back({visual.shape, X_WL * visual.X_LC, visual.material.diffuse, !model.is_static});
    if (!link.visuals.empty()) continue;
    for (const model::Collision& collision : link.collisions)
      out.push_back({collision.shape, X_WL * collision.X_LC, {}, !model.is_static});
  }
}

}  // namespace

void RunDrawing::Path::add(Vec3 point) {
  const bool jumped = points > 0 && norm(point - last) > jump_m;
  if (!jumped && points > 0) driven_m += norm(point - last);
  if (jumped || points == 0) parts.emplace_back();
  last = point;
  std::vector<Vec3>& part = parts.back();
  if (!part.empty() && norm(point - part.back()) < spacing_m) return;
  part.push_back(point);
  if (++points < max_path_points) return;
  spacing_m *= 2;
  points = 0;
  for (std::vector<Vec3>& thinned : parts) {
    for (std::size_t i = 0; 2 * i < thinned.size(); ++i) thinned[i] = thinned[2 * i];
    thinned.resize((thinned.size() + 1) / 2);
    points += thinned.size();
  }
}

RunDrawing::RunDrawing(const Simulation& simulation) : simulation_(simulation) {
  for (const auto& entity : simulation.entities())
    if (entity->instance.is_robot) paths_[entity->instance.name].add(simulation.engine().pose(entity->id).p);
  note_scans();
}

void RunDrawing::on_frame(const std::shared_ptr<const Frame>& frame) {
  for (const FrameInstance& instance : frame->instances)
    if (instance.is_robot) paths_[instance.name].add(instance.X_WM.p);
  note_scans();
}

void RunDrawing::note_scans() {
  for (const auto& entity : simulation_.entities())
    for (const auto& device : entity->devices)
      for (const Simulation::Slot& slot : device->topics)
        if (topic_cast<msg::LaserScan>(slot.topic.get()) && slot.topic->count > 0 &&
            slot.topic->stamp == simulation_.now())
          scan_poses_[slot.topic.get()] = {simulation_.now(), sensor_pose(simulation_, *entity, *device)};
}

std::vector<Plan::Scan> RunDrawing::scans_of(const Simulation::Entity& entity) const {
  std::vector<Plan::Scan> scans;
  for (const auto& device : entity.devices)
    for (const Simulation::Slot& slot : device->topics) {
      const auto* const scan = topic_cast<msg::LaserScan>(slot.topic.get());
      if (!scan || scan->count == 0) continue;
      const auto noted = scan_poses_.find(scan);
      const bool known = noted != scan_poses_.end() && noted->second.stamp == scan->stamp;
      scans.push_back(
          to_scan(scan->message, known ? noted->second.X_WS : sensor_pose(simulation_, entity, *device)));
    }
  return scans;
}

Plan RunDrawing::plan() const {
  const model::Setup& setup = simulation_.setup();
  Plan plan;
  plan.title = setup.name;
  plan.subtitle = fmt::format("{} physics, seed {}, {:.1f} s simulated", setup.engine, setup.seed,
                              simulation_.now().s());
  for (const auto& entity : simulation_.entities()) {
    if (!entity->instance.is_robot) {
      add_solids(simulation_, *entity, plan.solids);
      for (const model::Link& link : entity->instance.model->links)
        for (const model::Visual& visual : link.visuals)
          if (std::holds_alternative<Plane>(visual.shape)) plan.ground = visual.material.diffuse;
      continue;
    }
    Plan::Robot robot;
    robot.name = entity->instance.original_name;
    robot.X_WB = simulation_.engine().pose(entity->id);
    add_solids(simulation_, *entity, robot.solids);
    robot.scans = scans_of(*entity);
    if (const auto path = paths_.find(entity->instance.name); path != paths_.end()) {
      robot.path = path->second.parts;
      robot.path.back().push_back(path->second.last);
      robot.driven_m = path->second.driven_m;
    }
    plan.robots.push_back(std::move(robot));
  }
  return plan;
}

}  // namespace sandlot::draw
