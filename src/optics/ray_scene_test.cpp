#include "optics/ray_scene.h"

#include <gtest/gtest.h>

#include <thread>

#include "base/math.h"
#include "base/random.h"

namespace sandlot {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
/// Rounding of a float distance of about 10 m, three operations deep.
constexpr double eps_m = 10 * 3 * 6e-8;

SceneShape shape(Shape s, Vec3 p = {}, std::uint32_t body = 0, bool moves = false, std::uint32_t group = 0) {
  return {group, {p, {}}, s, body, moves};
}

struct World {
  RayScene scene;
  SceneFrame frame{0, 0, std::vector<Pose>(4)};
  explicit World(std::vector<SceneShape> shapes) {
    scene.set_shapes(shapes);
    scene.update(frame);
  }
  float see(Vec3 from, Vec3 to, double min_m = 0, double max_m = 100, std::uint32_t ignore = no_body,
            std::uint32_t* body = nullptr) const {
    const Vec3 d = normalised(to - from);
    float distance = -1;
    std::uint32_t hit = 12345;
    RayJob job{{from, {}}, {&d, 1}, min_m, max_m, ignore, {&distance, 1}, {&hit, 1}};
    scene.cast({&job, 1});
    if (body) *body = hit;
    return distance;
  }
};

TEST(RayScene, AnEmptySceneShowsNothing) {
  World world({});
  EXPECT_EQ(world.see({}, {1, 0, 0}), inf);
}

TEST(RayScene, APlaneIsMetAtHeightOverSlope) {
  World world({shape(Plane{{0, 0, 1}}, {}, 7)});
  std::uint32_t body = 0;
  EXPECT_NEAR(world.see({3, 4, 2}, {5, 4, 0}, 0, 100, no_body, &body), 2 * std::sqrt(2.0), eps_m);
  EXPECT_EQ(body, 7u);
  EXPECT_EQ(world.see({0, 0, 2}, {1, 0, 2}, 0, 100, no_body, &body), inf);  // parallel
  EXPECT_EQ(body, no_body);
  EXPECT_EQ(world.see({0, 0, 2}, {0, 0, 3}), inf);          // away
  EXPECT_NEAR(world.see({0, 0, -2}, {0, 0, 3}), 2, eps_m);  // from below: surfaces have two sides
  EXPECT_EQ(world.see({0, 0, 2}, {0, 0, 0}, 0, 1.9), inf);
  EXPECT_EQ(world.see({0, 0, 2}, {0, 0, 0}, 2.1, 10), inf);
  EXPECT_EQ(world.see({0, 0, 0}, {1, 0, 0}), inf);  // lies in it
  const double unlimited = std::numeric_limits<double>::infinity();
  EXPECT_EQ(world.see({0, 0, 2}, {1, 0, 2}, 0, unlimited, no_body, &body), inf);
  EXPECT_EQ(body, no_body);
}

TEST(RayScene, NothingIsMetOnWaysThatNumbersDoNotReach) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const bool moves : {false, true}) {
    World world({shape(Sphere{1e4}, {}, 3, moves), shape(Box{{1, 1, 1}}, {0, 5e4, 0}, 4, moves)});
    EXPECT_NEAR(world.see({-1e5, 0, 0}, {}, 0, 1e30), 9e4, 1);
    for (const double x : {-1e19, -1e300, nan}) EXPECT_EQ(world.see({x, 0, 0}, {}, 0, 1e30), inf) << x;
    EXPECT_EQ(world.see({-1e5, 0, 0}, {}, 1e19, 1e30), inf);
    EXPECT_EQ(world.see({-1e5, 0, 0}, {}, 0, nan), inf);
    for (const Vec3 way : {Vec3{nan, 0, 0}, Vec3{1e19, 0, 0}}) {
      float distance = -1;
      const RayJob job{{{-1e5, 0, 0}, {}}, {&way, 1}, 0, 1e30, no_body, {&distance, 1}, {}};
      world.scene.cast({&job, 1});
      EXPECT_EQ(distance, inf) << way.x;
    }
  }
}

