#include "markers/footprint.h"

namespace sandlot {

bool overlaps(const Marker& marker, const Engine& engine, const model::Model& model, InstanceId id) {
  const auto bodies = engine.bodies(id);
  std::vector<SilhouetteDisc> discs;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Pose& X_WB = engine.states()[bodies[i].index].X_WB;
    for (const model::Collision& collision : model.links[i].collisions) {
      if (!collision.surface.touches) continue;
      const Pose X_WC = X_WB * collision.X_LC;
      const Heights heights = heights_of(collision.shape, X_WC);
      if (heights.empty() || heights.max_m <= 0) continue;
      discs.clear();
      add_silhouette(collision.shape, X_WC, discs);
      if (!discs.empty() && marker.meets(rounded_hull(discs))) return true;
    }
  }
  return false;
}

}  // namespace sandlot
