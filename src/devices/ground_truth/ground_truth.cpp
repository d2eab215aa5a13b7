#include "devices/ground_truth/ground_truth.h"

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
  if (noise && *noise != 0)
    diagnostics.warn(element.error("noise of an exact pose is not supported and has no effect"));
  warn_unknown(element,
               {"odom_publish_frequency", "update_frequency", "update_rate", "updateRate", "bodyName",
                "body_name", "gaussianNoise", "gaussian_noise"},
               "a publisher of exact poses", diagnostics);
  return config;
}

}  // namespace

Result<GroundTruth> GroundTruth::create(const DeviceBuild& build, Spec spec) {
  GroundTruth truth{spec};
  truth.body = build.body().index;
  truth.X_LS = build.decl.X_LS;
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
    truth.odometry->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"pose", msg::Odometry::ros_type, "", "Exact pose and velocity in the world."},
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
    .help = "Exact pose and velocity of a link.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, TF, noise, poses of the other links, the plane of OdometryPublisher "
                "(dimensions)",
});

}  // namespace sandlot::ground_truth
