#include "devices/ground_truth/ground_truth.h"

namespace sandlot::ground_truth {

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
    message.pose = link.X_WB * truth.X_LS;
    const Vec3 p_LS_W = rotate(link.X_WB.q, truth.X_LS.p);
    message.twist.linear = rotate_inverse(message.pose.q,
                                          link.V_WB.linear + cross(link.V_WB.angular, p_LS_W));
    message.twist.angular = rotate_inverse(message.pose.q, link.V_WB.angular);
    truth.odometry->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"pose", msg::Odometry::ros_type, "", "Exact pose and velocity in the world."},
};
}  // namespace

constinit const Kind kind = make_kind<GroundTruth>({
    .name = "ground_truth",
    .help = "Exact pose and velocity of a link.",
    .levels = levels,
});

}  // namespace sandlot::ground_truth
