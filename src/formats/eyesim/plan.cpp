#include "formats/eyesim/plan.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "builders/parts.h"
#include "files/resources.h"
#include "files/text.h"
#include "formats/eyesim/paths.h"

namespace sandlot::formats::eyesim {
namespace {

model::Instance fixed(std::string name, model::Model model) {
  model.name = name;
  model.is_static = true;
  model::Instance out;
  out.name = out.original_name = std::move(name);
  out.model = std::make_shared<const model::Model>(std::move(model));
  return out;
}

/// The ground never ends; what is seen of it is the floor, where the plan has one.
Result<model::Instance> ground_of(const Plan& plan, const std::string& file, const ReadOptions& options,
                                  Diagnostics& diagnostics) {
  model::Model ground;
  model::Link link;
  link.name = "link";
  link.collisions.push_back({"collision", {}, Plane{{0, 0, 1}}, {}, {}});
  model::Visual visual{"visual", {}, Plane{{0, 0, 1}}, {}, true, {}};
  if (plan.width_m > 0 && plan.height_m > 0) {
    constexpr double thickness_m = 0.01;
    visual.shape = Box{{plan.width_m, plan.height_m, thickness_m}};
    visual.X_LC.p = {plan.width_m / 2, plan.height_m / 2, -thickness_m / 2};
    visual.material.diffuse = {0.55f, 0.57f, 0.55f, 1};
    visual.material.from_mesh = false;
    if (!plan.texture.empty()) {
      const std::string folder = folder_of(file);
      auto found = find_resource(located(plan.texture, folder, options.path), folder, options.path,
                                 plan.texture_place);
      if (found) {
        visual.material.texture = std::move(*found);
        visual.material.diffuse = {1, 1, 1, 1};
      } else {
        diagnostics.warn(std::move(found.error()));
      }
    }
  }
  link.visuals.push_back(std::move(visual));
  ground.links.push_back(std::move(link));
  return fixed("ground", std::move(ground));
}

model::Instance walls_of(const Plan& plan) {
  model::Model walls;
  const std::uint32_t link = builders::add_link(walls, "link", {});
  for (const Wall& wall : plan.walls) {
    const double dx = wall.x2_m - wall.x1_m, dy = wall.y2_m - wall.y1_m;
    const double length_m = std::sqrt(dx * dx + dy * dy);
    const Pose X_LP{{(wall.x1_m + wall.x2_m) / 2, (wall.y1_m + wall.y2_m) / 2, wall.height_m / 2},
                    quat_from_axis_angle({0, 0, 1}, math::atan2(dy, dx))};
    builders::add_part(walls, link,
                       {.shape = Box{{length_m, wall.thickness_m, wall.height_m}},
                        .X_LP = X_LP,
                        .mass_kg = 1,
                        .color = wall.color});
  }
  return fixed("walls", std::move(walls));
}

/// A ball of the size of a golf ball, as EyeSim's mazes have, and a box.
model::Instance thing(const char* stem, std::size_t number, const Spot& spot, const builders::Part& part) {
  auto model = std::make_shared<model::Model>();
  model->name = stem;
  builders::add_part(*model, builders::add_link(*model, "link", {}), part);
  model::Instance out;
  out.name = out.original_name = std::string(stem) + (number == 0 ? "" : std::to_string(number + 1));
  out.X_WM = {{spot.x_m, spot.y_m, 0}, quat_from_axis_angle({0, 0, 1}, spot.yaw_rad)};
  out.model = std::move(model);
  out.place = spot.place;
  return out;
}

model::Light lamp() {
  model::Light light;
  light.name = "lamp";
  light.X_PLight = {{0, 0, 10}, quat_between({0, 0, -1}, normalised(Vec3{-0.4, 0.25, -1}))};
  light.color = {0.8f, 0.8f, 0.8f, 1};
  light.specular = {0.2f, 0.2f, 0.2f, 1};
  light.cast_shadows = true;
  return light;
}

}  // namespace

Result<WorldContent> world_of(const Plan& plan, const std::string& name, const std::string& file,
                              const ReadOptions& options, Diagnostics& diagnostics) {
  WorldContent out;
  out.world_name = name.empty() ? "world" : name;
  SL_ASSIGN(model::Instance ground, ground_of(plan, file, options, diagnostics));
  out.instances.push_back(std::move(ground));
  if (!plan.walls.empty()) out.instances.push_back(walls_of(plan));
  for (std::size_t i = 0; i < plan.balls.size(); ++i) {
    constexpr double radius_m = 0.02135;  // of a golf ball, the smallest that the rules of golf allow
    out.instances.push_back(thing("ball", i, plan.balls[i],
                                  {.shape = Sphere{radius_m},
                                   .X_LP = {{0, 0, radius_m}, {}},
                                   .mass_kg = 0.0459,
                                   .color = builders::colors::orange}));
  }
  for (std::size_t i = 0; i < plan.boxes.size(); ++i) {
    constexpr double side_m = 0.1;
    out.instances.push_back(thing("box", i, plan.boxes[i],
                                  {.shape = Box{{side_m, side_m, side_m}},
                                   .X_LP = {{0, 0, side_m / 2}, {}},
                                   .mass_kg = 0.2,
                                   .color = builders::colors::wood}));
  }
  out.lights.push_back(lamp());
  return out;
}

}  // namespace sandlot::formats::eyesim