TEST(RayScene, ASphereIsMetBeforeItsCentreByTheHalfChord) {
  World world({shape(Sphere{0.5}, {5, 0, 1}, 3)});
  for (const double offset : {0.0, 0.1, 0.3, 0.49}) {
    const double half_chord = std::sqrt(0.25 - offset * offset);
    // A lateral error e of the ray moves the hit by e * offset / half_chord.
    const double tolerance = eps_m * (1 + offset / half_chord);
    EXPECT_NEAR(world.see({0, offset, 1}, {1, offset, 1}), 5 - half_chord, tolerance) << offset;
    EXPECT_NEAR(world.see({5, offset, 1}, {6, offset, 1}), half_chord, tolerance) << offset;  // from inside
  }
  EXPECT_EQ(world.see({0, 0.50001, 1}, {1, 0.50001, 1}), inf);  // grazes by 10 um
  EXPECT_LT(world.see({0, 0.49999, 1}, {1, 0.49999, 1}), inf);
}

TEST(RayScene, ABoxIsMetAtItsFaces) {
  World world({{0, {{4, 0, 0}, quat_from_axis_angle({0, 0, 1}, math::pi / 4)}, Box{{2, 2, 1}}, 3, false}});
  EXPECT_NEAR(world.see({0, 0, 0}, {1, 0, 0}), 4 - std::sqrt(2.0), eps_m);            // the edge
  EXPECT_NEAR(world.see({0, 0.5, 0}, {1, 0.5, 0}), 4.5 - std::sqrt(2.0), 2 * eps_m);  // a face at 45 degrees
  EXPECT_NEAR(world.see({4, 0, 3}, {4, 0, 0}), 2.5, eps_m);                           // the lid
  EXPECT_NEAR(world.see({4, 0, 0}, {4, 0, 1}), 0.5, eps_m);                           // from inside
  EXPECT_NEAR(world.see({0, 0, 0}, {1, 0, 0}, 3), 4 + std::sqrt(2.0), eps_m);  // begins inside: the far side
  EXPECT_EQ(world.see({0, 0, 0.5001}, {1, 0, 0.5001}), inf);
}

TEST(RayScene, ARayInAFaceMeetsTheBox) {
  World world({shape(Box{{2, 2, 2}}, {4, 0, 0})});
  for (const double z : {-1.0, 1.0}) EXPECT_EQ(world.see({0, 0, z}, {1, 0, z}), 3) << z;
  for (const double y : {-1.0, 1.0}) EXPECT_EQ(world.see({0, y, 1}, {1, y, 1}), 3) << y;  // along an edge
}

TEST(RayScene, ACylinderHasARoundSideAndTwoCaps) {
  World world({shape(Cylinder{0.5, 2}, {5, 0, 1})});
  EXPECT_NEAR(world.see({0, 0.3, 1}, {1, 0.3, 1}), 5 - 0.4, 2 * eps_m);
  EXPECT_NEAR(world.see({5, 0.3, 4}, {5, 0.3, 0}), 2, eps_m);  // parallel to the axis: the lid
  EXPECT_EQ(world.see({5.6, 0, 4}, {5.6, 0, 0}), inf);
  EXPECT_NEAR(world.see({5, 0.3, 1}, {5, 0.3, 0}), 1, eps_m);  // from inside, down the axis
  EXPECT_NEAR(world.see({5, 0, 1}, {6, 0, 1}), 0.5, eps_m);
  EXPECT_NEAR(world.see({3.5, 0, 3}, {4.5, 0, 2}), std::sqrt(2.0), 3 * eps_m);  // at the rim
  EXPECT_NEAR(world.see({3, 0, 4}, {5, 0, 2}), 2 * std::sqrt(2.0), eps_m);      // through the lid, aslant
}

TEST(RayScene, ACapsuleHasHalfSpheres) {
  World world({shape(Capsule{0.5, 2}, {5, 0, 2})});
  EXPECT_NEAR(world.see({0, 0.3, 2}, {1, 0.3, 2}), 5 - 0.4, 2 * eps_m);
  EXPECT_NEAR(world.see({0, 0, 3.3}, {1, 0, 3.3}), 5 - 0.4,
              2 * eps_m);  // the ball on top, 0.3 above its centre
  EXPECT_NEAR(world.see({5, 0, 9}, {5, 0, 0}), 5.5, eps_m);
  EXPECT_NEAR(world.see({5, 0, 2}, {5, 0, 0}), 1.5, eps_m);
  EXPECT_NEAR(world.see({5, 0, 2}, {6, 0, 2}), 0.5, eps_m);
  EXPECT_EQ(world.see({0, 0, 3.51}, {1, 0, 3.51}), inf);
}

