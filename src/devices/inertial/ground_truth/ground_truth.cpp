#include "devices/inertial/ground_truth/ground_truth.h"

#include "devices/sdf_noise.h"

namespace sandlot::ground_truth {
namespace {

/// Gazebo's publishers of exact poses.
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  SL_TRY(copy_number(element, {"odom_publish_frequency", "update_frequency", "update_rate", "updateRate"},
                     1.0, config, "rate"));
  for (const char* name : {"bodyName", "body_name"})
    if (find(element, name)) copy(element, name, config, "link");
  SL_ASSIGN(const auto noise,
            number(element, find(element, "gaussianNoise") ? "gaussianNoise" : "gaussian_noise"));
  if (noise && *noise != 0) {
    // Both publishers put it on the velocities alone.
    const Node& place = *find(element, find(element, "gaussianNoise") ? "gaussianNoise" : "gaussian_noise");
    Node std = Node::map(place.place()), stage = std, chain = Node::sequence(place.place()), noises = std;
    std.set("std", scalar(*noise, place));
    stage.set("gaussian", std::move(std));
    chain.push(std::move(stage));
    noises.set("velocity", chain);
    noises.set("angular_velocity", std::move(chain));
    config.set("noise", std::move(noises));
  }
  warn_unknown(element,
               {"odom_publish_frequency", "update_frequency", "update_rate", "updateRate", "bodyName",
                "body_name", "gaussianNoise", "gaussian_noise"},
               "a publisher of exact poses", diagnostics);
  return config;
}

void reset(const ChainSpec& spec, Axes& axes, const Stream& random, const std::string& name) {
  axes.x.reset(spec.stages, random, name + "/x");
  axes.y.reset(spec.stages, random, name + "/y");
  axes.z.reset(spec.stages, random, name + "/z");
}

}  // namespace

Result<GroundTruth> GroundTruth::create(const DeviceBuild& build, Spec spec) {
  GroundTruth truth{spec};
  truth.body = build.body().index;
  truth.X_LS = build.decl.X_LS;
  truth.key = build.key;
  const Stream random(build.seed, build.key, Purpose::initial, 0);
  reset(spec.noise.position, truth.state.position, random, "position");
  reset(spec.noise.orientation, truth.state.orientation, random, "orientation");
  reset(spec.noise.velocity, truth.state.velocity, random, "velocity");
  reset(spec.noise.angular_velocity, truth.state.angular_velocity, random, "angular_velocity");
  truth.odometry = build.publish<msg::Odometry>(0, "pose");
  truth.odometry->message.header.frame_id = "world";
  truth.odometry->message.child_frame_id = build.frame_id();
  return truth;
}

void GroundTruth::sense(PoolView<GroundTruth> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    GroundTruth& truth = pool.all[index];
    const BodyState& link = context.engine.states()[truth.body];
    msg::Odometry& message = truth.odometry->message;
    message.pose.pose = link.X_WB * truth.X_LS;
    const Vec3 p_LS_W = rotate(link.X_WB.q, truth.X_LS.p);
    message.twist.twist.linear = rotate_inverse(message.pose.pose.q,
                                                link.V_WB.linear + cross(link.V_WB.angular, p_LS_W));
    message.twist.twist.angular = rotate_inverse(message.pose.pose.q, link.V_WB.angular);
    const Stream random(context.seed, truth.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    const auto corrupt = [&](const ChainSpec& chain, Axes& axes, Vec3& v) {
      if (chain.stages.empty()) return;
      v.x = axes.x.corrupt(chain.stages, v.x, dt_s, random, truth.spec.errors);
      v.y = axes.y.corrupt(chain.stages, v.y, dt_s, random, truth.spec.errors);
      v.z = axes.z.corrupt(chain.stages, v.z, dt_s, random, truth.spec.errors);
    };
    const NoiseSpec& noise = truth.spec.noise;
    corrupt(noise.position, truth.state.position, message.pose.pose.p);
    if (!noise.orientation.stages.empty()) {
      Vec3 rpy = rpy_from_quat(message.pose.pose.q);
      corrupt(noise.orientation, truth.state.orientation, rpy);
      message.pose.pose.q = quat_from_rpy(rpy.x, rpy.y, rpy.z);
    }
    corrupt(noise.velocity, truth.state.velocity, message.twist.twist.linear);
    corrupt(noise.angular_velocity, truth.state.angular_velocity, message.twist.twist.angular);
    truth.odometry->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"pose", msg::Odometry::ros_type, "", "Pose and velocity in the world."},
};
constexpr const char* sdf_types[] = {"plugin:OdometryPublisher",
                                     "plugin:gz-sim-odometry-publisher-system",
                                     "plugin:ignition-gazebo-odometry-publisher-system",
                                     "plugin:PosePublisher",
                                     "plugin:gz-sim-pose-publisher-system",
                                     "plugin:ignition-gazebo-pose-publisher-system",
                                     "plugin:gazebo_ros_p3d"};
}  // namespace

constinit const Kind kind = make_kind<GroundTruth>({
    .name = "ground_truth",
    .help = "Pose and velocity of a link, exact or with errors.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, TF, poses of the other links, the plane of OdometryPublisher "
                "(dimensions)",
});

}  // namespace sandlot::ground_truth
