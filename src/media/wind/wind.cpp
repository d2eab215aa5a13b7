/// wind: air that moves everywhere with one velocity and pushes what is free to move.
///
/// Force      0.5 density drag_coefficient A |u| u on each link, at its centre of mass, with u the velocity of the air relative
///            to the link's origin and A the area of the box about the link's collisions as seen along u.
/// Limits     no shelter behind others, no gusts, no moment; links inside one another each count. On the planar engine the
///            vertical part has no effect.
/// Cost       a few dozen operations per moving link and sub-step, on all threads.
#include <algorithm>
#include <atomic>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/bounds.h"
#include "media/medium.h"
#include "physics/parallel.h"

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
  std::vector<std::vector<Wrench>> blocks;  ///< of one sub-step, kept for their memory

  Status init(const ElementBuild&) { return {}; }

  void learn(const std::shared_ptr<const model::Model>& model) {
    auto& [kept, found] = areas[model.get()];
    if (kept) return;
    kept = model;  // its address stays its own
    for (const model::Link& link : model->links) found.push_back(areas_of(link));
  }

  /// Adds the forces on an entity. @return false: its model is not known yet
  bool push_one(const Engine& engine, const EntityView& entity, std::vector<Wrench>& wrenches) const {
    if (entity.instance->model->is_static || entity.instance->motion) return true;
    const auto known = areas.find(entity.instance->model.get());
    if (known == areas.end()) return false;
    const std::vector<Areas>& links = known->second.second;
    const auto states = engine.states();
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
    return true;
  }

  void push(const MediumContext& context, double, std::vector<Wrench>& wrenches) {
    constexpr std::size_t in_block = 64;
    const Engine& engine = context.world.engine();
    const std::span<const EntityView> entities = context.world.entities();
    if (parallel_threads() == 1) {
      for (const EntityView& entity : entities)
        if (!push_one(engine, entity, wrenches)) {
          learn(entity.instance->model);
          push_one(engine, entity, wrenches);
        }
      return;
    }
    blocks.resize((entities.size() + in_block - 1) / in_block);
    std::atomic<bool> all_known = false;
    while (!all_known) {
      all_known = true;
      parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          blocks[b].clear();
          for (std::size_t i = b * in_block; i < std::min((b + 1) * in_block, entities.size()); ++i)
            if (!push_one(engine, entities[i], blocks[b])) all_known = false;
        }
      });
      if (!all_known)
        for (const EntityView& entity : entities) learn(entity.instance->model);
    }
    // In the order of the entities, whoever has computed what.
    for (const std::vector<Wrench>& block : blocks)
      wrenches.insert(wrenches.end(), block.begin(), block.end());
  }
};

}  // namespace

extern const MediumKind kind;
constinit const MediumKind kind = make_medium<Wind>({
    .name = "wind",
    .help = "Air that moves everywhere with one velocity and pushes what is free to move.",
});

}  // namespace sandlot::media::wind
