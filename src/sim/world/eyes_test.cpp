/// Cameras and what they are mounted on, in whole worlds.
#include "assets/image/image.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"
#include "sim/test_world.h"
#include "sim/world/transforms.h"

namespace sandlot::test {
namespace {

class OnBothEngines : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, OnBothEngines, testing::Values("rigid", "planar"));

void give(model::Instance& robot, const char* name, const char* kind, Node config, Pose X_LS = {},
          std::uint32_t link = 0) {
  model::DeviceDecl decl;
  decl.name = name;
  decl.kind = kind;
  decl.link = link;
  decl.X_LS = X_LS;
  decl.config = std::move(config);
  robot.devices.push_back(std::move(decl));
}

Node levels(std::initializer_list<const char*> names) {
  Node list = Node::sequence();
  for (const char* name : names) list.push(Node::scalar(name));
  return list;
}

/// Shows all collision shapes, in grey.
void make_visible(model::Setup& setup) {
  for (model::Instance& instance : setup.instances) {
    auto copy = std::make_shared<model::Model>(*instance.model);
    for (model::Link& link : copy->links)
      for (const model::Collision& collision : link.collisions) {
        model::Visual visual;
        visual.shape = collision.shape;
        visual.X_LC = collision.X_LC;
        link.visuals.push_back(std::move(visual));
      }
    instance.model = std::move(copy);
  }
}

/// A rover that wanders between pillars and crates and looks at them.
model::Setup seeing_arena(const char* engine) {
  model::Setup setup = arena(engine, 2);
  make_visible(setup);
  for (model::Instance& robot : setup.instances) {
    if (!robot.is_robot) continue;
    Node eye = map(
        {{"width", "32"}, {"height", "24"}, {"rate", "10"}, {"samples", "2"}, {"compressed", "png"}});
    Node noise = Node::sequence(), stage = Node::map();
    stage.set("gaussian", map({{"std", "0.02"}}));
    noise.push(std::move(stage));
    eye.set("noise", std::move(noise));
    eye.set("objects", map({{"range_std", "0.05"}, {"ghost_rate", "1"}, {"miss_rate", "0.1"}}));
    eye.set("levels", levels({"image", "objects", "world"}));
    give(robot, "eye", "camera", std::move(eye), {{0.2, 0, 0.2}, {}});
    give(robot, "dome", "omni_camera", map({{"width", "24"}, {"height", "24"}, {"rate", "5"}}),
         {{0, 0, 0.3}, {}});
    give(robot, "eyes", "stereo_camera", map({{"width", "16"}, {"height", "12"}, {"rate", "5"}}),
         {{0.2, 0, 0.2}, {}});
  }
  return setup;
}

TEST_P(OnBothEngines, PicturesAndDetectionsDoNotDependOnThreadsOrOnARestore) {
  const auto one = build(seeing_arena(GetParam()), {.threads = 1}),
             four = build(seeing_arena(GetParam()), {.threads = 4});
  advance(*one, 25);
  const auto saved = one->snapshot();
  Diagnostics diagnostics;
  auto restored = Simulation::restore(saved, {.threads = 2}, diagnostics);
  ASSERT_TRUE(restored) << restored.error().text();
  advance(*one, 15), advance(**restored, 15), advance(*four, 40);
  EXPECT_EQ(one->state_hash(), four->state_hash());
  EXPECT_EQ(one->state_hash(), (*restored)->state_hash());
  const auto* const image = topic_cast<msg::Image>(one->find_topic("/rover1/eye/image"));
  ASSERT_TRUE(image && image->count == 5);  // at 0, 0.1, ... 0.4 s
  EXPECT_NE(*std::min_element(image->message.data.begin(), image->message.data.end()),
            *std::max_element(image->message.data.begin(), image->message.data.end()));
  EXPECT_EQ(topic_cast<msg::Image>(one->find_topic("/rover1/eyes/right/image"))->count, 3u);
  // Without loss: the file's bytes are the picture.
  const auto& png = topic_cast<msg::CompressedImage>(one->find_topic("/rover1/eye/image/compressed"))
                        ->message;
  const auto decoded = assets::parse_image({reinterpret_cast<const char*>(png.data.data()), png.data.size()},
                                           "eye");
  ASSERT_TRUE(decoded) << decoded.error().text();
  ASSERT_EQ(decoded->data.size(), image->message.data.size());
  EXPECT_TRUE(std::equal(decoded->data.begin(), decoded->data.end(), image->message.data.begin()));
}

TEST_P(OnBothEngines, ObserversSeeHashesThatFollowPictures) {
  struct Watcher : Observer {
    Wants wants() const override { return {.messages = true, .hash = true}; }
    void on_frame(const std::shared_ptr<const Frame>& frame) override { hashes.push_back(frame->hash); }
    std::vector<std::uint64_t> hashes;
  } watcher;
  const auto sim = build(seeing_arena(GetParam()));
  sim->add_observer(&watcher);
  for (int i = 0; i < 12; ++i) {
    advance(*sim, 1);
    EXPECT_EQ(watcher.hashes.back(), sim->state_hash()) << i;
  }
}

TEST(Eyes, HaveOpticalFramesInTf) {
  const auto sim = build(seeing_arena("planar"));
  int found = 0;
  for (const auto& tf : static_transforms(*sim).transforms)
    if (tf.child_frame_id == "rover1/eye_optical") {
      ++found;
      EXPECT_EQ(tf.header.frame_id, "rover1/eye");
      EXPECT_LT(norm(rotate(tf.transform.rotation, {0, 0, 1}) - Vec3{1, 0, 0}), 1e-12);
    }
  EXPECT_EQ(found, 1);
}

/// A table that stands still with an eye on a pan-tilt head, and a ball.
model::Setup sentry(const char* engine, Vec3 ball_m) {
  auto owl = std::make_shared<model::Model>();
  owl->name = "owl";
  const auto add_link = [&](const char* name, Vec3 at, const Shape& shape, double mass_kg) {
    model::Link link;
    link.name = name;
    link.X_ML.p = at;
    link.inertial.mass_kg = mass_kg;
    link.inertial.moments = inertia_kg_m2(shape, mass_kg);
    link.collisions.push_back({"collision", {}, shape, {}, {}});
    owl->links.push_back(std::move(link));
  };
  add_link("base", {0, 0, 0.2}, Box{{0.4, 0.4, 0.4}}, 30);
  add_link("neck", {0, 0, 0.5}, Box{{0.1, 0.1, 0.1}}, 0.5);
  add_link("head", {0, 0, 0.65}, Box{{0.1, 0.1, 0.1}}, 0.5);
  for (const std::uint32_t child : {1u, 2u}) {
    model::Joint joint;
    joint.name = child == 1 ? "pan" : "tilt";
    joint.type = model::JointType::revolute;
    joint.parent = child - 1;
    joint.child = child;
    joint.axis_J = child == 1 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    joint.lower = child == 1 ? -2.9 : -1;
    joint.upper = child == 1 ? 2.9 : 1;
    owl->joints.push_back(joint);
  }
  model::Setup setup;
  setup.name = "sentry";
  setup.engine = engine;
  setup.step = Time::from_s(0.01);
  setup.substeps = 2;
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  setup.instances.push_back(placed("ball1", one_shape("ball", Sphere{0.15}, 0), {ball_m, {}}));
  model::Instance robot = placed("owl", owl, {});
  robot.is_robot = true;
  Node eye = map({{"level", "objects"}, {"rate", "25"}});
  give(robot, "eye", "camera", std::move(eye), {{0.06, 0, 0}, {}}, 2);
  give(robot, "unit", "pan_tilt",
       map({{"pan_joint", "pan"},
            {"tilt_joint", "tilt"},
            {"camera", "eye"},
            {"level", "view"},
            {"search_speed", "1.5"}}));
  setup.instances.push_back(std::move(robot));
  return setup;
}

template <class M>
void command(Simulation& sim, const char* target, const M& message) {
  ByteWriter w;
  write(w, message);
  sim.submit(CommandRequest{target, M::ros_type, {w.bytes().begin(), w.bytes().end()}});
}

/// Angle between the eye's axis and a point.
double off(const Simulation& sim, Vec3 point_W) {
  const auto bodies = sim.engine().bodies(*sim.find_instance("owl"));
  const Pose X_WS = sim.engine().states()[bodies[2].index].X_WB * Pose{{0.06, 0, 0}, {}};
  const Vec3 p = inverse(X_WS) * point_W;
  return math::atan2(std::sqrt(p.y * p.y + p.z * p.z), p.x);
}

TEST_P(OnBothEngines, AHeadFindsABallWithItsCameraAndLooksAtPoints) {
  const Vec3 ball{-1, 1.5, 0.15};
  const auto sim = build(sentry(GetParam(), ball));
  EXPECT_GT(off(*sim, ball), 1);
  command(*sim, "owl/unit", msg::String{"search ball"});
  advance(*sim, 400);
  EXPECT_EQ(sim->refused_commands(), 0u);
  EXPECT_LT(off(*sim, ball), 0.02);
  const auto* const objects = topic_cast<msg::ObjectArray>(sim->find_topic("/owl/eye/objects"));
  ASSERT_TRUE(objects);
  ASSERT_EQ(objects->message.objects.size(), 1u);
  EXPECT_NEAR(objects->message.objects[0].bearing, 0, 0.02);
  msg::PointStamped point;
  point.header.frame_id = "world";
  point.point = {2, -0.5, 0.5};
  command(*sim, "owl/unit", point);
  advance(*sim, 300);
  EXPECT_LT(off(*sim, point.point), 0.02);
  // Commands of the other level are refused, until it is the active one.
  msg::JointState angles;
  angles.position = {0.5, 0.25};
  command(*sim, "owl/unit", angles);
  advance(*sim, 1);
  EXPECT_EQ(sim->refused_commands(), 1u);
  sim->submit(LevelRequest{"owl/unit", {"joints"}});
  advance(*sim, 1);
  command(*sim, "owl/unit", angles);
  advance(*sim, 200);
  EXPECT_NEAR(topic_cast<msg::JointState>(sim->find_topic("/owl/unit/state"))->message.position.at(0), 0.5,
              0.01);
}

}  // namespace
}  // namespace sandlot::test
