#include "controllers/visual_odometry/visual_odometry.h"

#include <Eigen/Dense>
#include <cmath>

namespace sandlot::controllers::visual_odometry {
namespace {

namespace vo = navigation::vo;

/// Covariance of a motion, given in the axes of its end, in the axes before it.
vo::Covariance in_axes(const vo::Covariance& own, const Quat& q) {
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 column = rotate(q, {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0});
    for (int row = 0; row < 3; ++row)
      turn(row, axis) = turn(row + 3, axis + 3) = column[static_cast<std::size_t>(row)];
  }
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(own.data());
  const Eigen::Matrix<double, 6, 6> turned = turn * P * turn.transpose();
  vo::Covariance out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      out[static_cast<std::size_t>(6 * i + j)] = 0.5 * (turned(i, j) + turned(j, i));
  return out;
}

/// Angle times axis.
Vec3 turn_of(Quat q) {
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3 v{q.x, q.y, q.z};
  const double sine = norm(v);
  return sine < 1e-12 ? 2 * v : 2 * math::atan2(sine, q.w) / sine * v;
}

}  // namespace

Status VisualOdometry::init(const Description& robot, Outputs& out) {
  eyes_.clear();
  const bool two = spec.eyes == Eyes::stereo;
  std::string camera = spec.camera;
  if (camera.empty()) {
    SL_ASSIGN(const Reading<msg::Image> any, robot.reading<msg::Image>(""));
    for (const Description::Entry& entry : robot.readings)
      if (entry.index == any.topic) camera = entry.device;
  }
  for (const char* const side : {"left", "right"}) {
    Eye& eye = eyes_.emplace_back();
    const std::string name = two ? camera + "/" + side : camera;
    SL_ASSIGN(eye.image, robot.reading<msg::Image>(two ? name + "/image" : name));
    SL_ASSIGN(eye.info, robot.reading<msg::CameraInfo>(two ? name + "/camera_info" : name));
    if (!two) break;
  }
  X_BS_ = robot.pose(eyes_.front().image);
  odometry_ = out.publish<msg::Odometry>("odometry");
  out_.header.frame_id = robot.robot + "/" + spec.frame;
  out_.child_frame_id = robot.robot + "/" + spec.child;
  return {};
}

/// A picture as the library takes it; of another encoding, or of too few bytes, one that it refuses.
vo::GreyImage VisualOdometry::grey(const msg::Image& image, std::vector<std::uint8_t>& converted) {
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  const std::size_t channels = image.encoding == "mono8"                              ? 1
                               : image.encoding == "rgb8" || image.encoding == "bgr8" ? 3
                                                                                      : 0;
  constexpr std::size_t most = vo::greatest_side_px;
  if (channels == 0 || width > most || height > most || image.step < channels * width ||
      image.data.size() < height * image.step)
    return {};
  const int columns = static_cast<int>(width), rows = static_cast<int>(height);
  if (channels == 1) return {image.data, columns, rows, static_cast<int>(image.step)};
  const std::size_t r = image.encoding == "rgb8" ? 0 : 2;
  converted.resize(width * height);
  for (std::size_t v = 0; v < height; ++v) {
    const std::uint8_t* const row = image.data.data() + v * image.step;
    for (std::size_t u = 0; u < width; ++u)
      converted[v * width + u] = static_cast<std::uint8_t>(
          (299U * row[3 * u + r] + 587U * row[3 * u + 1] + 114U * row[3 * u + 2 - r] + 500U) / 1000U);
  }
  return {converted, columns, rows, columns};
}

vo::Step VisualOdometry::advance_pair(const Observation& obs) {
  vo::StereoSpec used = spec.stereo;
  const auto &left = obs.get(eyes_[0].info).message.p, &right = obs.get(eyes_[1].info).message.p;
  used.camera = {left[0], left[5], left[2], left[6], right[0] > 0 ? -right[3] / right[0] : 0};
  if (!vo::validate(used)) return {};
  vo::StereoState both{std::move(state.pair), state.track};
  const vo::Step step = vo::advance(used, both, grey(obs.get(eyes_[0].image).message, eyes_[0].grey),
                                    grey(obs.get(eyes_[1].image).message, eyes_[1].grey));
  state.pair = std::move(both.keyframe);
  state.track = both.track;
  return step;
}

