/// wind: air that moves everywhere with one velocity and pushes what is free to move.
///
/// Force      0.5 density drag_coefficient A |u| u on each link, at its centre of mass, with u the velocity of the air relative
///            to the link's origin and A the area of the box about the link's collisions as seen along u.
/// Limits     no shelter behind others, no gusts, no moment; links inside one another each count. On the planar engine the
///            vertical part has no effect.
/// Cost       a few dozen operations per moving link and sub-step.
#include <unordered_map>

#include "geometry/bounds.h"
#include "media/medium.h"

namespace sandlot::media::wind {
namespace {

struct Spec {
  Vec3 velocity_mps{1, 0, 0};
  double density_kgpm3 = 1.225;
  double drag_coefficient = 1.05;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"velocity", "m/s", "Velocity of the air in the world: x y z.", -1e3, 1e3, Field::tunable},
          s.velocity_mps);
    visit(Field{"density", "kg/m^3", "Density of the air.", 0, 1e5, Field::tunable}, s.density_kgpm3);
    visit(Field{"drag_coefficient", "1", "Drag coefficient of all things; a cube has 1.05.", 0, 100,
                Field::tunable},
          s.drag_coefficient);
  }
};

/// Areas of the box about a link's collisions, seen along the axes of the link.
struct Areas {
  double x_m2 = 0, y_m2 = 0, z_m2 = 0;
};

Areas areas_of(const model::Link& link) {
  Bounds bounds;
  for (const model::Collision& each : link.collisions) bounds.include(bounds_of(each.shape, each.X_LC));
  if (bounds.empty()) return {};
  const Vec3 size = bounds.high - bounds.low;
  return {size.y * size.z, size.x * size.z, size.x * size.y};
}

struct Wind {
  using Spec = wind::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  /// Per model, its links' areas: they follow from the model alone.
  std::unordered_map<const model::Model*, std::pair<std::shared_ptr<const model::Model>, std::vector<Areas>>>
      areas;

  Status init(const ElementBuild&) { return {}; }

  const std::vector<Areas>& areas_of_model(const std::shared_ptr<const model::Model>& model) {
    auto& [kept, found] = areas[model.get()];
    if (!kept) {
      kept = model;  // its address stays its own
      for (const model::Link& link : model->links) found.push_back(areas_of(link));
    }
    return found;
  }

  void push(const MediumContext& context, double, std::vector<Wrench>& wrenches) {
    const Engine& engine = context.world.engine();
    const auto states = engine.states();
    for (const EntityView& entity : context.world.entities()) {
      if (entity.instance->model->is_static || entity.instance->motion) continue;
      const std::vector<Areas>& links = areas_of_model(entity.instance->model);
      const auto bodies = engine.bodies(entity.id);
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyState& body = states[bodies[i].index];
        const Vec3 u_W = spec.velocity_mps - body.V_WB.linear;
        const double speed = norm(u_W);
        if (!(speed > 0)) continue;
        const Vec3 way_L = rotate(conjugate(body.X_WB.q), u_W) * (1 / speed);
        const double area_m2 = links[i].x_m2 * std::abs(way_L.x) + links[i].y_m2 * std::abs(way_L.y) +
                               links[i].z_m2 * std::abs(way_L.z);
        const double factor = 0.5 * spec.density_kgpm3 * spec.drag_coefficient * area_m2 * speed;
        if (factor > 0) wrenches.push_back({bodies[i], u_W * factor, {}});
      }
    }
  }
};

}  // namespace

extern const MediumKind kind;
constinit const MediumKind kind = make_medium<Wind>({
    .name = "wind",
    .help = "Air that moves everywhere with one velocity and pushes what is free to move.",
});

}  // namespace sandlot::media::wind
