#pragma once
/// For the tests of devices: an engine small enough to be computed by hand, and what builds and steps one
/// pool in it.
///
/// The engine holds one instance. A joint with a velocity target has that velocity; one with an effort target
/// obeys inertia * acceleration = effort exactly over a step. A base with a drive target moves exactly on the
/// arc of its velocity, which follows the target with the accelerations given. `blocked` holds the base where
/// it is.
#include <algorithm>
#include <map>

#include "base/math.h"
#include "devices/kind.h"

namespace sandlot::test {

class HandEngine final : public Engine {
 public:
  Capabilities what{.name = "hand",
                    .joints = true,
                    .contact_drives = true,
                    .ideal_drives = true,
                    .contact_forces = true,
                    .joint_loads = true};
  std::vector<BodyId> body_ids;
  std::vector<JointId> joint_ids;
  std::vector<BodyState> body;
  std::vector<JointState> joint;
  std::vector<JointTarget> target;
  std::vector<double> inertia, outside;  ///< per joint; the second is an effort from outside
  std::vector<Contact> contact;          ///< set by the test
  std::vector<JointLoad> loads;          ///< likewise
  Watch watched;                         ///< in the last step
  std::vector<BodyName> names;           ///< what the test calls the bodies
  DriveTarget drive{.active = false};
  bool blocked = false;
  std::size_t drive_targets_given = 0;
  std::vector<WheelTarget> wheel_targets;  ///< all that were given

  explicit HandEngine(const model::Model& model)
      : body(model.links.size()),
        joint(model.joints.size()),
        target(model.joints.size()),
        inertia(model.joints.size(), 1.0),
        outside(model.joints.size()),
        loads(model.joints.size()) {
    for (std::uint32_t i = 0; i < body.size(); ++i) {
      body_ids.push_back({i, 1});
      body[i].X_WB = model.links[i].X_ML;
    }
    for (std::uint32_t i = 0; i < joint.size(); ++i) joint_ids.push_back({i, 1});
  }

  Capabilities capabilities() const override { return what; }
  Result<InstanceId> add(const model::Instance&) override { return InstanceId{0, 1}; }
  void remove(InstanceId) override {}
  std::span<const BodyId> bodies(InstanceId) const override { return body_ids; }
  std::span<const JointId> joints(InstanceId) const override { return joint_ids; }
  void set_pose(InstanceId, const Pose&) override {}
  void set_velocity(InstanceId, const Velocity&) override {}
  void guide(InstanceId, const Pose&, const Velocity&) override {}
  BodyName name(BodyId id) const override { return id.index < names.size() ? names[id.index] : BodyName{}; }
  Pose pose(InstanceId) const override { return body[0].X_WB; }
  std::span<const BodyState> states() const override { return body; }
  std::span<const JointState> joint_states() const override { return joint; }
  std::span<const Contact> contacts() const override { return contact; }
  void watch(const Watch& w) override { watched = w; }
  std::span<const JointLoad> joint_loads() const override { return loads; }
  void overlaps(std::span<const OverlapQuery>, std::vector<std::uint32_t>&,
                std::vector<std::uint32_t>&) const override {}
  const RayCaster* rays() const override { return nullptr; }
  void apply(std::span<const Wrench>) override {}
  void set_targets(std::span<const JointTarget> targets) override {
    for (const JointTarget& t : targets) target[t.joint.index] = t;
  }
  void set_drive_targets(std::span<const DriveTarget> targets) override {
    drive_targets_given += targets.size();
    for (const DriveTarget& t : targets) drive = t;
  }
  void set_wheels(std::span<const WheelTarget> targets) override {
    wheel_targets.insert(wheel_targets.end(), targets.begin(), targets.end());
  }
  void step(double h_s, std::uint64_t) override {
    for (std::size_t i = 0; i < joint.size(); ++i) {
      JointState& j = joint[i];
      double acceleration = 0;
      if (target[i].mode == JointTarget::Mode::velocity) j.velocity = target[i].velocity;
      j.effort = 0;
      if (target[i].mode == JointTarget::Mode::effort) {
        // (inertia + rotor) a = effort + outside - damping (v + a h) - friction
        const JointTarget& t = target[i];
        const double push = t.effort + outside[i] - t.damping * j.velocity, rotor = inertia[i] + t.inertia;
        const double stop = push +
                            j.velocity * (rotor / h_s + t.damping);  // what friction must hold to stop it now
        const double rub = std::clamp(stop, -t.friction, t.friction);
        acceleration = (push - rub) / (rotor + t.damping * h_s);
        j.effort = t.effort - t.damping * (j.velocity + acceleration * h_s) - t.inertia * acceleration;
      }
      j.position += j.velocity * h_s + 0.5 * acceleration * h_s * h_s;
      j.velocity += acceleration * h_s;
    }
    if (drive.active) step_base(h_s);
  }
  Status check_finite() const override { return {}; }
  void save(InstanceId, ByteWriter&) const override {}
  bool load(InstanceId, ByteReader&) override { return true; }
  EngineCounters counters() const override { return {}; }

