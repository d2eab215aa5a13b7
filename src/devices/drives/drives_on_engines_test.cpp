/// Drives on real engines: what friction makes of their commands, and switches of level in mid-run.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/math.h"
#include "base/text.h"
#include "devices/drives/wheeled_base.h"
#include "devices/kind.h"
#include "messages/command.h"
#include "model/rollers.h"

namespace sandlot::wheeled {
namespace {

constexpr double radius = 0.1;

class NoRays final : public RayCaster {
 public:
  void cast(std::span<const RayJob>) const override {}
};

std::uint32_t add_link(model::Model& m, const std::string& name, Vec3 at, double mass_kg, const Shape& shape,
                       double mu, Vec3 shape_at = {}) {
  model::Link link{.name = name};
  link.X_ML.p = at;
  link.inertial.mass_kg = mass_kg;
  link.inertial.moments = inertia_kg_m2(shape, mass_kg);
  model::Surface surface;
  surface.mu = surface.mu2 = mu;
  link.collisions.push_back({"shape", {shape_at, {}}, shape, surface, {}});
  m.links.push_back(std::move(link));
  return static_cast<std::uint32_t>(m.links.size() - 1);
}
void add_joint(model::Model& m, const std::string& name, std::uint32_t parent, std::uint32_t child,
               Vec3 axis) {
  m.joints.push_back(
      {.name = name, .type = model::JointType::continuous, .parent = parent, .child = child, .axis_J = axis});
}

/// A flat box of 10 kg on four balls of 0.5 kg at (+-0.3, +-0.2); front and back on upright joints "s<name>"
/// or not.
model::Model robot(bool steered_front, bool steered_back) {
  model::Model m;
  m.name = "robot";
  add_link(m, "base", {0, 0, 0.15}, 10, Box{{0.5, 0.3, 0.06}}, 0);
  const struct {
    const char* name;
    double x, y;
  } corners[] = {{"fl", 0.3, 0.2}, {"fr", 0.3, -0.2}, {"bl", -0.3, 0.2}, {"br", -0.3, -0.2}};
  for (const auto& c : corners) {
    std::uint32_t parent = 0;
    if (c.x > 0 ? steered_front : steered_back) {
      // The fork's own shape hangs clear above the ground.
      parent = add_link(m, std::string("fork_") + c.name, {c.x, c.y, radius}, 0.3, Sphere{0.03}, 0);
      add_joint(m, std::string("s") + c.name, 0, parent, {0, 0, 1});
    }
    const std::uint32_t wheel = add_link(m, std::string("wheel_") + c.name, {c.x, c.y, radius}, 0.5,
                                         Sphere{radius}, 1);
    add_joint(m, c.name, parent, wheel, {0, 1, 0});
  }
  return m;
}

/// A disc of 10 kg on wheels with rollers of 0.05 m: four Mecanum wheels, or three omni wheels.
model::Model on_roller_wheels(bool mecanum) {
  model::Model m;
  m.name = "robot";
  add_link(m, "base", {0, 0, 0.07}, 10, Cylinder{0.15, 0.06}, 0);
  const auto wheel = [&](const std::string& name, double x, double y, Vec3 axis, double angle_rad) {
    add_link(m, "wheel_" + name, {x, y, 0.05}, 0.3, Cylinder{0.03, 0.02}, 0);
    m.links.back().X_ML.q = quat_between({0, 0, 1}, axis);
    add_joint(m, name, 0, static_cast<std::uint32_t>(m.links.size() - 1), {0, 0, 1});
    model::RollerWheel rollers{.radius_m = 0.05, .angle_rad = angle_rad};
    rollers.surface.mu = 0.8;
    rollers.count = mecanum ? 9 : 8;
    rollers.roller_length_m = mecanum ? 0.04 : 0.025;
    m.joints.back().rollers = rollers;
  };
  if (mecanum) {
    wheel("fl", 0.2, 0.15, {0, 1, 0}, -math::pi / 4);
    wheel("fr", 0.2, -0.15, {0, 1, 0}, math::pi / 4);
    wheel("bl", -0.2, 0.15, {0, 1, 0}, math::pi / 4);
    wheel("br", -0.2, -0.15, {0, 1, 0}, -math::pi / 4);
  } else {
    for (int i = 0; i < 3; ++i) {
      const auto [y, x] = math::sincos((60 + 120 * i) * math::pi / 180);
      wheel("w" + std::to_string(i), 0.2 * x, 0.2 * y, {x, y, 0}, math::pi / 2);
    }
  }
  const Status made = model::add_rollers(m);
  if (!made) ADD_FAILURE() << made.error().text();
  return m;
}

Node map(std::initializer_list<std::pair<const char*, const char*>> entries) {
  Node node = Node::map();
  for (const auto& [key, value] : entries) {
    std::string_view text = value;
    if (text.front() != '[') {
      node.set(key, Node::scalar(value));
      continue;
    }
    Node list = Node::sequence();
    for (const std::string_view item : split(text.substr(1, text.size() - 2), ' '))
      list.push(Node::scalar(std::string(item)));
    node.set(key, list);
  }
  return node;
}

/// One robot with one drive on an engine.
struct World : TopicMaker {
  std::unique_ptr<Engine> engine;
  model::Instance ground, instance;
  InstanceId id;
  std::unique_ptr<PoolBase> pool;
  std::map<std::string, std::unique_ptr<TopicBase>> topics;
  Actuation actuation;
  EmissionBuffer emissions;
  NoRays rays;
  Time now, tick = Time::from_s(0.01);
  std::uint64_t index = 0, sample = 0;
  std::uint32_t zero = 0, levels;
  Time since = tick;

