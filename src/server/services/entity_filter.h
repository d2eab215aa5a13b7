#pragma once
/// Filters of entities as simulation_interfaces has them, and what they look at: categories, tags, bounds.
#include <string>
#include <vector>

#include "geometry/bounds.h"
#include "server/services/name_filter.h"
#include "server/services/result.h"

namespace sandlot::server {

/// Category of an entity: the one it was given, or what follows from how it is built.
std::uint8_t category_of(const Simulation::Entity& entity);
/// Whether tags fit a filter. @pre its mode is known
bool fits(const msg::simulation::TagsFilter& filter, const std::vector<std::string>& tags);
/// Of a mode that there is not.
SimResult check(const msg::simulation::TagsFilter& filter);

/// The box around an entity's collisions, or its visuals where it has none, in frame A whose pose is `X_WA`. Empty: it has
/// neither, or has no bounds.
Bounds bounds_in(const Simulation& simulation, const Simulation::Entity& entity, const Pose& X_WA);
/// As a message: high and low corner; of type empty where there are none.
msg::simulation::Bounds bounds_message(const Bounds& bounds);

class EntityFilter {
 public:
  /// Threads   any: it looks at no world. @return a result other than ok: `out` is not usable
  static SimResult compile(const msg::simulation::EntityFilters& filters, EntityFilter& out);
  /// Names of the entities that fit, in creation order. Overlap: their collisions with the bounds.
  std::vector<const Simulation::Entity*> select(const Simulation& simulation) const;

 private:
  bool overlaps(const Simulation& simulation, const Simulation::Entity& entity) const;
  NameFilter name_;
  std::vector<std::uint8_t> categories_;
  msg::simulation::TagsFilter tags_;
  std::uint8_t bounds_ = msg::simulation::Bounds::empty;
  OverlapQuery ball_;         ///< of a sphere
  std::vector<Vec3> hull_W_;  ///< of a box or a hull
};

}  // namespace sandlot::server