TEST(RayScene, MinAndMaxBoundWhatIsSeen) {
  World world({shape(Sphere{1}, {5, 0, 0})});
  EXPECT_EQ(world.see({}, {1, 0, 0}, 0, 4), 4);  // inclusive
  EXPECT_EQ(world.see({}, {1, 0, 0}, 0, 3.999), inf);
  EXPECT_EQ(world.see({}, {1, 0, 0}, 4), 4);
  EXPECT_EQ(world.see({}, {1, 0, 0}, 4.001),
            6);  // starts inside: sees the far side, measured from the origin
  EXPECT_EQ(world.see({}, {1, 0, 0}, 6.001), inf);
  EXPECT_EQ(world.see({}, {1, 0, 0}, 5, 2), inf);
}

TEST(RayScene, TheCarrierDoesNotSeeItself) {
  World world({shape(Sphere{0.2}, {}, 1, true), shape(Cylinder{0.1, 1}, {0.5, 0, 0}, 1, true),
               shape(Box{{1, 1, 1}}, {3, 0, 0}, 2), shape(Plane{{-1, 0, 0}}, {5, 0, 0}, 4)});
  std::uint32_t body = 0;
  EXPECT_FLOAT_EQ(world.see({}, {1, 0, 0}), 0.2f);
  EXPECT_FLOAT_EQ(world.see({}, {1, 0, 0}, 0, 100, 1, &body), 2.5f);
  EXPECT_EQ(body, 2u);
  EXPECT_FLOAT_EQ(world.see({2, 0.8, 0}, {3, 0.8, 0}, 0, 100, 4, &body), inf);
  EXPECT_FLOAT_EQ(world.see({2, 0.8, 0}, {3, 0.8, 0}, 0, 100, 2, &body), 3);
}

TEST(RayScene, WhatBelongsToNoBodyIsNeverIgnored) {
  World world({shape(Sphere{1}, {5, 0, 0}, no_body)});
  std::uint32_t body = 0;
  EXPECT_EQ(world.see({}, {1, 0, 0}, 0, 100, no_body, &body), 4);
  EXPECT_EQ(body, no_body);
}

TEST(RayScene, OfTwoAtTheSameDistanceTheSmallerIndexIsReported) {
  for (const bool swapped : {false, true}) {
    World world({shape(Box{{1, 1, 1}}, {3, 0, 0}, swapped ? 9 : 2),
                 shape(Box{{1, 1, 1}}, {3, 0, 0}, swapped ? 2 : 9, true)});
    std::uint32_t body = 0;
    world.see({}, {1, 0, 0}, 0, 100, no_body, &body);
    EXPECT_EQ(body, 2u);
  }
}

TEST(RayScene, GroupsMoveTogetherAndRevisionsRebuildTheRest) {
  World world({shape(Sphere{0.5}, {1, 0, 0}, 1, true, 2), shape(Sphere{0.5}, {1, 3, 0}, 2, false, 3),
               shape(Plane{{0, 0, 1}}, {}, 3, true, 2)});
  EXPECT_EQ(world.see({-4, 0, 0}, {0, 0, 0}), 4.5f);
  world.frame.X_WG[2] = {{2, 0, -1}, quat_from_axis_angle({0, 0, 1}, math::pi / 2)};  // sphere at (2, 1, -1)
  world.frame.X_WG[3].p.x = 7;
  world.scene.update(world.frame);
  EXPECT_EQ(world.see({-4, 0, 0}, {0, 0, 0}), inf);
  EXPECT_NEAR(world.see({-4, 1, -1}, {0, 1, -1}), 5.5, eps_m);
  EXPECT_NEAR(world.see({0, 0, 2}, {0, 0, 1}), 3, eps_m);  // the plane went along
  EXPECT_EQ(world.see({-4, 3, 0}, {0, 3, 0}), 4.5f);       // declared unmoving: stays until the next revision
  world.frame.revision = 1;
  world.scene.update(world.frame);
  EXPECT_EQ(world.see({-4, 3, 0}, {0, 3, 0}), 11.5f);
  world.scene.set_shapes({});
  world.scene.update(world.frame);
  EXPECT_EQ(world.see({-4, 3, 0}, {0, 3, 0}), inf);
}

