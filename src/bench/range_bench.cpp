#include <cmath>
#include <limits>
#include <memory>

#include "base/check.h"
#include "base/math.h"
#include "base/random.h"
#include "bench/bare_embree.h"
#include "bench/bare_grid.h"
#include "bench/bench.h"
#include "optics/ray_scene.h"
#include "physics/engine.h"

namespace sandlot::bench {
namespace {

Pose at(double x, double y, double z, double yaw = 0) { return pose_from_rpy({x, y, z}, {0, 0, yaw}); }

/// Beams of a scanner that sees all around.
std::vector<Vec3> fan(int beams) {
  std::vector<Vec3> directions;
  for (int i = 0; i < beams; ++i) {
    const auto [s, c] = math::sincos(math::tau * i / beams);
    directions.push_back({c, s, 0});
  }
  return directions;
}

/// A soccer field: boards, two goals, twelve robots, a ball and three people.
struct Field3D {
  std::vector<SceneShape> shapes;
  SceneFrame frame;
  std::vector<Pose> robots;

  Field3D() {
    frame.X_WG.push_back({});
    const auto fixed = [&](Shape shape, Pose X) { shapes.push_back({0, X, shape, 0, false}); };
    fixed(Plane{{0, 0, 1}}, {});
    for (const double side : {-1.0, 1.0}) {
      fixed(Box{{24, 0.05, 0.6}}, at(0, side * 8, 0.3));
      fixed(Box{{0.05, 16, 0.6}}, at(side * 12, 0, 0.3));
      fixed(Box{{0.12, 0.12, 1.1}}, at(side * 11, 1.2, 0.55));
      fixed(Box{{0.12, 0.12, 1.1}}, at(side * 11, -1.2, 0.55));
      fixed(Box{{0.12, 2.5, 0.12}}, at(side * 11, 0, 1.1));
      fixed(Box{{0.02, 2.4, 1}}, at(side * 11.5, 0, 0.5));
    }
    Stream r(1, entity_key("field"), Purpose::placement, 0);
    const auto mover = [&](Pose X_WG, std::initializer_list<std::pair<Shape, Pose>> parts) {
      const auto group = static_cast<std::uint32_t>(frame.X_WG.size());
      frame.X_WG.push_back(X_WG);
      for (const auto& [shape, X] : parts) shapes.push_back({group, X, shape, group, true});
    };
    for (int i = 0; i < 12; ++i) {
      const double x = -9 + 6 * (i % 4) + r.uniform(-1, 1), y = -5 + 5 * (i / 4) + r.uniform(-1, 1);
      robots.push_back(at(x, y, 0, r.uniform(-3, 3)));
      mover(robots.back(), {{Cylinder{0.25, 0.4}, at(0, 0, 0.22)},
                            {Box{{0.3, 0.3, 0.35}}, at(0, 0, 0.6)},
                            {Box{{0.1, 0.3, 0.1}}, at(0.2, 0, 0.1)}});
    }
    mover(at(0.3, 0.2, 0.11), {{Sphere{0.11}, {}}});
    for (const double x : {-6.0, 1.0, 7.0}) mover(at(x, 7.2, 0.9), {{Capsule{0.2, 1.4}, {}}});
  }
};

std::vector<Row> field_ranges() {
  const Field3D field;
  RayScene scene;
  scene.set_shapes(field.shapes);
  scene.update(field.frame);
  BareEmbree bare(field.shapes, field.frame, scene.isa());
  constexpr double min_m = 0.3, max_m = 15;  // beyond the robot's own rim, so that both see the same
  std::vector<Row> rows;
  for (const int beams : {180, 360, 1080}) {
    const std::vector<Vec3> directions = fan(beams);
    std::vector<float> seen(directions.size() * field.robots.size());
    std::vector<RayJob> jobs;
    for (std::size_t i = 0; i < field.robots.size(); ++i)
      jobs.push_back({field.robots[i] * at(0, 0, 0.3),
                      directions,
                      min_m,
                      max_m,
                      static_cast<std::uint32_t>(i + 1),
                      std::span(seen).subspan(i * directions.size(), directions.size()),
                      {}});
    bare.prepare(jobs);
    const int rounds = 40;
    const Timing t = compare(
        41,
        [&] {
          for (int i = 0; i < rounds; ++i) scene.cast(jobs);
        },
        [&] {
          for (int i = 0; i < rounds; ++i) bare.trace();
        });
    std::size_t differences = 0;
    for (std::size_t i = 0; i < seen.size(); ++i)
      differences += !(seen[i] == bare.distances()[i] || std::abs(seen[i] - bare.distances()[i]) < 1e-4f);
    SL_CHECK_MSG(differences * 1000 <= seen.size(), "the two loops must see the same field");
    const double per_ray = 1e9 / (rounds * static_cast<double>(seen.size()));
    // "At least 85 % of the bare loop" as a ratio of costs.
    rows.push_back(row("P5 ranges, 3D field, " + std::to_string(beams) + " beams", "ns/ray",
                       t.ours_s * per_ray, t.reference_s * per_ray, 1 / 0.85));
  }
  return rows;
}

/// Discs spread as densely as in P1 and P2: one per 2 m^2, none overlapping.
std::vector<Vec3> scatter(int count, double radius_m) {
  Stream r(2, entity_key("swarm"), Purpose::placement, 0);
  const double half = std::sqrt(2.0 * count) / 2;
  const auto cells = static_cast<int>(std::floor(2 * half / 0.5));
  std::vector<Vec3> discs;
  std::vector<bool> taken(static_cast<std::size_t>(cells * cells), false);
  while (static_cast<int>(discs.size()) < count) {  // one per half-metre square, so neighbours keep apart
    const auto cell = static_cast<std::size_t>(r.below(static_cast<std::uint32_t>(cells * cells)));
    if (taken[cell]) continue;
    taken[cell] = true;
    const double x = -half + 0.5 * static_cast<double>(cell % static_cast<std::size_t>(cells)) + 0.25;
    const double y = -half + 0.5 * static_cast<double>(cell / static_cast<std::size_t>(cells)) + 0.25;
    const double free = 0.24 - radius_m;
    const double dx = r.uniform(-free, free);
    discs.push_back({x + dx, y + r.uniform(-free, free), radius_m});
  }
  return discs;
}

std::vector<Row> swarm_ranges() {
  constexpr double radius_m = 0.085;
  const auto robot = std::make_shared<model::Model>();
  robot->name = "robot";
  robot->links.resize(1);
  robot->links[0].name = "base";
  robot->links[0].collisions.push_back({"shape", at(0, 0, 0.1), Cylinder{radius_m, 0.2}, {}, {}});
  std::vector<Row> rows;
  for (const int count : {1000, 10'000}) {
    auto engine = find_engine("planar").value()->create(Node::map(), {0, 0, -9.81}).value();
    const std::vector<Vec3> discs = scatter(count, radius_m);
    std::vector<std::uint32_t> bodies;
    for (const Vec3 disc : discs) {
      model::Instance instance;
      instance.model = robot;
      instance.X_WM = at(disc.x, disc.y, 0);
      bodies.push_back(engine->bodies(engine->add(instance).value())[0].index);
    }
    const BareGrid grid(discs, 0.5);
    struct Sensor {
      const char* name;
      int beams;
      double max_m;
      std::size_t robots;
    };
    for (const Sensor sensor : {Sensor{"P2 planar laser 360 x 5 m, ", 360, 5, 200},
                                Sensor{"P1 planar proximity 24 x 0.1 m, ", 24, 0.1 + radius_m, 1000}}) {
      const std::vector<Vec3> directions = fan(sensor.beams);
      std::vector<float> seen(directions.size() * sensor.robots), bare(seen.size());
      std::vector<RayJob> jobs;
      for (std::size_t i = 0; i < sensor.robots; ++i)
        jobs.push_back({at(discs[i].x, discs[i].y, 0.1),
                        directions,
                        0,
                        sensor.max_m,
                        bodies[i],
                        std::span(seen).subspan(i * directions.size(), directions.size()),
                        {}});
      std::vector<float> dx, dy;
      for (const Vec3 d : directions) {
        dx.push_back(static_cast<float>(d.x));
        dy.push_back(static_cast<float>(d.y));
      }
      const RayCaster& caster = *engine->rays();
      const Timing t = compare(
          21, [&] { caster.cast(jobs); },
          [&] {
            for (std::size_t i = 0; i < sensor.robots; ++i)
              for (std::size_t k = 0; k < directions.size(); ++k)
                bare[i * directions.size() + k] = grid.cast(
                    static_cast<float>(discs[i].x), static_cast<float>(discs[i].y), dx[k], dy[k],
                    static_cast<float>(sensor.max_m), static_cast<std::uint32_t>(i));
          });
      std::size_t differences = 0;
      for (std::size_t i = 0; i < seen.size(); ++i)
        differences += !(seen[i] == bare[i] || std::abs(seen[i] - bare[i]) < 1e-3f);
      SL_CHECK_MSG(differences * 1000 <= seen.size(), "the two casters must see the same swarm");
      const double per_ray = 1e9 / static_cast<double>(seen.size());
      rows.push_back(row(sensor.name + std::to_string(count) + " robots", "ns/ray", t.ours_s * per_ray,
                         t.reference_s * per_ray, 1.5));
    }
  }
  return rows;
}

}  // namespace

std::vector<Row> rays() {
  std::vector<Row> rows = field_ranges();
  for (Row& r : swarm_ranges()) rows.push_back(std::move(r));
  return rows;
}

}  // namespace sandlot::bench