 private:
  static double towards(double from, double to, double step) {
    return from + std::clamp(to - from, -step, step);
  }

  void step_base(double h_s) {
    BodyState& base = body[0];
    const Vec3 v_B = rotate_inverse(base.X_WB.q, base.V_WB.linear);
    const double vx = blocked ? 0 : towards(v_B.x, drive.vx_mps, drive.max_accel_mps2 * h_s);
    const double vy = blocked ? 0 : towards(v_B.y, drive.vy_mps, drive.max_accel_mps2 * h_s);
    const double omega = blocked ? 0
                                 : towards(base.V_WB.angular.z, drive.wz_radps,
                                           drive.max_angular_accel_radps2 * h_s);
    // Constant body velocity over h: the exact displacement is the chord, turned by half the angle.
    const double half = 0.5 * omega * h_s;
    const double sinc = std::abs(half) < 1e-6 ? 1 - half * half / 6 : math::sin(half) / half;
    const Quat half_turn = quat_from_axis_angle({0, 0, 1}, half);
    base.X_WB.p += rotate(base.X_WB.q * half_turn, Vec3{vx, vy, 0}) * (h_s * sinc);
    base.X_WB.q = normalised(base.X_WB.q * half_turn * half_turn);
    base.V_WB = {rotate(base.X_WB.q, {vx, vy, 0}), {0, 0, omega}};
  }
};

/// A caster for devices that cast nothing.
class NoRays final : public RayCaster {
 public:
  void cast(std::span<const RayJob>) const override {}
};

/// One pool of a kind, stepped as the simulation does.
class Rig : public TopicMaker {
 public:
  model::Instance instance;
  std::unique_ptr<HandEngine> engine;
  std::unique_ptr<PoolBase> pool;
  std::map<std::string, std::unique_ptr<TopicBase>> topics;  ///< messages and commands by name
  std::vector<std::unique_ptr<DeviceOrder>> orders;  ///< declared by the devices; a test connects them
  std::map<std::string, Pose> frames;                ///< in addition to the sensors' own, as X_SF
  std::unique_ptr<Inbox> inbox;                      ///< of the latest device
  std::unique_ptr<SceneLight> light;                 ///< likewise
  std::vector<model::ElementDecl> media;
  const RayCaster* rays = nullptr;
  optics::PictureScene* pictures = nullptr;
  std::vector<LabelledObject> things;
  const TopicFinder* finder = nullptr;
  ImageEncoder encoder = nullptr;
  EnergyMeter* energy = nullptr;     ///< of the next devices
  EnergyAccount* account = nullptr;  ///< of a battery
  Time now, tick;
  std::uint64_t tick_index = 0, seed = 1;
  Vec3 gravity_mps2{0, 0, -9.81}, magnetic_field_T{};
  std::optional<model::Geography> geography;
  Actuation actuation;
  EmissionBuffer emissions;
  std::vector<std::uint32_t> all, levels;
  std::vector<std::uint64_t> sample;
  std::vector<Time> since;

  Rig(const Kind& kind, model::Model model, double tick_s = 0.01)
      : engine(std::make_unique<HandEngine>(model)), pool(kind.create_pool()), tick(Time::from_s(tick_s)) {
    instance.name = "robot1";
    instance.model = std::make_shared<const model::Model>(std::move(model));
  }
  Status add(const std::string& name, Node config, std::uint32_t level_bits = 1, std::uint32_t link = 0,
             Pose X_LS = {}) {
    model::DeviceDecl decl{.name = name, .link = link, .X_LS = X_LS, .config = std::move(config)};
    decl.place = {std::make_shared<const std::string>("robot.yaml"), 12, 5};
    const std::string path = "robot1/" + name;
    SL_TRY(pool->add({decl, instance, path, entity_key(path), seed, engine->body_ids, engine->joint_ids,
                      engine->what, tick, level_bits, *this, gravity_mps2, geography, magnetic_field_T, 1,
                      encoder, media, energy, account}));
    all.push_back(static_cast<std::uint32_t>(all.size()));
    levels.push_back(level_bits);
    sample.push_back(0);
    since.push_back(tick);
    return {};
  }
  template <class M>
  Topic<M>& topic(const std::string& name) {
    Topic<M>* const found = topic_cast<M>(topics.at("/robot1/" + name).get());
    SL_CHECK(found != nullptr);
    return *found;
  }
  template <class M>
  void command(const std::string& name, const M& message) {
    Topic<M>& slot = topic<M>(name + "/command");
    slot.message = message;
    slot.stamp = now;
    ++slot.count;
  }
  Context context(Time at) {
    return {at,        tick,      tick_index, seed,   *engine, rays ? *rays : none_,
            actuation, emissions, pictures,   things, finder};
  }
  PoolBase::Due due() const { return {all, sample, levels, since}; }