TEST(RayScene, TheSensorsPoseTurnsTheFan) {
  World world({shape(Sphere{0.5}, {0, 0, 5}, 1)});
  // x of S points along z of W.
  const Pose X_WS{{0, 0, 1}, quat_from_axis_angle({0, 1, 0}, -math::pi / 2)};
  const Vec3 directions[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  float distance[3];
  RayJob job{X_WS, directions, 0, 10, no_body, distance, {}};
  world.scene.cast({&job, 1});
  EXPECT_NEAR(distance[0], 3.5, eps_m);
  EXPECT_EQ(distance[1], inf);
  EXPECT_EQ(distance[2], inf);
}

TEST(RayScene, FarFromTheOriginItIsAsSharp) {
  const Vec3 there{10'000, -20'000, 50};
  World world({shape(Sphere{0.5}, there + Vec3{5, 0, 0}), shape(Box{{1, 1, 1}}, there + Vec3{0, 5, 0})});
  EXPECT_NEAR(world.see(there, there + Vec3{1, 0, 0}), 4.5, eps_m);
  EXPECT_NEAR(world.see(there, there + Vec3{0, 1, 0}), 4.5, eps_m);
}

TEST(RayScene, NoEdgeIsLostFarFromTheOrigin) {
  // 10 km away floats are 1 mm apart: bounds that are rounded to them cut up to half of it off a box, unless
  // they have a margin. Rays 0.1 mm inside the edge show it.
  const Vec3 there{10'000, 10'000, 0};
  std::vector<SceneShape> shapes;
  const auto width_m = [](int i) { return 1 + 1.3e-4 * i; };
  for (int i = 0; i < 40; ++i)
    shapes.push_back(shape(Box{{1, width_m(i), 0.5}}, there + Vec3{5.5, 0, 1.0 * i}));
  World world(shapes);
  for (int i = 0; i < 40; ++i) {
    const double y = 0.5 * width_m(i) - 1e-4;
    const Vec3 from = there + Vec3{0, y, 1.0 * i};
    ASSERT_NEAR(world.see(from, from + Vec3{1, 0, 0}), 5, eps_m) << i;
  }
}

TEST(RayScene, NothingWithinUnlimitedRangeIsNoBody) {
  // The ray passes through the corner of the bounds of a turned box, but not through the box.
  World world({{0, {{4, 0, 0}, quat_from_axis_angle({0, 0, 1}, math::pi / 4)}, Box{{2, 2, 2}}, 3, false}});
  std::uint32_t body = 0;
  const double unlimited = std::numeric_limits<double>::infinity();
  EXPECT_EQ(world.see({0, -2.4, 0}, {1, -1.4, 0}, 0, unlimited, no_body, &body), inf);
  EXPECT_EQ(body, no_body);
}

// --- a second opinion in double precision ------------------------------------------------------------------

/// Calls see(t) for all t where the line o + t d meets the surface: faces, sides and caps one by one.
template <class See>
void surfaces(const Shape& s, Vec3 o, Vec3 d, double grow, See&& see) {
  const auto quadratic = [&](double a, double b, double c, auto&& use) {
    const double disc = b * b - a * c;
    if (disc < 0 || a == 0) return;
    use((-b - std::sqrt(disc)) / a);
    use((-b + std::sqrt(disc)) / a);
  };
  const auto at = [&](double t) { return o + t * d; };
  if (const auto* box = std::get_if<Box>(&s)) {
    for (std::size_t k = 0; k < 3; ++k)
      for (const double sign : {-1.0, 1.0}) {
        const double t = (sign * (box->size_m[k] / 2 + grow) - o[k]) / d[k];
        const Vec3 p = at(t);
        bool in = true;
        for (std::size_t j = 0; j < 3; ++j)
          in = in && (j == k || std::abs(p[j]) <= box->size_m[j] / 2 + grow);
        if (in) see(t);
      }
  } else if (const auto* ball = std::get_if<Sphere>(&s)) {
    const double r = ball->radius_m + grow;
    quadratic(dot(d, d), dot(o, d), dot(o, o) - r * r, see);
  } else if (const auto* can = std::get_if<Cylinder>(&s)) {
    const double r = can->radius_m + grow, h = can->length_m / 2 + grow;
    quadratic(d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y - r * r, [&](double t) {
      if (std::abs(at(t).z) <= h) see(t);
    });
    for (const double z : {-h, h}) {
      const double t = (z - o.z) / d.z;
      const Vec3 p = at(t);
      if (p.x * p.x + p.y * p.y <= r * r) see(t);
    }
  } else if (const auto* pill = std::get_if<Capsule>(&s)) {
    const double r = pill->radius_m + grow, h = pill->length_m / 2;
    quadratic(d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y - r * r, [&](double t) {
      if (std::abs(at(t).z) <= h) see(t);
    });
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 c{o.x, o.y, o.z - sign * h};
      quadratic(dot(d, d), dot(c, d), dot(c, c) - r * r, [&](double t) {
        if (sign * at(t).z >= h) see(t);
      });
    }
  } else if (const auto* plane = std::get_if<Plane>(&s)) {
    see((grow - dot(plane->normal, o)) / dot(plane->normal, d));
  }
}

