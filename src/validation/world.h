#pragma once
/// The small worlds of the validations, one line each.
#include <cmath>
#include <string>

#include "base/math.h"
#include "physics/test_world.h"
#include "validation/validation.h"

namespace sandlot::validation {

inline constexpr double g_mps2 = 9.81;
inline constexpr const char* engine_names[] = {"rigid", "planar"};

inline test::World world(const char* engine, Vec3 gravity_mps2 = {0, 0, -g_mps2}) {
  auto kind = find_engine(engine);
  SL_CHECK(kind);
  return test::World(**kind, {}, gravity_mps2);
}

inline model::Surface surface(double mu, double restitution = 0) {
  model::Surface s;
  s.mu = s.mu2 = mu;
  s.restitution = restitution;
  s.restitution_threshold_mps = 0.01;
  return s;
}

/// A body that moves from the start: wrenches for one short step give it its velocity.
inline void kick(test::World& w, InstanceId id, double mass_kg, Vec3 v_mps, double h_s) {
  w.push(id, (mass_kg / h_s) * v_mps);
  w.run(1, h_s);
}

}  // namespace sandlot::validation
