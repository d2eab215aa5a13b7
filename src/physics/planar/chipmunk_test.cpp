/// The planar engine against Chipmunk 7 (S. Lembcke), an engine by others for the same bodies: what both
/// compute from the same start has to agree, and with the closed form where there is one.
///
/// Neither finds a collision at its exact time: each looks at most one sub-step's way v h too early or too
/// late, so directions and arms of an oblique hit are off by v h / (distance of centres). The bounds say so
/// at each place.
#include <chipmunk/chipmunk.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/math.h"
#include "physics/planar/turn.h"
#include "physics/test_world.h"

namespace sandlot::planar {
namespace {

using namespace sandlot::test;

/// A disc (y = 0) or a box, free to move.
struct Thing {
  double mass_kg, x_m, y_m;  ///< size: radius and 0, or both edges
  Vec2 at;
  double heading_rad = 0;
  Vec2 v;
  double w_radps = 0;
  double inertia_kgm2() const {
    return y_m == 0 ? mass_kg * x_m * x_m / 2 : mass_kg * (x_m * x_m + y_m * y_m) / 12;
  }
};

struct Motion {
  Vec2 at, v;
  double heading_rad, w_radps;
};

struct Law {
  double restitution = 0, mu = 0;
};

class Ours {
 public:
  World world{*find_engine("planar").value(), {}, {0, 0, 0}};
  model::Surface surface;

  explicit Ours(const Law& law) {
    surface.mu = surface.mu2 = law.mu;
    surface.restitution = law.restitution;
    surface.restitution_threshold_mps = 0;
  }
  void add(const Thing& t, double h_s) {
    const Shape shape = t.y_m == 0 ? Shape(Cylinder{t.x_m, 0.2}) : Shape(Box{{t.x_m, t.y_m, 0.2}});
    ids.push_back(world.add(body_of("b" + std::to_string(ids.size()), shape, t.mass_kg,
                                    {{t.at.x, t.at.y, 0}, quat_from_rpy(0, 0, t.heading_rad)}, surface)));
    // The velocity comes by an impulse in the first sub-step, which moves the body with it at once, as
    // Chipmunk does.
    const double per_s = 1 / h_s;
    world.push(ids.back(), {per_s * t.mass_kg * t.v.x, per_s * t.mass_kg * t.v.y, 0},
               {0, 0, per_s * t.inertia_kgm2() * t.w_radps});
  }
  void wall(Vec2 at, Vec2 size) {
    world.add(static_of("wall", Box{{size.x, size.y, 0.2}}, {{at.x, at.y, 0}, {}}, surface));
  }
  void push(std::size_t i, Vec2 force) { world.push(ids[i], {force.x, force.y, 0}); }
  void step(double h_s) { world.run(1, h_s); }
  Motion of(std::size_t i) const {
    const BodyState& s = world.state(ids[i]);
    return {{s.X_WB.p.x, s.X_WB.p.y}, {s.V_WB.linear.x, s.V_WB.linear.y}, yaw_of(s.X_WB.q), s.V_WB.angular.z};
  }
  std::vector<InstanceId> ids;
};

class Theirs {
 public:
  explicit Theirs(const Law& law) : law_(law) {
    cpSpaceSetIterations(space_.get(), 30);
    cpSpaceSetCollisionSlop(space_.get(), 1e-4);  // what ours allows
  }
  void add(const Thing& t, double) {
    cpBody* const body = cpBodyNew(t.mass_kg, t.inertia_kgm2());
    keep(body);
    cpBodySetPosition(body, cpv(t.at.x, t.at.y));
    cpBodySetAngle(body, t.heading_rad);
    cpBodySetVelocity(body, cpv(t.v.x, t.v.y));
    cpBodySetAngularVelocity(body, t.w_radps);
    keep(t.y_m == 0 ? cpCircleShapeNew(body, t.x_m, cpvzero) : cpBoxShapeNew(body, t.x_m, t.y_m, 0));
  }
  void wall(Vec2 at, Vec2 size) {
    keep(cpBoxShapeNew2(cpSpaceGetStaticBody(space_.get()),
                        cpBBNew(at.x - size.x / 2, at.y - size.y / 2, at.x + size.x / 2, at.y + size.y / 2),
                        0));
  }
  /// A hinge between two things at a point.
  void pivot(std::size_t a, std::size_t b, Vec2 at) {
    joints_.emplace_back(cpPivotJointNew(bodies_[a].get(), bodies_[b].get(), cpv(at.x, at.y)));
    cpSpaceAddConstraint(space_.get(), joints_.back().get());
  }
  /// These two do not collide.
  void hold_apart(std::size_t a, std::size_t b) {
    for (const auto& shape : shapes_)
      for (const std::size_t i : {a, b})
        if (cpShapeGetBody(shape.get()) == bodies_[i].get())
          cpShapeSetFilter(shape.get(), cpShapeFilterNew(1, CP_ALL_CATEGORIES, CP_ALL_CATEGORIES));
  }
  void push(std::size_t i, Vec2 force, double torque = 0) {
    cpBody* const body = bodies_[i].get();
    cpBodySetForce(body, cpv(force.x, force.y));
    cpBodySetTorque(body, torque);
  }
  /// What a thing bears of contacts with what stands, in the last step.
  Vec2 force_below(std::size_t i, double h_s) const {
    struct Sum {
      cpBody* still;
      cpVect impulse;
    } sum{cpSpaceGetStaticBody(space_.get()), cpvzero};
    cpBodyEachArbiter(
        bodies_[i].get(),
        [](cpBody* body, cpArbiter* arbiter, void* data) {
          cpBody *a = nullptr, *b = nullptr;
          cpArbiterGetBodies(arbiter, &a, &b);
          Sum& all = *static_cast<Sum*>(data);
          if ((a == body ? b : a) == all.still)
            all.impulse = cpvadd(all.impulse, cpArbiterTotalImpulse(arbiter));
        },
        &sum);
    return {sum.impulse.x / h_s, sum.impulse.y / h_s};
  }
  void step(double h_s) { cpSpaceStep(space_.get(), h_s); }
  Motion of(std::size_t i) const {
    const cpBody* const body = bodies_[i].get();
    const cpVect p = cpBodyGetPosition(body), v = cpBodyGetVelocity(body);
    return {{p.x, p.y}, {v.x, v.y}, cpBodyGetAngle(body), cpBodyGetAngularVelocity(body)};
  }