double reference(const std::vector<SceneShape>& shapes, const SceneFrame& frame, Vec3 o, Vec3 d,
                 const RayJob& job, double grow) {
  double best = std::numeric_limits<double>::infinity();
  for (const SceneShape& s : shapes) {
    if (s.body == job.ignore_body) continue;
    const Pose X_CW = inverse(frame.X_WG[s.group] * s.X_GC);
    surfaces(s.shape, X_CW * o, rotate(X_CW.q, d), grow, [&](double t) {
      if (t >= job.min_m && t <= job.max_m) best = std::min(best, t);
    });
  }
  return best;
}

Vec3 random_direction(Stream& r) { return normalised(Vec3{r.normal(), r.normal(), r.normal()}); }
Quat random_turn(Stream& r) {
  const Vec3 axis = random_direction(r);
  return quat_from_axis_angle(axis, r.uniform(0, math::tau));
}

std::vector<SceneShape> random_shapes(Stream& r, std::uint32_t count) {
  std::vector<SceneShape> shapes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double a = r.uniform(0.05, 0.8), b = r.uniform(0.05, 0.8), c = r.uniform(0.05, 0.8);
    Shape s = Sphere{a};
    if (i % 4 == 1) s = Box{{a, b, c}};
    if (i % 4 == 2) s = Cylinder{a / 2, b};
    if (i % 4 == 3) s = Capsule{a / 2, b};
    const double x = r.uniform(-4, 4), y = r.uniform(-4, 4), z = r.uniform(-4, 4);
    shapes.push_back({i % 3, {{x, y, z}, random_turn(r)}, s, i, i % 3 != 0});
  }
  shapes.push_back({0, {{0, 0, -6}, {}}, Plane{{0, 0, 1}}, count, false});
  return shapes;
}

