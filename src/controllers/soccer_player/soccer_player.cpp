#include "controllers/soccer_player/soccer_player.h"

#include <algorithm>

#include "base/math.h"
#include "controllers/soccer_player/game.h"
#include "controllers/soccer_player/localisation.h"
#include "controllers/soccer_player/packet.h"
#include "controllers/soccer_player/tracking.h"
#include "perception/scan_match.h"

namespace sandlot::controllers::soccer_player {
namespace {

constexpr double heard_within_s = 1.5;

/// Finds a device that may be missing when it has the name by default.
template <class Handle>
void take(std::optional<Handle>& handle, const Result<Handle>& found) {
  if (found) handle = *found;
}

Error no_device(const char* key, const std::string& name) {
  return Error{"there is no device '" + name + "' that a player can use as its " + key,
               "name one of the robot's devices, or leave the key out to play without",
               {},
               "/" + std::string(key)};
}

}  // namespace

Status SoccerPlayer::find_devices(const Description& robot, Outputs& out) {
  SL_ASSIGN(drive_, robot.actuator<msg::Twist>(spec.drive));
  take(odometry_, robot.reading<msg::Odometry>(spec.drive));
  take(image_, robot.reading<msg::Image>(spec.eye));
  take(info_, robot.reading<msg::CameraInfo>(spec.eye));
  take(objects_, robot.reading<msg::ObjectArray>(spec.eye));
  take(poses_, robot.reading<msg::ObjectPoseArray>(spec.eye));
  take(ranges_, robot.reading<msg::LaserScan>(spec.laser));
  take(segments_, robot.reading<msg::LineSegmentArray>(spec.laser));
  take(pose_, robot.reading<msg::PoseWithCovarianceStamped>(spec.laser));
  take(compass_, robot.reading<msg::Float64>(spec.compass));
  take(kicker_state_, robot.reading<msg::KickerState>(spec.kicker));
  take(handler_state_, robot.reading<msg::BallHandlerState>(spec.handler));
  take(packets_, robot.reading<msg::RadioReceptionArray>(spec.radio));
  take(referee_, robot.reading<msg::RefereeState>(spec.referee));
  take(words_, robot.reading<msg::RefereeCommand>(spec.referee));
  take(battery_, robot.reading<msg::BatteryState>(spec.battery));
  take(kicker_, robot.actuator<msg::Float64>(spec.kicker));
  take(handler_, robot.actuator<msg::Float64>(spec.handler));
  take(radio_, robot.actuator<msg::RadioPacket>(spec.radio));
  if (!handler_state_) handler_.reset();
  const Spec usual;
  const auto check = [](const char* key, const std::string& name, const std::string& by_default,
                        bool found) -> Status {
    if (!found && name != by_default) return no_device(key, name);
    return {};
  };
  SL_TRY(check("eye", spec.eye, usual.eye, image_ || objects_ || poses_));
  SL_TRY(check("laser", spec.laser, usual.laser, ranges_ || segments_ || pose_));
  SL_TRY(check("compass", spec.compass, usual.compass, compass_.has_value()));
  SL_TRY(check("kicker", spec.kicker, usual.kicker, kicker_.has_value()));
  SL_TRY(check("handler", spec.handler, usual.handler, handler_.has_value()));
  SL_TRY(check("radio", spec.radio, usual.radio, packets_ && radio_));
  SL_TRY(check("referee", spec.referee, usual.referee, referee_ || words_));
  SL_TRY(check("battery", spec.battery, usual.battery, battery_.has_value()));
  if (!image_ && !objects_ && !poses_)
    out.remark({"the player has no device '" + spec.eye + "' to see the ball with",
                "give the robot an omni_camera '" + spec.eye + "', or name another one by the key eye", ""});
  if (!referee_ && !words_)
    out.remark({"the player has no device '" + spec.referee +
                    "': it does not hear the referee, and plays on while the game is stopped",
                "give the robot '" + spec.referee + ": {kind: referee_link}'", "referee"});
  if (image_) X_BE_ = robot.pose(*image_);
  if (objects_) X_BE_ = robot.pose(*objects_);
  if (ranges_) X_BL_ = robot.pose(*ranges_);
  if (segments_) X_BL_ = robot.pose(*segments_);
  return {};
}

Status SoccerPlayer::init(const Description& robot, Outputs& out) {
  SL_TRY(find_devices(robot, out));
  std::size_t digits = robot.robot.size();
  while (digits > 0 && robot.robot[digits - 1] >= '0' && robot.robot[digits - 1] <= '9') --digits;
  team_ = spec.team.empty() ? robot.robot.substr(0, digits) : spec.team;
  number_ = spec.number;
  for (std::size_t i = digits; spec.number == 0 && i < robot.robot.size() && number_ < 100; ++i)
    number_ = 10 * number_ + (robot.robot[i] - '0');
  number_ = std::clamp(number_, 1, 99);
  field_ = soccer::dimensions_of(spec.size);
  style_ = style_of(spec.play);
  report_ = out.publish<msg::PlayerState>("state");
  state.game.positive = spec.attacks_positive_x;
  state.mates.reserve(most_mates);
  state.robots.reserve(most_obstacles);
  return {};
}

bool SoccerPlayer::fits() const {
  return state.mates.size() <= most_mates && state.robots.size() <= most_obstacles;
}

Vec3 SoccerPlayer::to_field(Vec3 at_B) const { return state.self.at + turned(at_B, sin_, cos_); }

void SoccerPlayer::sense_self(const Observation& obs) {
  Self& self = state.self;
  if (!state.begun && spec.placed) {
    self.at = {spec.start[0], spec.start[1], 0};
    self.yaw_rad = math::wrap_angle(spec.start[2]);
    self.var_xx = self.var_yy = 0.01;
    self.var_yaw = 0.001;
    self.known = self.yaw_known = true;
  }
  if (odometry_)
    if (const auto seen = obs.get(*odometry_); seen.valid && seen.fresh) {
      const msg::Odometry& m = seen.message;
      move_by_odometry(self, m.pose.pose.p, yaw_of(m.pose.pose.q), m.twist.twist.linear,
                       m.twist.twist.angular.z);
    }
  if (compass_)
    if (const auto seen = obs.get(*compass_); seen.valid && seen.fresh && std::isfinite(seen.message.data))
      fix_heading(self, seen.message.data, 0.05);
  if (pose_)
    if (const auto seen = obs.get(*pose_); seen.valid && seen.fresh && is_finite(seen.message.pose.pose)) {
      const auto& m = seen.message.pose;
      fix_heading(self, yaw_of(m.pose.q), std::sqrt(std::max(1e-6, m.covariance[35])));
      fix_place(self, {m.pose.p, std::max(1e-4, m.covariance[0]), m.covariance[1],
                       std::max(1e-4, m.covariance[7])});
    }
  const auto [s, c] = math::sincos(self.yaw_rad);
  sin_ = s, cos_ = c;
}

void SoccerPlayer::see_other(Vec3 at_F, double std_m) {
  if (std::abs(at_F.x) > 0.5 * field_.length_m + 0.8 || std::abs(at_F.y) > 0.5 * field_.width_m + 0.8) return;
  const Vec3 off_self = at_F - state.self.at;
  if (dot(off_self, off_self) < 0.04) return;
  const double near_m = std::min(1.2, 0.5 + 2 * std_m);
  for (const Mate& mate : state.mates) {
    const Vec3 off = at_F - (mate.at + std::min(0.3, now_s_ - mate.heard_s) * mate.velocity);
    if (now_s_ - mate.heard_s < heard_within_s && dot(off, off) < near_m * near_m) return;
  }
  see_robot(state.robots, at_F, std_m, now_s_);
}

void SoccerPlayer::see(std::string_view label, Vec3 at_B, double range_m) {
  if (!is_finite(at_B)) return;
  if (label.substr(0, 4) == "goal") {
    if (const auto fix = place_from_goal(state.self, field_, at_B)) fix_place(state.self, *fix);
  } else if (state.self.known && label == "ball") {
    see_ball(state.ball, to_field(at_B), 0.02 + 0.04 * range_m, now_s_);
  } else if (state.self.known && label == "robot") {
    see_other(to_field(at_B), 0.04 + 0.04 * range_m);
  }
}

void SoccerPlayer::see_objects(const Observation& obs) {
  if (objects_)
    if (const auto seen = obs.get(*objects_); seen.valid && seen.fresh)
      // Goals first: what else is seen stands where the robot is.
      for (const bool goals : {true, false})
        for (const msg::Object& each : seen.message.objects) {
          if ((std::string_view(each.label).substr(0, 4) == "goal") != goals) continue;
          see(each.label, X_BE_ * Vec3{each.position.x, each.position.y, each.position.z}, each.range);
        }
  if (poses_)
    if (const auto seen = obs.get(*poses_); seen.valid && seen.fresh)
      for (const msg::ObjectPose& each : seen.message.objects) {
        if (!is_finite(each.pose)) continue;
        if (each.label == "ball")
          see_ball(state.ball, each.pose.p, std::max(0.02, each.position_std), now_s_);
        else if (each.label == "robot") see_other(flat(each.pose.p), std::max(0.03, each.position_std));
      }
}

void SoccerPlayer::see_picture(const Observation& obs) {
  if (!image_ || !info_) return;
  const auto picture = obs.get(*image_);
  const auto info = obs.get(*info_);
  if (!picture.valid || !picture.fresh || !info.valid) return;
  const msg::CameraInfo& now = info.message;
  if (finder_.width() == 0 || now.k != known_.k || now.d != known_.d || now.width != known_.width ||
      now.height != known_.height || now.distortion_model != known_.distortion_model) {
    const auto camera = perception::CameraModel::of(now);
    if (!camera) return;
    finder_ = perception::Finder(spec.vision, *camera, X_BE_);
    known_ = now;
  }
  const auto view = perception::image_view(picture.message);
  if (!view || !finder_.find(*view, found_)) return;
  const auto label = [&](const perception::Found& each) -> const std::string& {
    return spec.vision.targets[each.target].label;
  };
  const perception::Found* ball = nullptr;
  for (const perception::Found& each : found_) {
    if (std::string_view(label(each)).substr(0, 4) == "goal") see(label(each), each.position_B, each.range_m);
    if (label(each) == "ball" && (ball == nullptr || each.confidence > ball->confidence)) ball = &each;
  }
  // The nearest come first. What lies behind a robot in the same direction is its upper ring, taken for another one.
  for (std::size_t i = 0; i < found_.size(); ++i) {
    if (label(found_[i]) != "robot") continue;
    const bool hidden = std::any_of(
        found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(i), [&](const auto& nearer) {
          return label(nearer) == "robot" &&
                 std::abs(math::wrap_angle(nearer.bearing_rad - found_[i].bearing_rad)) < 0.06;
        });
    if (!hidden) see("robot", found_[i].position_B, found_[i].range_m);
  }
  if (ball != nullptr) see("ball", ball->position_B, ball->range_m);
}

void SoccerPlayer::scan(const Observation& obs) {
  if (!state.self.known) return;
  constexpr double near_m = 3.5, widest_m = 0.75;
  // What is narrow, near and on the field is a robot, its middle a little behind what is seen of it.
  const auto piece = [&](Vec3 from_L, Vec3 to_L) {
    const Vec3 width = to_L - from_L, middle_B = X_BL_ * (0.5 * (from_L + to_L));
    if (dot(width, width) > widest_m * widest_m) return;
    const double range = math::hypot(middle_B.x, middle_B.y);
    if (range < 0.25 || range > near_m) return;
    const Vec3 at = to_field((1 + 0.15 / range) * middle_B);
    if (std::abs(at.x) < 0.5 * field_.length_m - 0.15 && std::abs(at.y) < 0.5 * field_.width_m + 0.5)
      see_other(at, 0.06);
  };
  if (segments_)
    if (const auto seen = obs.get(*segments_); seen.valid && seen.fresh)
      for (const msg::LineSegment& each : seen.message.segments)
        piece({each.start.x, each.start.y, 0}, {each.end.x, each.end.y, 0});
  if (!ranges_) return;
  const auto seen = obs.get(*ranges_);
  if (!seen.valid || !seen.fresh) return;
  const msg::LaserScan& m = seen.message;
  if (now_s_ - state.matched_s >= 1) match_goals(m);
  const auto point = [&](std::size_t i) {
    const auto [s, c] = math::sincos(m.angle_min + static_cast<double>(i) * m.angle_increment);
    return m.ranges[i] * Vec3{c, s, 0};
  };
  std::size_t begin = 0;
  bool open = false;
  for (std::size_t i = 0; i <= m.ranges.size(); ++i) {
    const bool here = i < m.ranges.size() && m.ranges[i] > 0 && m.ranges[i] < near_m;
    if (open && (!here || std::abs(m.ranges[i] - m.ranges[i - 1]) > 0.25f)) {
      if (i - begin >= 2) piece(point(begin), point(i - 1));
      open = false;
    }
    if (here && !open) begin = i, open = true;
  }
}

/// Corrects the place by the walls of the goals, which a laser meets.
void SoccerPlayer::match_goals(const msg::LaserScan& scan) {
  state.matched_s = now_s_;
  const double x = 0.5 * field_.length_m, back = x + field_.goal_depth_m, y = 0.5 * field_.goal_width_m,
               post = 0.125;
  const perception::Wall walls[] = {{back, -y, back, y},    {x, y, back, y},       {x, -y, back, -y},
                                    {x, y, x, y + post},    {x, -y, x, -y - post}, {-back, -y, -back, y},
                                    {-x, y, -back, y},      {-x, -y, -back, -y},   {-x, y, -x, y + post},
                                    {-x, -y, -x, -y - post}};
  const Self& self = state.self;
  const auto match = perception::match_scan(scan, X_BL_, walls, {self.at.x, self.at.y, self.yaw_rad}, 0.5);
  if (!match.converged || match.points < 8 || match.rms_m > 0.1) return;
  fix_place(state.self, {{match.pose.x, match.pose.y, 0}, 0.01, 0, 0.01});
}

void SoccerPlayer::hear(const Observation& obs) {
  std::erase_if(state.mates, [&](const Mate& each) { return now_s_ - each.heard_s > 5; });
  if (!packets_) return;
  const auto heard = obs.get(*packets_);
  if (!heard.valid || !heard.fresh) return;
  for (const msg::RadioReception& each : heard.message.packets) {
    if (each.to != team_) continue;
    const auto mate = read_packet(each.data, now_s_);
    if (!mate || mate->number == number_) continue;
    const auto known = std::find_if(state.mates.begin(), state.mates.end(),
                                    [&](const Mate& other) { return other.number >= mate->number; });
    if (known != state.mates.end() && known->number == mate->number) *known = *mate;
    else if (state.mates.size() < most_mates) state.mates.insert(known, *mate);
  }
}

void SoccerPlayer::follow_game(const Observation& obs) {
  if (!spec.obeys) return;
  const Vec3 ball = state.ball.at;
  if (words_)
    if (const auto heard = obs.get(*words_); heard.valid && heard.fresh)
      hear_command(state.game, heard.message, team_, number_, ball, now_s_);
  if (referee_)
    if (const auto heard = obs.get(*referee_); heard.valid && heard.fresh)
      hear_state(state.game, heard.message, team_, ball, now_s_);
  settle(state.game, ball);
}

void SoccerPlayer::fill_scene(const Observation& obs) {
  Scene& scene = scene_;
  scene.keys = &spec;
  scene.field = field_;
  scene.style = style_;
  scene.now_s = now_s_;
  scene.number = number_;
  scene.me = flip(state.self.at);
  scene.velocity = flip(state.self.velocity);
  scene.yaw_rad = state.game.positive ? state.self.yaw_rad : math::wrap_angle(state.self.yaw_rad + math::pi);
  holds_ = false;
  if (handler_state_)
    if (const auto held = obs.get(*handler_state_); held.valid) holds_ = held.message.engaged;
  if (holds_) hold_ball(state.ball, to_field({spec.front_m, 0, 0}), state.self.velocity, now_s_);
  const Ball ball = team_ball(state.ball, state.mates, now_s_);
  scene.ball = flip(ball.at);
  scene.ball_velocity = flip(ball.velocity);
  scene.ball_known = ball.known;
  scene.holds = holds_;
  scene.has_handler = handler_.has_value();
  scene.game = state.game;
  scene.game.spot = flip(state.game.spot);
  scene.open = is_open(state.game, ball.at, now_s_);
  Memory& memory = state.memory;
  const bool piece = state.game.piece != Piece::none && !scene.open;
  if (piece && !holds_ && norm(scene.ball - scene.game.spot) < 0.3) {
    scene.ball = scene.game.spot;
    scene.ball_velocity = {};
  }
  // The side changes when the ball is clearly on it; all begin with the same one.
  if (std::abs(scene.ball.y) > 0.4) memory.side = scene.ball.y > 0 ? -1 : 1;
  else if (piece && state.game.piece == Piece::kickoff) memory.side = 1;
  scene.side = memory.side;
  scene.mates.clear();
  for (const Mate& mate : state.mates) {
    if (now_s_ - mate.heard_s > heard_within_s) continue;
    Mate& each = scene.mates.emplace_back(mate);
    each.at = flip(each.at + std::min(0.5, now_s_ - mate.heard_s) * mate.velocity);
    each.velocity = flip(each.velocity);
    each.target = flip(each.target);
  }
  scene.opponents.clear();
  for (const Obstacle& each : state.robots)
    scene.opponents.push_back({flip(each.at), flip(each.velocity), 2 * robot_radius_m});
  if (memory.taken) memory.taken = !is_free_again();
  if (holds_ && !memory.held) {
    // A ball that slipped away for less than half a second is the same one to the referee.
    if (now_s_ - memory.let_s > 0.5) {
      memory.held_at = state.ball.at;
      memory.held_s = now_s_;
    }
    memory.until_s = -1e9;
  }
  memory.held = holds_;
  if (holds_) memory.let_s = now_s_;
}

/// Whether another robot has touched the ball since this one took a set piece, as far as can be seen.
bool SoccerPlayer::is_free_again() const {
  constexpr double soon_s = 0.3, late_s = 10, touch_m = 0.5;
  if (state.game.phase != Phase::running) return true;
  const double since_s = now_s_ - state.memory.kicked_s;
  if (since_s < soon_s) return false;
  if (since_s > late_s) return true;
  const auto touches = [&](Vec3 at) { return norm(at - scene_.ball) < touch_m; };
  return std::any_of(scene_.mates.begin(), scene_.mates.end(),
                     [&](const Mate& each) { return each.holds || touches(each.at); }) ||
         std::any_of(scene_.opponents.begin(), scene_.opponents.end(),
                     [&](const Moving& each) { return touches(each.at); });
}

void SoccerPlayer::kick(const Observation& obs, Command& cmd) {
  Memory& memory = state.memory;
  if (!kicker_ || now_s_ - memory.kicked_s < 0.4 || memory.speed_mps <= 0) return;
  if (kicker_state_)
    if (const auto seen = obs.get(*kicker_state_); seen.valid && seen.message.charge < 0.3) return;
  const Vec3 off = state.ball.at - state.self.at;
  const Vec3 ball_B = turned(off, -sin_, cos_);
  if (!holds_ && (ball_B.x < 0 || ball_B.x > spec.kick_reach_m || std::abs(ball_B.y) > spec.kick_width_m))
    return;
  const Vec3 to = memory.at - state.ball.at;
  // The ball has the robot's velocity, too.
  const Vec3 wanted = memory.speed_mps * normalised(flat(to)) - flat(state.self.velocity);
  const double error = math::wrap_angle(math::atan2(wanted.y, wanted.x) - state.self.yaw_rad);
  if (std::abs(error) > memory.tolerance_rad) return;
  const double speed = std::max(0.5, norm(wanted));
  cmd.set(*kicker_, msg::Float64{ball_mass_kg * speed});
  memory.kicked_s = now_s_;
  if (memory.aim == Aim::pass) memory.passed_s = now_s_;
  memory.taken = scene_.game.piece != Piece::none && scene_.game.whose == Whose::ours;
  ++memory.kicks;
}

/// The velocity with which robots of the other team are met slowly: to push them is a foul.
Vec3 SoccerPlayer::gentle(Vec3 velocity) const {
  constexpr double touch_mps = 0.35, braking_mps2 = 1.4, margin_m = 0.1, lag_s = 0.25;
  for (const Obstacle& each : state.robots) {
    const Vec3 off = flat(each.at - state.self.at);
    const double distance = norm(off);
    if (distance < 1e-6) continue;
    const Vec3 n = (1 / distance) * off;
    const double comes = std::max(0.0, -dot(each.velocity, n)),
                 goes = std::max(0.0, dot(state.self.velocity, n));
    const double gap = std::max(0.0, distance - 2 * robot_radius_m - margin_m - lag_s * (comes + goes));
    const double most = touch_mps + std::sqrt(2 * braking_mps2 * gap), towards = dot(velocity, n);
    // Only what lies ahead: who passes beside it need not brake.
    const double aside = std::abs(velocity.x * n.y - velocity.y * n.x) * distance;
    if (towards > most && aside < 0.75 * norm(velocity)) velocity -= (towards - most) * n;
  }
  return velocity;
}

void SoccerPlayer::act(const Observation& obs, const Task& task, Command& cmd) {
  Memory& memory = state.memory;
  memory.at = flip(memory.at);
  const Intent intent = decide(scene_, task, memory);
  memory.at = flip(memory.at);
  Vec3 target = flip(intent.target);
  double yaw = state.game.positive ? intent.yaw_rad : intent.yaw_rad + math::pi;
  if (state.game.phase == Phase::preparing &&
      intent.rests) {  // near enough is in place: the referee waits until all stand
    constexpr double near_m = 0.12, leave_m = 0.35, near_rad = 0.15;
    const bool stands = norm(state.ordered_mps) < 0.05;
    if (norm(target - state.self.at) < (stands ? leave_m : near_m)) target = state.self.at;
    if (std::abs(math::wrap_angle(yaw - state.self.yaw_rad)) < near_rad) yaw = state.self.yaw_rad;
  }
  target = beside_goals(field_, state.self.at, target);
  double speed = std::min(intent.speed_mps, spec.speed_mps);
  // A ball that waits for its set piece is passed slowly.
  if (state.game.phase == Phase::preparing && norm(flat(scene_.ball - scene_.me)) < 1.8)
    speed = std::min(speed, 1.1);
  const Limits limits{speed, holds_ ? std::min(4.0, spec.turn_speed_radps) : spec.turn_speed_radps,
                      spec.acceleration_mps2};
  discs_.clear();
  const auto add = [&](Vec3 at, Vec3 velocity, double radius) {
    const Vec3 off = at - state.self.at;
    if (dot(off, off) < 9) discs_.push_back({at, velocity, radius});
  };
  if (intent.keeps_clear) {
    for (const Obstacle& each : state.robots) add(each.at, each.velocity, 2 * robot_radius_m + 0.05);
    for (const Mate& each : state.mates)
      if (now_s_ - each.heard_s < heard_within_s)
        add(each.at + std::min(0.5, now_s_ - each.heard_s) * each.velocity, each.velocity,
            2 * robot_radius_m + 0.1);
  }
  if (intent.ball_room_m > 0 && scene_.ball_known) add(flip(scene_.ball), {}, intent.ball_room_m);
  const Vec3 wanted = velocity_to(state.self.at, target, flip(intent.moves_on), limits);
  // Wheels slip when speeds change too fast.
  const Vec3 change = gentle(around(state.self.at, wanted, discs_)) - state.ordered_mps;
  const double most = 1.3 * spec.acceleration_mps2 * dt_s_, size = norm(change);
  state.ordered_mps += size > most ? (most / size) * change : change;
  msg::Twist twist = drive(state.self, state.ordered_mps, yaw, limits, spec.holonomic);
  const double turn = 10 * dt_s_;
  twist.angular.z = std::clamp(twist.angular.z, state.ordered_radps - turn, state.ordered_radps + turn);
  state.ordered_radps = twist.angular.z;
  cmd.set(drive_, twist);
  const bool may_kick = intent.kick && (scene_.open || (scene_.game.phase == Phase::running &&
                                                        scene_.game.whose == Whose::ours));
  if (may_kick) kick(obs, cmd);
  if (handler_)
    cmd.set(*handler_, msg::Float64{intent.handler && now_s_ - memory.kicked_s > 0.5 ? 1.0 : 0.0});
  tell(task, target, cmd);
  report(obs, task, intent, cmd);
}

void SoccerPlayer::tell(const Task& task, Vec3 target, Command& cmd) {
  // Each has its turn within an interval, so that packets do not meet.
  const double shifted = now_s_ + 0.013 * number_, rate = spec.radio_rate_hz;
  if (!radio_ || std::floor(shifted * rate) == std::floor(state.sent_s * rate)) return;
  state.sent_s = shifted;
  Mate self;
  self.number = number_;
  self.role = task.role;
  self.at = state.self.at;
  self.velocity = state.self.velocity;
  self.target = target;
  self.ball = state.ball.at;
  self.ball_velocity = state.ball.velocity;
  self.ball_std_m = std::sqrt(state.ball.var_p);
  self.ball_seen_s = state.ball.seen_s;
  self.ball_known = state.ball.known;
  self.holds = holds_;
  self.cost_s = state.cost_s;
  write_packet(packet_.data, self, now_s_);
  packet_.to = team_;
  cmd.set(*radio_, packet_);
}

void SoccerPlayer::report(const Observation& obs, const Task& task, const Intent& intent, Command& cmd) {
  if (!report_ ||
      std::floor(now_s_ * spec.report_rate_hz) == std::floor(state.reported_s * spec.report_rate_hz))
    return;
  state.reported_s = now_s_;
  const Self& self = state.self;
  out_.number = number_;
  out_.role = name_of(task.role);
  out_.intention = intent.name;
  out_.pose = {self.at.x, self.at.y, self.yaw_rad};
  out_.pose_std = std::sqrt(std::max(self.var_xx, self.var_yy));
  out_.velocity = {self.velocity.x, self.velocity.y, self.rate_radps};
  const Vec3 target = flip(intent.target);
  out_.target = {target.x, target.y,
                 state.game.positive ? intent.yaw_rad : math::wrap_angle(intent.yaw_rad + math::pi)};
  const Vec3 ball = flip(scene_.ball), ball_velocity = flip(scene_.ball_velocity);
  out_.ball = {ball.x, ball.y, ball_radius_m};
  out_.ball_velocity = ball_velocity;
  out_.ball_confidence = scene_.ball_known ? 1 / (1 + std::max(0.0, now_s_ - state.ball.seen_s)) : 0;
  out_.ball_engaged = holds_;
  out_.obstacles.clear();
  for (const Obstacle& each : state.robots) out_.obstacles.push_back(each.at);
  if (battery_)
    if (const auto seen = obs.get(*battery_); seen.valid) out_.battery = seen.message.percentage;
  cmd.publish(*report_, out_);
}

void SoccerPlayer::step(const Observation& obs, Command& cmd) {
  now_s_ = obs.now().s();
  const double dt = state.begun ? std::clamp(now_s_ - state.stepped_s, 0.0, 1.0) : 0;
  dt_s_ = std::max(dt, 1e-3);
  sense_self(obs);
  state.begun = true;
  state.stepped_s = now_s_;
  predict_ball(state.ball, dt);
  predict_robots(state.robots, dt, now_s_);
  hear(obs);
  see_objects(obs);
  see_picture(obs);
  scan(obs);
  follow_game(obs);
  fill_scene(obs);
  if (!state.self.known) {  // looks about
    msg::Twist twist;
    twist.angular.z = state.game.phase == Phase::stopped ? 0 : 0.5;
    cmd.set(drive_, twist);
    return;
  }
  state.cost_s = cost_of(scene_, state.memory);
  const Task task = task_of(scene_, state.memory, state.cost_s);
  state.memory.role = task.role;
  act(obs, task, cmd);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<SoccerPlayer>({
    .name = "soccer_player",
    .help = "Plays for a team of robot soccer: keeps, attacks, passes, defends and obeys the referee.",
});

}  // namespace sandlot::controllers::soccer_player
