#pragma once
/// A spring between a point of a link and a point in the world, as a hand pulls at things: it accelerates light and heavy
/// things alike.
///
/// Law      force = m (w^2 (target - point) - 2 w v), w = 2 pi / 1 s, m the mass of the whole instance, v the velocity of the point:
///          critically damped, so that what hangs on it comes to rest at the target within about a second. At most 50 m
///          newtons; gravity goes on, so things hang g / w^2 = 0.25 m below the target.
/// Time     from the tick that takes the request until `hold` later, or until the next request for the same instance.
/// Limits   engine `rigid` only; no torque but that of the force about the centre of mass.
#include <cstdint>
#include <vector>

#include "base/fields.h"
#include "base/time.h"
#include "physics/engine.h"

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

/// Longest a pull may last: a request of somebody who is gone does not pull for ever.
inline constexpr double longest_pull_s = 10;

/// A device that somebody drives from outside: the robot's own controllers are not heard by it until then.
struct Hold {
  std::uint64_t device = 0;  ///< its key
  Time until;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"device", "1", "Key of the device."}, s.device);
    visit(Field{"until", "s", "Time at which commands of programs take effect again."}, s.until);
  }
};
/// From each command on [s].
inline constexpr double held_s = 0.5;

double mass_kg(const model::Model& model);

/// The force of a pull now, as a wrench at the link's centre of mass.
Wrench wrench_of(const Pull& pull, BodyId body, const BodyState& state, const model::Link& link,
                 double mass_kg);

}  // namespace sandlot