  /// One tick without sensing.
  void act(int substeps = 1) {
    actuation.clear();
    pool->actuate(context(now + tick), due());
    const double h_s = tick.s() / substeps;
    for (int i = 0; i < substeps; ++i) {
      pool->pre_substep(context(now + tick), due(), h_s);
      engine->watch(actuation.watch);
      engine->set_targets(actuation.joints);
      engine->set_drive_targets(actuation.drives);
      engine->set_wheels(actuation.wheels);
      engine->step(h_s, 0);
      pool->post_substep(context(now + tick), due(), h_s);
      actuation.clear();
    }
    now = now + tick;
    ++tick_index;
  }
  void sense() {
    pool->sense(context(now), due());
    for (std::uint64_t& k : sample) ++k;
  }
  Status switch_level(std::uint32_t after) {
    SL_TRY(pool->switch_level(0, levels[0], after, context(now)));
    levels[0] = after;
    return {};
  }
  std::vector<std::byte> saved(std::uint32_t index = 0) const {
    ByteWriter w;
    pool->save(index, w);
    return w.buffer();
  }
  void load(std::span<const std::byte> bytes, std::uint32_t index = 0) {
    ByteReader r(bytes);
    pool->load(index, r);
    SL_CHECK(r.ok() && r.remaining() == 0);
  }

  void adopt_topic(std::unique_ptr<TopicBase> made, std::uint32_t) override { keep(std::move(made)); }
  void adopt_command(std::unique_ptr<TopicBase> made, std::uint32_t) override { keep(std::move(made)); }
  void adopt_frame(std::string name, const Pose& X_SF) override { frames[name] = X_SF; }
  void adopt_order(std::unique_ptr<DeviceOrder> order) override { orders.push_back(std::move(order)); }
  void adopt_inbox(std::unique_ptr<Inbox> made) override { inbox = std::move(made); }
  void adopt_light(std::unique_ptr<SceneLight> made) override { light = std::move(made); }

 private:
  void keep(std::unique_ptr<TopicBase> made) {
    const std::string name = made->name();
    topics[name] = std::move(made);
  }
  NoRays none_;
};

/// A map of scalars with places line 1, 2, ...; lists are added by the test.
inline Node config(std::initializer_list<std::pair<const char*, const char*>> entries) {
  const auto file = std::make_shared<const std::string>("robot.yaml");
  Node node = Node::map({file, 1, 1});
  int line = 1;
  for (const auto& [key, value] : entries) node.set(key, Node::scalar(value, {file, line++, 9}));
  return node;
}

/// A base with two wheels of 0.1 m radius, 0.5 m apart, the axle's centre at (axle_x_m, axle_y_m) of the
/// base; a passive slider, too.
inline model::Model two_wheels(double axle_x_m = 0, double axle_y_m = 0) {
  model::Model model;
  model.name = "rover";
  for (const char* name : {"chassis", "left_wheel", "right_wheel", "mast"})
    model.links.push_back({.name = name});
  model.links[1].X_ML.p = {axle_x_m, axle_y_m + 0.25, 0};
  model.links[2].X_ML.p = {axle_x_m, axle_y_m - 0.25, 0};
  // The wheel links are turned so that their cylinders lie across: the joint axis is z of the link.
  for (const std::size_t i : {1u, 2u}) {
    model.links[i].X_ML.q = quat_from_rpy(-math::pi / 2, 0, 0);
    model.links[i].collisions.push_back({.shape = Cylinder{0.1, 0.04}});
  }
  model.joints = {
      {.name = "left", .type = model::JointType::continuous, .child = 1},
      {.name = "right", .type = model::JointType::continuous, .child = 2},
      {.name = "lift", .type = model::JointType::prismatic, .child = 3, .lower = 0, .upper = 0.5}};
  return model;
}

}  // namespace sandlot::test
