#include <cmath>

#include "base/text.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/plan.h"

namespace sandlot::formats::eyesim {
namespace {

/// To a micrometre: decimals that were typed come back as they were.
std::string in_mm(double m) { return number_text(std::floor(m * 1e6 + 0.5) / 1e3); }
std::string in_255(float share) { return number_text(std::floor(static_cast<double>(share) * 255 + 0.5)); }

bool is_upright(Quat q) { return std::abs(q.x) < 1e-9 && std::abs(q.y) < 1e-9; }

/// The line of a wall, along the longer side of the box.
std::string wall_line(const Box& box, const Pose& X_WC, Color color) {
  const bool along_x = box.size_m.x >= box.size_m.y;
  const double length = along_x ? box.size_m.x : box.size_m.y,
               thickness = along_x ? box.size_m.y : box.size_m.x;
  const Vec3 half = rotate(X_WC.q, along_x ? Vec3{length / 2, 0, 0} : Vec3{0, length / 2, 0});
  const Vec3 from = X_WC.p - half, to = X_WC.p + half;
  std::string out;
  for (const double each : {from.x, from.y, to.x, to.y, thickness, X_WC.p.z + box.size_m.z / 2})
    out += in_mm(each) + " ";
  return out + in_255(color.r) + " " + in_255(color.g) + " " + in_255(color.b) + "\n";
}

struct Writer {
  Diagnostics& diagnostics;
  std::string floor, walls;

  void leave_out(const model::Instance& instance, const char* why) const {
    diagnostics.warn({"'" + instance.name + "' is left out: a .wld file has no " + why, "", instance.place});
  }

  void add(const model::Instance& instance) {
    if (!instance.model->is_static) return leave_out(instance, "things that move");
    bool other = false;
    for (const model::Link& link : instance.model->links) {
      const Pose X_WL = instance.X_WM * link.X_ML;
      bool ground = false;
      for (const model::Collision& each : link.collisions) {
        const Pose X_WC = X_WL * each.X_LC;
        const Box* const box = std::get_if<Box>(&each.shape);
        if (std::holds_alternative<Plane>(each.shape)) ground = true;
        else if (box && is_upright(X_WC.q)) walls += wall_line(*box, X_WC, color_of(link, each));
        else other = true;
      }
      for (const model::Visual& each : link.visuals)
        if (const Box* const box = std::get_if<Box>(&each.shape); box && ground)
          floor = "floor " + in_mm(box->size_m.x) + " " + in_mm(box->size_m.y) + "\n";
    }
    if (other) leave_out(instance, "shapes but upright boxes");
  }

  /// Of the visual that lies where the collision does.
  static Color color_of(const model::Link& link, const model::Collision& collision) {
    for (const model::Visual& each : link.visuals)
      if (each.X_LC == collision.X_LC) return each.material.diffuse;
    return {};
  }
};

}  // namespace

Result<std::string> wld_of(const model::Setup& setup, Diagnostics& diagnostics) {
  Writer writer{diagnostics, {}, {}};
  for (const model::Instance& instance : setup.instances) writer.add(instance);
  if (writer.walls.empty() && writer.floor.empty())
    return Error{"there is neither a wall nor a floor that a .wld file could hold"};
  return writer.floor + writer.walls;
}

}  // namespace sandlot::formats::eyesim
