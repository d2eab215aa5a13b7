#include <cmath>

#include "base/text.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/plan.h"

namespace sandlot::formats::eyesim {
namespace {

/// To a micrometre: decimals that were typed come back as they were.
std::string wld_mm(double m) { return number_text(std::floor(m * 1e6 + 0.5) / 1e3); }
std::string in_255(float share) { return number_text(std::floor(static_cast<double>(share) * 255 + 0.5)); }

bool is_upright(Quat q) { return std::abs(q.x) < 1e-9 && std::abs(q.y) < 1e-9; }

/// The wall along the longer side of a box.
Wall wall_of(const Box& box, const Pose& X_WC, Color color) {
  const bool along_x = box.size_m.x >= box.size_m.y;
  const double length = along_x ? box.size_m.x : box.size_m.y,
               thickness = along_x ? box.size_m.y : box.size_m.x;
  const Vec3 half = rotate(X_WC.q, along_x ? Vec3{length / 2, 0, 0} : Vec3{0, length / 2, 0});
  const Vec3 from = X_WC.p - half, to = X_WC.p + half;
  return {.x1_m = from.x,
          .y1_m = from.y,
          .x2_m = to.x,
          .y2_m = to.y,
          .thickness_m = thickness,
          .height_m = X_WC.p.z + box.size_m.z / 2,
          .color = color,
          .place = {}};
}

std::string wall_line(const Wall& wall) {
  std::string out;
  for (const double each : {wall.x1_m, wall.y1_m, wall.x2_m, wall.y2_m, wall.thickness_m, wall.height_m})
    out += wld_mm(each) + " ";
  return out + in_255(wall.color.r) + " " + in_255(wall.color.g) + " " + in_255(wall.color.b) + "\n";
}

/// Of the visual that lies where the collision does.
Color color_of(const model::Link& link, const model::Collision& collision) {
  for (const model::Visual& each : link.visuals)
    if (each.X_LC == collision.X_LC) return each.material.diffuse;
  return {};
}

bool has_ground(const model::Link& link) {
  for (const model::Collision& each : link.collisions)
    if (std::holds_alternative<Plane>(each.shape)) return true;
  return false;
}

void leave_out(const model::Instance& instance, const char* why, Diagnostics& diagnostics) {
  diagnostics.warn(
      {"'" + instance.name + "' is left out: a world of EyeSim has no " + why, "", instance.place});
}

struct WldWriter {
  Diagnostics& diagnostics;
  std::string floor, walls;

  void add(const model::Instance& instance) {
    if (!instance.model->is_static) return leave_out(instance, "things that move", diagnostics);
    std::vector<Wall> found;
    walls_of_instance(instance, found, diagnostics);
    for (const Wall& each : found) walls += wall_line(each);
    for (const model::Link& link : instance.model->links)
      if (has_ground(link))
        for (const model::Visual& each : link.visuals)
          if (const Box* const box = std::get_if<Box>(&each.shape))
            floor = "floor " + wld_mm(box->size_m.x) + " " + wld_mm(box->size_m.y) + "\n";
  }
};

}  // namespace

void walls_of_instance(const model::Instance& instance, std::vector<Wall>& out, Diagnostics& diagnostics) {
  bool other = false;
  for (const model::Link& link : instance.model->links) {
    const Pose X_WL = instance.X_WM * link.X_ML;
    for (const model::Collision& each : link.collisions) {
      const Pose X_WC = X_WL * each.X_LC;
      const Box* const box = std::get_if<Box>(&each.shape);
      if (box && is_upright(X_WC.q)) out.push_back(wall_of(*box, X_WC, color_of(link, each)));
      else if (!std::holds_alternative<Plane>(each.shape)) other = true;
    }
  }
  if (other) leave_out(instance, "shapes but upright boxes", diagnostics);
}

Result<std::string> wld_of(const model::Setup& setup, Diagnostics& diagnostics) {
  WldWriter writer{diagnostics, {}, {}};
  for (const model::Instance& instance : setup.instances) writer.add(instance);
  if (writer.walls.empty() && writer.floor.empty())
    return Error{"there is neither a wall nor a floor that a .wld file could hold"};
  return writer.floor + writer.walls;
}

}  // namespace sandlot::formats::eyesim
