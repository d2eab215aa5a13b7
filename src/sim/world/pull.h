#pragma once
/// Pulls: springs between a point of a link and a point in the world, as a hand pulls at a body. Light and heavy models are
/// accelerated alike.
///
/// Law      force = m (w^2 (target - point) - 2 w v), w = 2 pi / 1 s, m the mass of the whole instance, v the velocity of the
///          point: critically damped, so that what hangs on it comes to rest at the target within about a second. At most 50 m
///          newtons; gravity goes on, so things hang g / w^2 = 0.25 m below the target.
/// Time     from the tick that takes the request until `hold` later, or until the next request for the same instance.
/// Limits   engine `rigid` only; no torque but that of the force about the centre of mass.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/time.h"
#include "devices/context.h"
#include "elements/request.h"
#include "physics/engine.h"
#include "sim/world/parts.h"

namespace sandlot {

struct Pull {
  std::uint64_t serial = 0;  ///< of the entity
  std::uint32_t link = 0;    ///< index in its model
  Vec3 point_L, target_W;    ///< [m]
  Time until;

  static void state(auto& p, auto&& visit) {
    visit(p.serial);
    visit(p.link);
    visit(p.point_L);
    visit(p.target_W);
    visit(p.until);
  }
};

/// Longest duration of a pull, so that the request of a client that is gone ends by itself [s].
inline constexpr double longest_pull_s = 10;

double mass_kg(const model::Model& model);

/// The force of a pull now, as a wrench at the link's centre of mass.
Wrench wrench_of(const Pull& pull, BodyId body, const BodyState& state, const model::Link& link,
                 double mass_kg);

/// The pulls at the entities of a world: State.
class Pulls {
 public:
  using Entity = SimulationParts::Entity;

  /// Begins, renews or ends the pull at an entity.
  Status start(const Entity& entity, const PullRequest& request, Time now);
  /// Ends the pull at an entity that is removed.
  void remove(const Entity& entity);
  /// Adds the forces of all pulls to a sub-step's wrenches. @param begin  of the tick
  void add_wrenches(std::span<const Owned<Entity>> entities, const Engine& engine, Time begin,
                    Actuation& actuation);

  bool empty() const { return pulls_.empty(); }
  void save(ByteWriter& w) const;
  /// Reads to the end. @return false: the bytes do not fit these entities
  bool load(std::span<const Owned<Entity>> entities, ByteReader& r);

 private:
  std::vector<Pull> pulls_;  ///< those that are over stay until the next tick
};

}  // namespace sandlot