TEST(RayScene, AgreesWithADoublePrecisionCasterOnRandomScenes) {
  // The line may be off sideways by a few float roundings of the scene's 20 m; so every answer must lie
  // between those for solids that much thinner and thicker.
  const double slack_m = 10 * 20 * 6e-8;
  int hits = 0, rays = 0;
  for (std::uint64_t sample = 0; sample < 60; ++sample) {
    Stream r(1, entity_key("rays"), Purpose::experiment, sample);
    const auto shapes = random_shapes(r, 40);
    SceneFrame frame{0, 0, {Pose{}, Pose{{1, 2, 0}, random_turn(r)}, Pose{{0, -2, 1}, random_turn(r)}}};
    RayScene scene;
    scene.set_shapes(shapes);
    scene.update(frame);
    std::vector<Vec3> directions(101);
    for (Vec3& d : directions) d = random_direction(r);
    std::vector<float> distance(directions.size());
    std::vector<std::uint32_t> body(directions.size());
    const double x = r.uniform(-4, 4), y = r.uniform(-4, 4), z = r.uniform(-4, 4);
    RayJob job{{{x, y, z}, random_turn(r)},
               directions,
               r.uniform(0, 0.5),
               r.uniform(3, 30),
               r.below(40),
               distance,
               body};
    scene.cast({&job, 1});
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const Vec3 d = rotate(job.X_WS.q, directions[i]);
      double lo = std::numeric_limits<double>::infinity(), hi = 0;
      for (const double grow : {-slack_m, 0.0, slack_m})
        for (const double bound : {-slack_m, slack_m}) {
          RayJob limits = job;
          limits.min_m += bound;
          limits.max_m -= bound;
          const double t = reference(shapes, frame, job.X_WS.p, d, limits, grow);
          lo = std::min(lo, t);
          hi = std::max(hi, t);
        }
      ASSERT_GE(distance[i], lo - slack_m) << "sample " << sample << " ray " << i;
      ASSERT_LE(distance[i], hi + slack_m) << "sample " << sample << " ray " << i;
      ASSERT_EQ(distance[i] < inf, body[i] != no_body);
      ASSERT_NE(body[i], job.ignore_body);
      hits += distance[i] < inf;
      ++rays;
    }
  }
  EXPECT_GT(hits, rays / 4);  // otherwise the test looks at nothing
  EXPECT_LT(hits, rays * 9 / 10);
}

TEST(RayScene, TheAnswerDependsOnTheJobAlone) {
  Stream r(2, entity_key("rays"), Purpose::experiment, 0);
  const auto shapes = random_shapes(r, 200);
  RayScene scene;
  SceneFrame frame{0, 0, {Pose{}, Pose{}, Pose{}}};
  scene.set_shapes(shapes);
  scene.update(frame);
  constexpr std::size_t jobs = 64, rays = 37;
  std::vector<Vec3> directions(jobs * rays);
  for (Vec3& d : directions) d = random_direction(r);
  std::vector<float> together(jobs * rays), apart(jobs * rays), threaded(jobs * rays);
  const auto job = [&](std::size_t j, std::size_t first, std::size_t count, std::vector<float>& out) {
    const double s = static_cast<double>(j);
    return RayJob{{{s / 8 - 4, 0.1 * s - 3, 1}, quat_from_axis_angle({0, 0, 1}, s)},
                  std::span(directions).subspan(j * rays + first, count),
                  0,
                  30,
                  no_body,
                  std::span(out).subspan(j * rays + first, count),
                  {}};
  };
  std::vector<RayJob> batch;
  for (std::size_t j = 0; j < jobs; ++j) batch.push_back(job(j, 0, rays, together));
  scene.cast(batch);
  for (std::size_t j = jobs; j-- > 0;)
    for (std::size_t i = rays; i-- > 0;) {  // one ray at a time, backwards
      const RayJob single = job(j, i, 1, apart);
      scene.cast({&single, 1});
    }
  EXPECT_EQ(together, apart);
  for (const std::size_t threads : {2u, 4u}) {
    std::fill(threaded.begin(), threaded.end(), -1.f);
    scene.update(frame);  // whichever thread is the first builds the trees
    std::vector<std::thread> pool;
    for (std::size_t k = 0; k < threads; ++k)
      pool.emplace_back([&, k] {
        for (std::size_t j = k; j < jobs; j += threads) {
          const RayJob single = job(j, 0, rays, threaded);
          scene.cast({&single, 1});
        }
      });
    for (std::thread& t : pool) t.join();
    EXPECT_EQ(together, threaded);
  }
}

TEST(RayScene, DenormalsSurviveOutside) {
  World world({shape(Sphere{1}, {5, 0, 0})});
  world.see({}, {1, 0, 0});
  volatile double small = 1e-310;
  EXPECT_GT(small * 0.5, 0);
  EXPECT_STREQ(world.scene.isa(), __builtin_cpu_supports("avx2") ? "avx2" : "sse4.2");
}

}  // namespace
}  // namespace sandlot