vo::Step VisualOdometry::advance_single(const Observation& obs) {
  vo::MonoSpec used = spec.mono;
  const auto& p = obs.get(eyes_[0].info).message.p;
  used.camera.fx_px = p[0], used.camera.fy_px = p[5], used.camera.cx_px = p[2], used.camera.cy_px = p[6];
  if (!vo::validate(used)) return {};
  vo::MonoState one{std::move(state.single), state.track};
  const vo::Step step = vo::advance(used, one, grey(obs.get(eyes_[0].image).message, eyes_[0].grey));
  state.single = std::move(one.keyframe);
  state.track = one.track;
  return step;
}

void VisualOdometry::step(const Observation& obs, Command& cmd) {
  for (const Eye& eye : eyes_) {
    if (!obs.get(eye.image).fresh || !obs.get(eye.info).valid) return;
    if (obs.get(eye.image).stamp != obs.get(eyes_.front().image).stamp) return;  // not of one moment
  }
  const Time stamp = obs.get(eyes_.front().image).stamp;
  const vo::Step step = spec.eyes == Eyes::stereo ? advance_pair(obs) : advance_single(obs);
  if (step.outcome == vo::Outcome::first_image) state.posed_at = stamp;
  state.gap = state.gap || step.gap;
  if (!vo::has_pose(step.outcome) && step.outcome != vo::Outcome::first_image) return;
  tell(step, stamp);
  state.posed_at = stamp;
  state.gap = false;
  cmd.publish(odometry_, out_);
}

/// Of the base link: it moves as the camera that sits on it.
void VisualOdometry::tell(const vo::Step& step, Time stamp) {
  const Pose X_SB = inverse(X_BS_);
  const vo::Covariance known{};
  const auto of_base = [&](const vo::Covariance& of_camera) { return vo::composed(of_camera, X_SB, known); };
  const vo::Track& track = state.track;
  const Pose X_OB = X_BS_ * vo::pose_W(track) * X_SB;
  out_.header.stamp = stamp;
  out_.pose.pose = {X_OB.p, normalised(X_OB.q)};
  out_.pose.covariance = in_axes(of_base(vo::covariance_S(track)), X_OB.q);
  const double dt_s = (stamp - state.posed_at).s();
  out_.twist = {};
  if (dt_s <= 0) return;
  const Pose moved = X_BS_ * step.motion * X_SB;
  out_.twist.twist = {moved.p / dt_s, turn_of(moved.q) / dt_s};
  out_.twist.covariance = of_base(step.motion_errors);
  for (double& each : out_.twist.covariance) each /= dt_s * dt_s;
  if (!state.gap) return;
  // The motion is that since the gap.
  for (std::size_t i = 0; i < 6; ++i) out_.twist.covariance[7 * i] += vo::unknown_variance;
}

bool VisualOdometry::fits() const {
  const auto sound = [](const vo::View& view) { return view.image.pixels.empty() || vo::sound(view); };
  bool finite = state.posed_at.ns >= 0 && state.posed_at.ns <= std::int64_t{1} << 61;
  for (const Pose& X : {state.track.X_WK, state.track.X_KS, state.track.motion})
    for (const double x : {X.p.x, X.p.y, X.p.z, X.q.w, X.q.x, X.q.y, X.q.z})
      finite = finite && std::abs(x) < 1e12;
  return finite && sound(state.pair.left) && sound(state.pair.right) && sound(state.single);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<VisualOdometry>({
    .name = "visual_odometry",
    .help = "Publishes a robot's motion from the pictures of its camera, one eye or two.",
});

}  // namespace sandlot::controllers::visual_odometry