 private:
  template <auto Free>
  struct By {
    void operator()(auto* x) const { Free(x); }
  };
  void keep(cpBody* body) {
    bodies_.emplace_back(body);
    cpSpaceAddBody(space_.get(), body);
  }
  void keep(cpShape* shape) {
    shapes_.emplace_back(shape);
    cpShapeSetElasticity(shape, std::sqrt(law_.restitution));  // Chipmunk multiplies those of both
    cpShapeSetFriction(shape, std::sqrt(law_.mu));
    cpSpaceAddShape(space_.get(), shape);
  }
  Law law_;
  // The space goes first: it looks at none of them when it is freed.
  std::vector<std::unique_ptr<cpBody, By<cpBodyFree>>> bodies_;
  std::vector<std::unique_ptr<cpShape, By<cpShapeFree>>> shapes_;
  std::vector<std::unique_ptr<cpConstraint, By<cpConstraintFree>>> joints_;
  std::unique_ptr<cpSpace, By<cpSpaceFree>> space_{cpSpaceNew()};
};

/// Runs things that nobody pushes on an engine, for some time.
template <class Engine>
std::vector<Motion> after(const Law& law, const std::vector<Thing>& things, double time_s, double h_s) {
  Engine engine(law);
  for (const Thing& t : things) engine.add(t, h_s);
  for (int i = 0; i < static_cast<int>(std::lround(time_s / h_s)); ++i) engine.step(h_s);
  std::vector<Motion> out;
  for (std::size_t i = 0; i < things.size(); ++i) out.push_back(engine.of(i));
  return out;
}

struct Sums {
  Vec2 momentum;
  double angular = 0, energy = 0;
};
Sums sums(const std::vector<Thing>& things, const std::vector<Motion>& motions) {
  Sums s;
  for (std::size_t i = 0; i < things.size(); ++i) {
    const Thing& t = things[i];
    const Motion& m = motions[i];
    s.momentum = s.momentum + t.mass_kg * m.v;
    s.angular += t.mass_kg * (m.at.x * m.v.y - m.at.y * m.v.x) + t.inertia_kgm2() * m.w_radps;
    s.energy += 0.5 * t.mass_kg * dot(m.v, m.v) + 0.5 * t.inertia_kgm2() * m.w_radps * m.w_radps;
  }
  return s;
}

TEST(AgainstChipmunk, HeadOnDiscsOfUnequalMass) {
  for (const double e : {0.0, 0.5, 0.95, 1.0}) {
    SCOPED_TRACE(e);
    const std::vector<Thing> things{{1, 0.1, 0, {-0.3, 0}, 0, {1, 0}}, {3, 0.1, 0, {0.3, 0}, 0, {-0.5, 0}}};
    const Law law{.restitution = e};
    // v' = centre's velocity -+ e (share of the other) times the approach; what is lost is the reduced mass's
    // part.
    const double centre = (1 * 1.0 + 3 * -0.5) / 4, v0 = centre - e * 0.75 * 1.5,
                 v1 = centre + e * 0.25 * 1.5;
    const double lost = 0.5 * 0.75 * 1.5 * 1.5 * (1 - e * e);
    for (const auto& motions : {after<Ours>(law, things, 0.5, 0.01), after<Theirs>(law, things, 0.5, 0.01)}) {
      // One contact is solved exactly whenever it is found: rounding alone.
      EXPECT_NEAR(motions[0].v.x, v0, 1e-9);
      EXPECT_NEAR(motions[1].v.x, v1, 1e-9);
      EXPECT_NEAR(sums(things, motions).momentum.x, -0.5, 1e-12);
      EXPECT_NEAR(sums(things, motions).energy, 0.5 * 1 + 0.5 * 3 * 0.25 - lost, 1e-9);
    }
  }
}

TEST(AgainstChipmunk, ObliqueDiscsWithFrictionSpin) {
  const double h_s = 1e-4;
  for (const double mu : {0.0, 0.1, 2.0}) {
    SCOPED_TRACE(mu);
    // They meet with the line of centres turned by 30 degrees: y = 0.2 sin 30.
    const std::vector<Thing> things{{1, 0.08, 0, {-0.4, 0}, 0, {1, 0}}, {2.5, 0.12, 0, {0.1, 0.1}, 0, {}, 3}};
    const Law law{.restitution = 0.6, .mu = mu};
    // Closed form: normal impulse (1 + e) m vn; along the surface what makes it stick, m vt / 3 for two discs
    // (each weighs 1/3 at its rim), or mu times the normal one. vt counts the rim's spin.
    const Vec2 n{std::sqrt(0.75), 0.5}, t{-0.5, std::sqrt(0.75)};
    const double reduced = 1 * 2.5 / 3.5;
    const double normal = 1.6 * reduced * n.x;
    const double slide = -dot(Vec2{1, 0}, t) + (0.0 - 0.12 * 3);  // of b's surface seen from a's
    const double stick = reduced * slide / 3;
    const double along = std::clamp(stick, -mu * normal, mu * normal);
    const Vec2 va = Vec2{1, 0} - normal * n + along * t, vb = (1 / 2.5) * (normal * n - along * t);
    const double wa = 0.08 * along / things[0].inertia_kgm2(),
                 wb = 3 + 0.12 * along / things[1].inertia_kgm2();
    // The line of centres is off by v h / 0.2 / cos 30 = 6e-4 at most; spins feel that divided by a radius'
    // share.
    const double off = 1.5e-3;
    for (const auto& motions : {after<Ours>(law, things, 0.5, h_s), after<Theirs>(law, things, 0.5, h_s)}) {
      EXPECT_NEAR(motions[0].v.x, va.x, off);
      EXPECT_NEAR(motions[0].v.y, va.y, off);
      EXPECT_NEAR(motions[1].v.x, vb.x, off);
      EXPECT_NEAR(motions[1].v.y, vb.y, off);
      EXPECT_NEAR(motions[0].w_radps, wa, off / 0.04);
      EXPECT_NEAR(motions[1].w_radps, wb, off / 0.04);
      EXPECT_NEAR(sums(things, motions).momentum.x, 1, 1e-12);
      EXPECT_NEAR(sums(things, motions).momentum.y, 0, 1e-12);
    }
  }
}

TEST(AgainstChipmunk, ACornerThatHitsAFaceSpinsBothBoxes) {
  const double h_s = 1e-4, s = 0.2;
  // The corner of a square that is turned by 60 degrees, (0.1 + 0.1 sqrt 3) / 2 ahead and (0.1 sqrt 3 - 0.1)
  // / 2 aside of its middle (its corner (0.1, -0.1) turned), hits the face of another, 0.05 below the middle
  // of that.
  const double ahead = 0.05 + 0.1 * std::sqrt(0.75), aside = 0.1 * std::sqrt(0.75) - 0.05;
  const std::vector<Thing> things{{1, s, s, {-0.5, -0.05 - aside}, math::pi / 3, {1, 0}},
                                  {2, s, s, {0, 0}, 0, {}}};
  const Law law{.restitution = 0.7};
  // J = (1 + e) vn / (1/ma + 1/mb + arm_a^2 / Ia + arm_b^2 / Ib), along x; arms across x.
  const double ia = things[0].inertia_kgm2(), ib = things[1].inertia_kgm2();
  const double j = 1.7 / (1 + 0.5 + aside * aside / ia + 0.05 * 0.05 / ib);
  for (const auto& motions : {after<Ours>(law, things, 0.45, h_s), after<Theirs>(law, things, 0.45, h_s)}) {
    // The first box does not turn on its way and the face is flat, so arms do not depend on the time of the
    // hit.
    EXPECT_NEAR(motions[0].v.x, 1 - j, 1e-9);
    EXPECT_NEAR(motions[0].v.y, 0, 1e-9);
    EXPECT_NEAR(motions[0].w_radps, aside * j / ia, 1e-7);
    EXPECT_NEAR(motions[1].v.x, j / 2, 1e-9);
    EXPECT_NEAR(motions[1].w_radps, 0.05 * j / ib, 1e-7);
  }
  EXPECT_GT(ahead, 0.1);
}

TEST(AgainstChipmunk, ARackIsBroken) {
  const double r = 0.028, m = 0.17, gap = 0.002, h_s = 2e-5;
  std::vector<Thing> things{{m, r, 0, {-0.3, 0.004}, 0, {3, 0}}};
  for (int row = 0; row < 5; ++row)
    for (int k = 0; k <= row; ++k) {
      const double spacing = 2 * r + gap;
      things.push_back({m, r, 0, {row * spacing * std::sqrt(0.75), (k - 0.5 * row) * spacing}});
    }
  const Law law{.restitution = 0.95};
  const std::vector<Motion> ours = after<Ours>(law, things, 0.16, h_s),
                            theirs = after<Theirs>(law, things, 0.16, h_s);
  double apart = 0, moved = 0;
  for (std::size_t i = 0; i < things.size(); ++i) {
    const Vec2 d = ours[i].at - theirs[i].at, way = ours[i].at - things[i].at;
    apart = std::max(apart, std::sqrt(dot(d, d)));
    moved = std::max(moved, std::sqrt(dot(way, way)));
  }
  // The balls have met some 30 times and fly apart, the last has left the rack. Each hit turns an error of
  // the place, v h = 6e-5 of either engine, into one of direction of that over 2 r = 1e-3, and through the
  // gaps of 2 mm the next inherits it almost unchanged: 1e-3 of the way of 0.23 m. With gaps as wide as the
  // balls it would double at each hit.
  EXPECT_GT(moved, 0.2);
  EXPECT_LT(apart, 0.001);
  const Sums a = sums(things, ours), b = sums(things, theirs);
  for (const Sums& s : {a, b}) {
    EXPECT_NEAR(s.momentum.x, 3 * m, 1e-12);
    EXPECT_NEAR(s.momentum.y, 0, 1e-12);
  }
  // Before it is 0.765 J; a fifth goes.
  EXPECT_NEAR(a.energy, 0.6, 0.01);
  EXPECT_NEAR(a.energy, b.energy, 0.001 * b.energy);
}

TEST(AgainstChipmunk, ABoxSlidesAlongAWallUntilFrictionHasStoppedIt) {
  const double h_s = 0.001, mu = 0.3, press_N = 10, mass = 2, v = 1;
  const Law law{.mu = mu};
  const Thing box{mass, 0.4, 0.1, {0, 0.0501}, 0, {v, 0}};
  const auto run = [&](auto&& engine, double time_s) {
    engine.wall({0, -0.1}, {4, 0.2});
    engine.add(box, h_s);
    for (int i = 0; i < static_cast<int>(time_s / h_s); ++i) {
      engine.push(0, {0, -press_N});
      engine.step(h_s);
    }
    return engine.of(0);
  };
  // m a = mu N: it stops after m v / (mu N) = 0.667 s and half that way; a sub-step more or less at full
  // speed, and the 0.1 mm to the wall, which it falls through in sqrt(2 * 1e-4 / 5) = 6 ms without friction.
  const double stop_m = mass * v * v / (2 * mu * press_N);
  for (const Motion& m : {run(Ours(law), 1.0), run(Theirs(law), 1.0)}) {
    EXPECT_NEAR(m.at.x, stop_m, v * (h_s + 0.0064));
    EXPECT_NEAR(m.v.x, 0, 1e-6);
    EXPECT_NEAR(m.heading_rad, 0, 1e-3);
  }
}

TEST(AgainstChipmunk, APileIsPressedByAPivotedArm) {
  // A lever of 1 m along x, hinged at its left end to a base that nothing moves (1e6 kg), pressed down at its
  // right end by 10 N; 0.25 m from the hinge it lies on a pile of three discs in a shaft without friction: 40
  // N go down the pile.
  const double h_s = 0.001, r = 0.05, force_N = 10, arm = 0.25;
  const double heavy = 1e6, top = 6 * r;
  const Thing base{heavy, 0.1, 0.1, {-0.05, top + 0.025}};
  const Thing lever{1, 1, 0.05, {0.5, top + 0.025}};
  std::vector<Thing> discs;
  for (int i = 0; i < 3; ++i) discs.push_back({0.5, r, 0, {arm, r + 2 * r * i}});

  const Law law;
  Ours ours(law);
  const auto build_shaft = [&](auto& engine) {
    engine.wall({0, -0.1}, {2, 0.2});
    for (const double side : {-1, 1}) engine.wall({arm + side * (r + 0.0505), 2.5 * r}, {0.1, 5 * r});
  };
  build_shaft(ours);
  for (const Thing& d : discs) ours.add(d, h_s);
  model::Model m;
  m.links.push_back(
      link_of("base", Box{{0.1, 0.1, 0.2}}, heavy, {{base.at.x, base.at.y, 0}, {}}, ours.surface));
  m.links.push_back(
      link_of("lever", Box{{1, 0.05, 0.2}}, 1, {{lever.at.x, lever.at.y, 0}, {}}, ours.surface));
  model::Joint hinge{.name = "hinge", .type = model::JointType::continuous, .parent = 0, .child = 1};
  hinge.X_CJ = {{-0.5, 0, 0}, {}};
  m.joints.push_back(hinge);
  const InstanceId arm_id = ours.world.add(instance_of("arm", m));
  const BodyId lever_id = ours.world.engine->bodies(arm_id)[1];
  double pressed = 0;
  for (int i = 0; i < 500; ++i) {
    const Wrench wrench{lever_id, {0, -force_N, 0}, {0, 0, -0.5 * force_N}};
    ours.world.engine->apply(std::span(&wrench, 1));
    ours.step(h_s);
  }
  for (const Contact& c : ours.world.engine->contacts())
    if (c.a == ours.world.engine->bodies(ours.world.ids[0])[0]) pressed += c.force_W.y;
  const Motion lever_ours{{}, {}, yaw_of(ours.world.state(arm_id, 1).X_WB.q), 0};

  Theirs theirs(law);
  build_shaft(theirs);
  for (const Thing& d : discs) theirs.add(d, h_s);
  theirs.add(base, h_s);
  theirs.add(lever, h_s);
  theirs.pivot(3, 4, {0, top + 0.025});
  theirs.hold_apart(3, 4);
  for (int i = 0; i < 500; ++i) {
    theirs.push(4, {0, -force_N}, -0.5 * force_N);
    theirs.step(h_s);
  }
  // 10 N at 1 m against arm m. Overlap of 0.1 mm at each of four contacts is allowed, and turns the lever by
  // 0.4 mm / arm.
  const double expected = force_N / arm;
  EXPECT_NEAR(pressed, expected, 0.01 * expected);
  EXPECT_NEAR(theirs.force_below(0, h_s).y, expected, 0.01 * expected);
  EXPECT_NEAR(lever_ours.heading_rad, 0, 0.0005 / arm);
  EXPECT_NEAR(theirs.of(4).heading_rad, 0, 0.0005 / arm);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(ours.of(i).at.y, discs[i].at.y, 0.0005);
    EXPECT_NEAR(theirs.of(i).at.y, discs[i].at.y, 0.0005);
  }
}

}  // namespace
}  // namespace sandlot::planar