  World(const char* engine_name, const char* kind, model::Model model, Node config, std::uint32_t level)
      : levels(1u << level) {
    const auto found = find_engine(engine_name);
    SL_CHECK(found);
    engine = std::move(*(*found)->create(Node::map(), {0, 0, -9.81}));
    model::Model plane;
    plane.name = "ground";
    plane.is_static = true;
    add_link(plane, "link", {}, 1, Plane{{0, 0, 1}}, 1);
    ground.name = "ground";
    ground.model = std::make_shared<const model::Model>(std::move(plane));
    SL_CHECK(engine->add(ground));
    instance.name = "robot1";
    instance.is_robot = true;
    instance.model = std::make_shared<const model::Model>(std::move(model));
    id = *engine->add(instance);
    const auto device_kind = find_device_kind(kind);
    SL_CHECK(device_kind);
    pool = (*device_kind)->create_pool();
    model::DeviceDecl decl{.name = "drive", .config = std::move(config)};
    const Status added = pool->add({decl, instance, "robot1/drive", entity_key("robot1/drive"), 1,
                                    engine->bodies(id), engine->joints(id), engine->capabilities(), tick,
                                    levels, *this});
    if (!added) ADD_FAILURE() << added.error().text();
  }
  void adopt_topic(std::unique_ptr<TopicBase> made, std::uint32_t) override {
    topics[made->name()] = std::move(made);
  }
  void adopt_order(std::unique_ptr<DeviceOrder>) override { ADD_FAILURE() << "it gives no orders"; }
  void adopt_inbox(std::unique_ptr<Inbox>) override {}
  void adopt_light(std::unique_ptr<SceneLight>) override {}
  void adopt_command(std::unique_ptr<TopicBase> made, std::uint32_t) override {
    topics[made->name()] = std::move(made);
  }
  Context context() { return {now + tick, tick, index, 1, *engine, rays, actuation, emissions}; }
  PoolBase::Due due() {
    return {std::span(&zero, 1), std::span(&sample, 1), std::span(&levels, 1), std::span(&since, 1)};
  }
  std::string level() const {
    return levels == 1u << ideal ? "ideal" : levels == 1u << contact ? "contact" : "rollers";
  }
  void command(double x, double y, double turn) {
    auto& slot = *topic_cast<msg::Twist>(topics.at("/robot1/drive/" + level() + "/command").get());
    slot.message.linear = {x, y, 0};
    slot.message.angular.z = turn;
    slot.stamp = now;
    ++slot.count;
  }
  /// Ticks until the maneuver is done.
  int maneuver(const msg::DriveManeuver& command) {
    auto& slot = *topics.at("/robot1/drive/maneuver/command");
    EXPECT_TRUE(slot.assign(command_bytes(command)));
    slot.stamp = now;
    ++slot.count;
    const auto& progress = *topic_cast<msg::DriveProgress>(topics.at("/robot1/drive/maneuver").get());
    int n = 0;
    do run(1);
    while (++n < 2000 && !progress.message.done);
    return n;
  }
  void run(int ticks, int substeps = 4) {
    for (int i = 0; i < ticks; ++i, ++index, now = now + tick) {
      actuation.clear();
      pool->actuate(context(), due());
      const double h_s = tick.s() / substeps;
      for (int k = 0; k < substeps; ++k) {
        pool->pre_substep(context(), due(), h_s);
        engine->set_targets(actuation.joints);
        engine->set_drive_targets(actuation.drives);
        engine->set_rolls(actuation.rolls);
        engine->set_wheels(actuation.wheels);
        engine->step(h_s, index * 100 + static_cast<std::uint64_t>(k));
        pool->post_substep(context(), due(), h_s);
        actuation.clear();
      }
    }
    now = now - tick;  // sense() stamps the end of the tick that was computed
    pool->sense(context(), due());
    now = now + tick;
  }
  Pose odometry() {
    return topic_cast<msg::Odometry>(topics.at("/robot1/drive/" + level()).get())->message.pose.pose;
  }
  BodyState base() { return engine->states()[engine->bodies(id)[0].index]; }
  double state(const char* name) {
    double found = std::nan("");
    pool->list_values(0, ValuePart::state, [&](const ValueEntry& v) {
      if (v.path == name) found = v.value;
    });
    return found;
  }
  void switch_to(std::uint32_t level) {
    const Status done = pool->switch_level(0, levels, 1u << level, context());
    ASSERT_TRUE(done) << done.error().text();
    levels = 1u << level;
  }
};

struct Case {
  const char* kind;
  model::Model (*model)();
  std::initializer_list<std::pair<const char*, const char*>> keys;
  double dx;  ///< of D in B
};
const Case swerve{
    "swerve_drive",
    [] { return robot(true, true); },
    {{"wheel_joint", "[fl fr bl br]"}, {"steering_joint", "[sfl sfr sbl sbr]"}, {"odometry", "kabsch"}},
    0};
const Case car{"ackermann_drive",
               [] { return robot(true, false); },
               {{"left_joint", "bl"},
                {"right_joint", "br"},
                {"passive_joint", "[fl fr]"},
                {"left_steering_joint", "sfl"},
                {"right_steering_joint", "sfr"}},
               -0.3};
const Case skid{"skid_drive",
                [] { return robot(false, false); },
                {{"left_joint", "[fl bl]"}, {"right_joint", "[fr br]"}},
                0};

const Case mecanum{"mecanum_drive",
                   [] { return on_roller_wheels(true); },
                   {{"front_left_joint", "fl"},
                    {"front_right_joint", "fr"},
                    {"back_left_joint", "bl"},
                    {"back_right_joint", "br"}},
                   0};
const Case omni{"omni_drive", [] { return on_roller_wheels(false); }, {{"wheel_joint", "[w0 w1 w2]"}}, 0};

/// How far D moves in its own frame in `seconds` at steady motion, after one second to get there.
kinematics::PlanarMotion moved(const Case& c, std::uint32_t level, kinematics::PlanarMotion v, double seconds,
                               double* odometry_error = nullptr) {
  World world("rigid", c.kind, c.model(), map(c.keys), level);
  world.command(v.x, v.y, v.turn);
  world.run(100);
  const Pose start = world.base().X_WB, seen = world.odometry();
  world.run(static_cast<int>(100 * seconds));
  const Pose X_BD{{c.dx, 0, 0}, {}};
  const Pose moved = inverse(start * X_BD) * (world.base().X_WB * X_BD);
  if (odometry_error) {
    const Pose counted = inverse(seen * X_BD) * (world.odometry() * X_BD);
    *odometry_error = norm(counted.p - Vec3{moved.p.x, moved.p.y, 0});
  }
  return {moved.p.x, moved.p.y, yaw_of(moved.q)};
}

void expect_arc(const Case& c, std::uint32_t level, kinematics::PlanarMotion v, double tolerance) {
  SCOPED_TRACE(std::string(c.kind) +
               (level == ideal     ? " ideal "
                : level == contact ? " contact "
                                   : " rollers ") +
               std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.turn));
  double odometry_error = 0;
  const auto got = moved(c, level, v, 1, &odometry_error);
  const auto want = kinematics::integrate({}, v);
  EXPECT_NEAR(got.x, want.x_m, tolerance);
  EXPECT_NEAR(got.y, want.y_m, tolerance);
  EXPECT_NEAR(math::wrap_angle(got.turn - want.theta_rad), 0, 2 * tolerance);
  EXPECT_LT(odometry_error, tolerance);
}

TEST(DrivesOnRigid, ACarDrivesItsCurve) {
  for (const kinematics::PlanarMotion v :
       {kinematics::PlanarMotion{0.5, 0, 0}, {0.5, 0, 0.4}, {-0.5, 0, 0.3}}) {
    expect_arc(car, contact, v, 5e-3);
    expect_arc(car, ideal, v, 1e-3);
  }
}

void expect_all_ways(const Case& c, std::uint32_t level, double tolerance) {
  for (const kinematics::PlanarMotion v :
       {kinematics::PlanarMotion{0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 1}, {0.3, 0.1, 0.6}})
    expect_arc(c, level, v, tolerance);
}
TEST(DrivesOnRigid, SwerveOnRails) { expect_all_ways(swerve, ideal, 1e-3); }
// Balls that roll: what is left is the slip that contact's softness (CFM) allows, some 1e-3 of the way.
TEST(DrivesOnRigid, SwerveOnWheels) { expect_all_ways(swerve, contact, 5e-3); }
TEST(DrivesOnRigid, MecanumOnRails) { expect_all_ways(mecanum, ideal, 1e-3); }
TEST(DrivesOnRigid, MecanumOnSolidWheels) { expect_all_ways(mecanum, contact, 5e-3); }
TEST(DrivesOnRigid, MecanumOnRollers) { expect_all_ways(mecanum, rollers, 0.03); }
TEST(DrivesOnRigid, OmniOnRails) { expect_all_ways(omni, ideal, 1e-3); }
TEST(DrivesOnRigid, OmniOnSolidWheels) { expect_all_ways(omni, contact, 5e-3); }
TEST(DrivesOnRigid, OmniOnRollers) { expect_all_ways(omni, rollers, 0.03); }

TEST(DrivesOnRigid, ASkidDriveTurnsAsItsTrackRatioSays) {
  expect_arc(skid, contact, {0.5, 0, 0}, 5e-3);
  // The ratio of isotropic friction is exact while turning in place with equal loads.
  const auto spin = moved(skid, contact, {0, 0, 0.8}, 1);
  EXPECT_NEAR(spin.turn, 0.8, 0.02 * 0.8);
  EXPECT_NEAR(math::hypot(spin.x, spin.y), 0, 5e-3);
  expect_arc(skid, ideal, {0.3, 0, 0.8}, 1e-3);
}

TEST(DrivesOnRigid, ASwitchInMidRunKeepsPoseVelocityAndOdometry) {
  for (const Case* c : {&swerve, &car, &skid, &mecanum, &omni}) {
    const bool has_rollers = c == &mecanum || c == &omni;
    SCOPED_TRACE(c->kind);
    World world("rigid", c->kind, c->model(), map(c->keys), ideal);
    world.command(0.5, 0, 0);
    world.run(100);
    for (const std::uint32_t level : {contact, ideal, has_rollers ? rollers : contact, ideal, contact,
                                      has_rollers ? rollers : ideal, contact}) {
      const Vec3 at = world.base().X_WB.p, v = world.base().V_WB.linear;
      const Pose counted = world.odometry();
      world.switch_to(level);
      world.run(1);
      // One tick further on: 5 mm ahead, at the same speed, and the odometry goes on from where it was.
      EXPECT_NEAR(world.base().X_WB.p.x, at.x + 0.005, 5e-4);
      EXPECT_NEAR(world.base().X_WB.p.y, at.y, 5e-4);
      EXPECT_NEAR(world.base().V_WB.linear.x, v.x, 0.02);
      EXPECT_NEAR(world.odometry().p.x, counted.p.x + 0.005, 1e-3);
      // The command is still in force. In the mean: rollers with gaps between them jolt at each change from
      // one to the next.
      const double from = world.base().X_WB.p.x;
      world.run(40);
      EXPECT_NEAR((world.base().X_WB.p.x - from) / 0.4, 0.5, 0.005);
    }
  }
}

/// Way from one pose of B to another, of D.
Pose way_of(const Case& c, const Pose& from, const Pose& to) {
  const Pose X_BD{{c.dx, 0, 0}, {}};
  return inverse(from * X_BD) * (to * X_BD);
}

/// Each maneuver ends within 1 mm and 1 mrad of its goal by the drive's own odometry; a tick of it passes until that is seen,
/// and wheels that slow down roll on for another.
void expect_maneuvers(const char* engine, const Case& c, std::uint32_t level, const Node& config,
                      double near_m, double near_rad, double late_s) {
  SCOPED_TRACE(std::string(engine) + " " + c.kind + " level " + std::to_string(level));
  World world(engine, c.kind, c.model(), config, level);
  world.run(20);
  using msg::DriveManeuver;
  const auto ends_at = [&](const DriveManeuver& command, double x, double y, double turn, double seconds) {
    SCOPED_TRACE("kind " + std::to_string(command.kind));
    const Pose from = world.odometry();
    EXPECT_NEAR(world.maneuver(command) * 0.01, seconds, late_s);
    world.run(20);
    const Pose way = way_of(c, from, world.odometry());
    EXPECT_NEAR(way.p.x, x, near_m);
    EXPECT_NEAR(way.p.y, y, near_m);
    EXPECT_NEAR(yaw_of(way.q), turn, &c == &car ? 0.02 : near_rad);
  };
  // Trapezoids at 0.4 m/s and 2 m/s^2, on the arc of 0.6 m as well; the turn at 1 rad/s and 10 rad/s^2.
  ends_at({.kind = DriveManeuver::straight, .distance = 0.6, .speed = 0.4}, 0.6, 0, 0, 0.6 / 0.4 + 0.2);
  const double radius_m = 0.6 / 0.5;
  ends_at({.kind = DriveManeuver::curve, .distance = 0.6, .angle = 0.5, .speed = 0.4},
          radius_m * math::sin(0.5), radius_m * (1 - math::cos(0.5)), 0.5, 0.6 / 0.4 + 0.2);
  const double half = math::atan2(0.2, 0.8), arc_m = math::hypot(0.8, 0.2) * half / math::sin(half);
  ends_at({.kind = DriveManeuver::to_point, .x = 0.8, .y = 0.2, .speed = 0.4}, 0.8, 0.2, 2 * half,
          arc_m / 0.4 + 0.2);
  if (&c == &car) return;
  ends_at({.kind = DriveManeuver::turn, .angle = -1.5, .turning_rate = 1}, 0, 0, -1.5, 1.5 + 0.1);
}

TEST(DrivesOnEngines, EveryDriveCoversItsManeuvers) {
  for (const char* engine : {"rigid", "planar"})
    for (const Case* c : {&swerve, &car, &skid, &mecanum, &omni})
      for (const std::uint32_t level : {ideal, contact, rollers}) {
        const bool has_rollers = c == &mecanum || c == &omni;
        if (level == rollers && (!has_rollers || std::string_view(engine) == "planar")) continue;
        // The steering takes its time while it turns from one way to the next. On planar rails a robot with forks attains less
        // than half of its acceleration: that is learnt on the way.
        const bool steers = c == &swerve || c == &car;
        const bool slow = steers && std::string_view(engine) == "planar";
        expect_maneuvers(engine, *c, level, map(c->keys),
                         slow     ? 8e-3
                         : steers ? 5e-3
                                  : 2e-3,
                         steers ? 5e-3 : 2e-3,
                         slow     ? 0.8
                         : steers ? 0.5
                                  : 0.15);
      }
}

TEST(DrivesOnEngines, ManeuversWithLoopsMotorsAndCoarseEncoders) {
  Node loops = map(skid.keys);
  loops.set("control", Node::map());
  expect_maneuvers("rigid", skid, contact, loops, 8e-3, 0.012, 1.5);
  Node motors = map(skid.keys);
  motors.set("motor", map({{"supply_voltage", "24"},
                           {"resistance", "0.6"},
                           {"torque_constant", "0.026"},
                           {"gear_ratio", "14"}}));
  expect_maneuvers("rigid", skid, contact, motors, 2e-3, 2e-3, 0.2);
  // 500 edges per turn of a wheel of 0.1 m: 1.26 mm each; of the chassis, at the skid's effective track, 3 mrad.
  Node coarse = map(skid.keys);
  coarse.set("encoder_ticks", Node::scalar("500"));
  expect_maneuvers("rigid", skid, contact, coarse, 5e-3, 8e-3, 0.3);
}

TEST(DrivesOnRigid, SlipShowsInTheResidualAndPowerInTheEnergy) {
  // On the spot a skid drive slides: its wheels agree, so least squares do not see it; a swerve drive whose
  // wheels are told to contradict each other does.
  World world("rigid", swerve.kind, robot(true, true), map(swerve.keys), contact);
  world.command(0.3, 0, 0);
  world.run(100);
  EXPECT_LT(world.state("residual"), 2e-5);
  auto& slot = *topic_cast<msg::JointState>(world.topics.at("/robot1/drive/contact/wheels/command").get());
  slot.message.velocity = {3, 3, 3, 6};  // one wheel at twice the speed: 3 mm more per tick
  slot.message.position = std::vector<double>(8, 0.0);
  slot.stamp = world.now;
  ++slot.count;
  world.run(50);
  // As in kinematics/wheels_test: sqrt((1 - 1/4 - turn's part) / 4) of it; the turn's part lies below 1/4.
  EXPECT_GT(world.state("residual"), 0.003 * std::sqrt(0.5 / 4) * 0.98);
  EXPECT_LT(world.state("residual"), 0.003 * std::sqrt(0.75 / 4) * 1.02);
  // Friction's power: the slipping wheel drags against the others.
  EXPECT_GT(world.state("power"), 1);

  // From rest to 0.5 m/s: kinetic energy of 13.2 kg and of the balls' rotation, 2/5 of 2 kg; friction at the
  // contacts takes a few percent more.
  World start("rigid", swerve.kind, robot(true, true), map(swerve.keys), contact);
  start.run(20);
  const double before = start.state("energy");
  start.command(0.5, 0, 0);
  start.run(60);
  const double kinetic = 0.5 * (10 + 4 * 0.8) * 0.25 + 0.5 * 0.4 * 4 * 0.5 * 0.25;
  EXPECT_GT(start.state("energy") - before, 0.97 * kinetic);
  EXPECT_LT(start.state("energy") - before, 1.2 * kinetic);
}

}  // namespace
}  // namespace sandlot::wheeled
