#include "controllers/seeker/seeker.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::seeker {
namespace {

constexpr double turn_first_rad = math::pi / 4;

}  // namespace

Status Seeker::init(const Description& robot) {
  period_s_ = robot.control_period_s;
  SL_ASSIGN(drive_, robot.actuator<msg::Twist>(spec.drive));
  const auto objects = robot.reading<msg::ObjectArray>(spec.camera);
  auto image = robot.reading<msg::Image>(spec.camera);
  if (!objects && !image) return image.error();
  if (objects) {
    objects_ = *objects;
    X_BS_ = robot.pose(*objects);
  }
  if (image) {
    image_ = *image;
    X_BS_ = robot.pose(*image);
    SL_ASSIGN(info_, robot.reading<msg::CameraInfo>(spec.camera));
    const auto& targets = spec.vision.targets;
    if (std::none_of(targets.begin(), targets.end(), [&](const auto& t) { return t.label == spec.label; }))
      return Error{"no target of vision is called '" + spec.label + "'",
                   "add its colour to vision/targets",
                   {},
                   "/label"};
  }
  return {};
}

void Seeker::see(Vec3 position_B) {
  state.x_m = position_B.x;
  state.y_m = position_B.y;
  state.unseen_s = 0;
}

void Seeker::look_at_picture(const msg::Image& image, const msg::CameraInfo& info) {
  if (finder_.width() == 0 || info.k != known_.k || info.d != known_.d || info.width != known_.width ||
      info.height != known_.height || info.distortion_model != known_.distortion_model) {
    const auto camera = perception::CameraModel::of(info);
    if (!camera) return;
    finder_ = perception::Finder(spec.vision, *camera, X_BS_);
    known_ = info;
  }
  const auto view = perception::image_view(image);
  if (!view || !finder_.find(*view, found_)) return;
  const perception::Found* best = nullptr;
  for (const perception::Found& found : found_)
    if (spec.vision.targets[found.target].label == spec.label &&
        (!best || found.confidence > best->confidence))
      best = &found;
  if (!best) return;
  ++state.in_pictures;
  see(best->position_B);
}

void Seeker::look(const Observation& obs) {
  if (objects_) {
    const auto seen = obs.get(*objects_);
    const msg::Object* best = nullptr;
    for (const msg::Object& object : seen.message.objects)
      if (object.label == spec.label && (!best || object.confidence > best->confidence)) best = &object;
    if (seen.valid && seen.fresh && best) {
      ++state.in_objects;
      return see(X_BS_ * Vec3{best->position.x, best->position.y, best->position.z});
    }
  }
  if (image_) {
    const auto picture = obs.get(*image_);
    const auto info = obs.get(*info_);
    if (picture.valid && picture.fresh && info.valid) look_at_picture(picture.message, info.message);
  }
}

void Seeker::step(const Observation& obs, Command& cmd) {
  // What the orders since the previous step did: a turn, then a way.
  const auto [s, c] = math::sincos(state.omega_radps * period_s_);
  const double x = state.x_m - state.v_mps * period_s_;
  state.x_m = c * x + s * state.y_m;
  state.y_m = c * state.y_m - s * x;
  state.unseen_s = std::min(1e9, state.unseen_s + period_s_);
  look(obs);

  msg::Twist twist;
  state.arrived = false;
  if (state.unseen_s > spec.patience_s) {
    twist.angular.z = state.side * spec.turn_speed_radps;
  } else {
    const double distance = math::hypot(state.x_m, state.y_m), bearing = math::atan2(state.y_m, state.x_m);
    if (state.y_m != 0) state.side = state.y_m > 0 ? 1 : -1;
    const double left_m = distance - spec.stop_m;
    state.arrived = left_m < 0.02 && std::abs(bearing) < 0.1;
    if (!state.arrived)
      twist.angular.z = std::clamp(2 * bearing, -spec.turn_speed_radps, spec.turn_speed_radps);
    if (left_m > 0 && std::abs(bearing) < turn_first_rad)
      twist.linear.x = std::min(spec.speed_mps, std::sqrt(2 * spec.deceleration_mps2 * left_m)) *
                       math::cos(bearing);
  }
  state.v_mps = twist.linear.x;
  state.omega_radps = twist.angular.z;
  cmd.set(drive_, twist);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Seeker>({
    .name = "seeker",
    .help = "Search for an object, such as the ball, with a camera and drive to it.",
});

}  // namespace sandlot::controllers::seeker
