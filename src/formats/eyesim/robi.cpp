#include "formats/eyesim/robi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "base/math.h"
#include "base/text.h"
#include "builders/wheeled.h"
#include "files/text.h"
#include "formats/eyesim/errors.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/shapes.h"

namespace sandlot::formats::eyesim {
namespace {

enum class Drive : std::uint8_t { differential, ackermann, omni };

/// Wheels of an axle: of all, or of the one that drives or turns.
struct Axle {
  std::optional<Line> wheel;
  double diameter_m = 0.08, max_speed_radps = 20, ticks = 1024, track_m = 0.2;
  double up_m = 0, forward_m = 0;
};
struct Psd {
  std::string name;
  int number = 0;
  Pose X_RS;
  double range_m = 9.999;
  Place place;
};
struct Camera {
  Pose X_RS;
  double fov_rad = 1.0471975511965976, aspect = 4.0 / 3;
  std::optional<double> fisheye_rad;
  Place place;
};
struct Bumper {
  std::string name;
  Place place;
};
struct Lidar {
  double range_rad = 2 * math::pi;
  int points = 360;
  Place place;
};
struct Solid {
  Shape shape;
  Pose X_RC;
};

constexpr double psd_range_m = 9.999, infrared_range_m = 0.15;
constexpr double older_height_m = 0.03;  ///< of sensors in polar coordinates, over the robot's point

Vec3 point_at(const std::vector<double>& n, std::size_t first) {
  return {n[first] * mm, n[first + 1] * mm, n[first + 2] * mm};
}

class RobiReader {
 public:
  RobiReader(const std::string& file, const ReadOptions& options, Diagnostics& diagnostics)
      : file_(file), options_(options), diagnostics_(diagnostics) {}

  Result<Robi> read(const std::vector<Line>& lines) {
    numberless_psds_ = are_numberless(lines);
    for (const Line& line : lines) SL_TRY(take(line));
    if (lines.empty())
      return Error{"the file describes no robot", "begin with: drive DIFFERENTIAL_DRIVE", place_in(file_)};
    if (!drive_line_)
      diagnostics_.warn(lines.front().error("the robot has no drive; it gets that of two wheels",
                                            "begin with: drive DIFFERENTIAL_DRIVE"));
    return build(lines.front().place);
  }

 private:
  Status take(const Line& line) {
    const std::string word = lower(line.keyword());
    if (word == "drive") return drive(line);
    if (word == "name") {
      if (line.arguments() < 1 || line.words[1].empty()) return line.error("the robot's name is empty");
      name_ = line.words[1];
      return {};
    }
    if (word == "mass") return mass(line);
    if (word == "collider") return collider(line);
    if (word == "model") return model(line);
    if (word == "axis") return axle(line, 1, axles_[0]);
    if (word == "axel" || word == "axle") {
      SL_ASSIGN(Axle* const which, axle_named(line));
      return axle(line, 2, *which);
    }
    if (word == "wheel") return wheel(line);
    if (word == "psd" || word == "ir") return psd(line, word == "ir" ? infrared_range_m : psd_range_m);
    if (word == "bump") return bump(line);
    if (word == "speed" || word == "maxspeed" || word == "turn") return top_speed(line, word == "turn");
    if (word == "error") return errors_.take(line);
    if (word == "camera") return camera(line);
    if (word == "fisheye") {
      SL_ASSIGN(const double angle, number_at(line, 1, "an opening angle in degrees"));
      if (!(angle > 0 && angle <= 200)) return line.error("a fisheye lens sees up to 200 degrees");
      fisheye_rad_ = radians(angle);
      return {};
    }
    if (word == "lidar") return lidar(line);
    if (word == "diameter") {
      SL_ASSIGN(const double diameter, number_at(line, 1, "a diameter in mm"));
      if (!(diameter > 0)) return line.error("a robot without a diameter has no body");
      body_radius_m_ = diameter * mm / 2;
      return {};
    }
    warn_unknown(line, diagnostics_);
    return {};
  }

  Status drive(const Line& line) {
    const std::string kind = line.arguments() < 1 ? "" : lower(line.words[1]);
    if (starts_with(kind, "differential")) drive_ = Drive::differential;
    else if (starts_with(kind, "ackermann")) drive_ = Drive::ackermann;
    else if (starts_with(kind, "omni")) drive_ = Drive::omni;
    else
      return line.error("'" + kind.substr(0, 40) + "' is not a drive",
                        "known are DIFFERENTIAL_DRIVE, ACKERMANN_DRIVE and OMNI_DRIVE");
    drive_line_ = true;
    return {};
  }

  Status mass(const Line& line) {
    SL_ASSIGN(mass_kg_, number_at(line, 1, "a mass in kg"));
    if (!(mass_kg_ > 0)) return line.error("the mass of a robot is above 0");
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 2));
    if (n.size() >= 3) centre_ = from_model_space(point_at(n, 0));
    return {};
  }

  Status collider(const Line& line) {
    const std::string kind = line.arguments() < 1 ? "" : lower(line.words[1]);
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 2));
    const std::size_t sizes = kind == "box" ? 3 : kind == "capsule" ? 2 : 1;
    if (kind != "box" && kind != "capsule" && kind != "sphere")
      return line.error("'" + kind.substr(0, 40) + "' is not a collider",
                        "known are box, sphere and capsule");
    if (n.size() < sizes + 3)
      return line.error("a collider " + kind + " has its size and its centre", "all in mm");
    for (std::size_t i = 0; i < sizes; ++i)
      if (!(n[i] > 0)) return line.error("the size of a collider is above 0");
    const Pose X_RC{from_model_space(point_at(n, sizes)), {}};
    if (kind == "box") solids_.push_back({Box{{n[2] * mm, n[0] * mm, n[1] * mm}}, X_RC});
    else if (kind == "sphere") solids_.push_back({Sphere{n[0] * mm}, X_RC});
    // The height of Unity's capsules counts the half balls at both ends.
    else if (n[1] > 2 * n[0]) solids_.push_back({Capsule{n[0] * mm, (n[1] - 2 * n[0]) * mm}, X_RC});
    else solids_.push_back({Sphere{n[0] * mm}, X_RC});
    return {};
  }

  Status model(const Line& line) {
    if (line.arguments() < 1) return line.error("'model' names no file");
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 2));
    Pose X_RV;
    if (n.size() >= 3) X_RV.p = from_model_space(point_at(n, 0));
    if (n.size() >= 6) X_RV.q = turned_in_model_space({n[3], n[4], n[5]});
    X_RV.q = X_RV.q * from_mesh_space;
    // A robot has a body without it, too.
    SL_ASSIGN(mesh_, mesh_of(line, line.words[1], {1, 1, 1}, file_, options_, diagnostics_, true));
    if (!mesh_) return {};
    X_RMesh_ = X_RV;
    return {};
  }

  Result<Axle*> axle_named(const Line& line) {
    const std::string which = line.arguments() < 1 ? "" : lower(line.words[1]);
    if (which == "drive") return &axles_[0];
    if (which == "turn") return &axles_[1];
    return line.error("an axle of a car is 'drive' or 'turn', not '" + which.substr(0, 40) + "'");
  }

  Status axle(const Line& line, std::size_t first, Axle& out) {
    if (line.words.size() == first + 1) {  // the older form: the offset alone
      SL_ASSIGN(const double offset, number_at(line, first, "an offset in mm"));
      out.forward_m = offset * mm;
      return {};
    }
    SL_ASSIGN(const double up, number_at(line, first, "a height in mm"));
    SL_ASSIGN(const double forward, number_at(line, first + 1, "an offset in mm"));
    out.up_m = up * mm;
    out.forward_m = forward * mm;
    return {};
  }

  Status wheel(const Line& line) {
    std::size_t first = 1;
    Axle* axle = &axles_[0];
    if (line.arguments() >= 1 && !is_number(line.words[1])) {
      SL_ASSIGN(axle, axle_named(line));
      first = 2;
    }
    SL_ASSIGN(const double diameter, number_at(line, first, "a diameter in mm"));
    SL_ASSIGN(const double speed, number_at(line, first + 1, "a largest speed in degrees per second"));
    SL_ASSIGN(const double ticks, number_at(line, first + 2, "encoder ticks per turn"));
    SL_ASSIGN(const double track, number_at(line, first + 3, "a distance of the wheels in mm"));
    if (!(diameter > 0 && speed > 0 && track > 0) || !(ticks >= 1 && ticks <= 1e8))
      return line.error("the numbers of wheels are above 0");
    axle->diameter_m = diameter * mm;
    axle->max_speed_radps = radians(speed);
    axle->ticks = std::floor(ticks);
    axle->track_m = track * mm;
    axle->wheel = line;
    return {};
  }

  /// EyeSim 6 has psds without numbers: psd NAME x y z angle. They have as many words as polar ones, psd NAME number angle distance
  /// offset, but coordinates are no numbers of sensors: they repeat, or are larger than 16.
  static bool are_numberless(const std::vector<Line>& lines) {
    std::set<double> numbers;
    bool any = false;
    for (const Line& line : lines) {
      if (lower(line.keyword()) != "psd" || line.words.size() != 6 || is_number(line.words[1])) continue;
      double number = 0;
      if (!parse_number(line.words[2], number)) return false;
      constexpr double most_psds = 16;
      any = any || number > most_psds || std::floor(number) != number || !numbers.insert(number).second;
    }
    return any;
  }

  /// Name and number in either order: psd PSD_FRONT 1 x y z angle, psd 1 PSD_FRONT x y z [tilt] angle [roll]; with three numbers
  /// the older form, in polar coordinates: psd PSD_LEFT 2 angle distance offset.
  Status psd(const Line& line, double range_m) {
    if (line.arguments() < 5)
      return line.error("a " + lower(line.keyword()) + " has a name, a number, x y z in mm and an angle");
    const bool number_first = is_number(line.words[1]);
    const bool numberless = numberless_psds_ && !number_first && line.words.size() == 6;
    auto number = static_cast<double>(psds_.size() + 1);
    if (!numberless) { SL_ASSIGN(number, number_at(line, number_first ? 1 : 2, "the number of a psd")); }
    if (std::floor(number) != number || !(std::abs(number) < 1e6))
      return line.error("the number of a psd is a whole number");
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, numberless ? 2 : 3));
    Psd out{sanitised(line.words[number_first ? 2 : 1]), static_cast<int>(number), {}, range_m, line.place};
    if (n.size() == 3) {
      const double angle = radians(n[0]);
      out.X_RS = {{n[1] * mm * math::cos(angle), n[1] * mm * math::sin(angle), older_height_m},
                  quat_from_axis_angle({0, 0, 1}, radians(n[0] + n[2]))};
    } else {
      out.X_RS = {point_at(n, 0), quat_from_axis_angle({0, 0, 1}, radians(n.size() >= 6 ? n[4] : n[3]))};
    }
    for (const Psd& other : psds_)
      if (other.name == out.name || other.number == out.number)
        return line.error(
            "two psds have the name '" + out.name + "' or the number " + std::to_string(out.number),
            "the other one is at " + to_string(other.place));
    psds_.push_back(std::move(out));
    return {};
  }

  /// bump NAME number from to: a sector of the robot's edge.
  Status bump(const Line& line) {
    if (line.arguments() < 4) return line.error("a bumper has a name, a number and two angles in degrees");
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 2));
    const double sector = n[2] - n[1];
    if (sector < 360 && sector > -360 && sector != 0)
      diagnostics_.warn(line.error("bumpers feel the whole body, whatever their angles"));
    Bumper out{sanitised(line.words[1]), line.place};
    for (const Bumper& other : bumpers_)
      if (other.name == out.name)
        return line.error("two bumpers have the name '" + out.name + "'",
                          "the other one is at " + to_string(other.place));
    bumpers_.push_back(std::move(out));
    return {};
  }

  /// speed cm/s, turn deg/s: of the robot, where `wheel` says nothing.
  Status top_speed(const Line& line, bool turn) {
    SL_ASSIGN(const double speed, number_at(line, 1, turn ? "deg/s" : "cm/s"));
    if (!(speed > 0)) return line.error("the largest speed of a robot is above 0");
    (turn ? top_turn_radps_ : top_speed_mps_) = turn ? radians(speed) : speed / 100;
    return {};
  }

  /// camera x y z pan tilt [fovx fovy]; numbers above 180 in their place are pixels. SERVO1(-90,+90) in place of an angle is that of
  /// a servo in the middle of its range.
  Status camera(Line line) {
    for (std::string& word : line.words) {
      const std::size_t open = word.find('('), comma = word.find(','), close = word.find(')');
      if (!(open < comma && comma < close) || close == std::string::npos) continue;
      double from = 0, to = 0;
      const auto angle = [](std::string text, double& out) {
        if (starts_with(text, "+")) text.erase(0, 1);
        return parse_number(text, out);
      };
      if (!angle(word.substr(open + 1, comma - open - 1), from) ||
          !angle(word.substr(comma + 1, close - comma - 1), to))
        continue;
      diagnostics_.warn(
          line.error("'" + word.substr(0, open) + "' does not turn the camera, which looks into the middle"));
      word = number_text((from + to) / 2);
    }
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 1));
    if (n.size() < 5) return line.error("a camera has x y z in mm, pan and tilt in degrees");
    Camera out;
    out.X_RS = {point_at(n, 0), quat_from_axis_angle({0, 0, 1}, radians(n[3])) *
                                    quat_from_axis_angle({0, 1, 0}, -radians(n[4]))};
    out.place = line.place;
    if (n.size() >= 7 && n[5] > 0 && n[6] > 0) {
      if (n[5] < 180 && n[6] < 180) {
        out.fov_rad = radians(n[5]);
        out.aspect = math::tan(radians(n[5]) / 2) / math::tan(radians(n[6]) / 2);
      } else {
        out.aspect = n[5] / n[6];
      }
    }
    if (!(out.aspect > 0.1 && out.aspect < 10)) return line.error("the picture is ten times as wide as high");
    camera_ = out;
    return {};
  }

  Status lidar(const Line& line) {
    SL_ASSIGN(const double range, number_at(line, 1, "a range in degrees"));
    SL_ASSIGN(const double points, number_at(line, 2, "a number of points"));
    if (!(range > 0 && range <= 360)) return line.error("a lidar sees 1 to 360 degrees");
    if (std::floor(points) != points || !(points >= 2 && points <= 10000))
      return line.error("a lidar has 2 to 10000 points");
    lidar_ = Lidar{radians(range), static_cast<int>(points), line.place};
    return {};
  }

  // --- building ---

  double radius_m() const { return axles_[0].diameter_m / 2; }
  /// Height of the robot's own point above the ground.
  double origin_m() const { return std::max(0.0, radius_m() - axles_[0].up_m); }

  Result<Robi> build(const Place& place) {
    model_.name = name_;
    model_.place = place;
    const std::uint32_t base = builders::add_link(model_, "base", {});
    const Pose X_BR{{0, 0, origin_m()}, {}};
    body(base, X_BR);
    switch (drive_) {
      case Drive::differential: add_differential(base); break;
      case Drive::ackermann: add_car(base); break;
      case Drive::omni: add_omni(base); break;
    }
    if (centre_) model_.links[base].inertial.X_LCo.p = X_BR * *centre_;
    Robi out;
    for (const Psd& psd : psds_) {
      builders::add_device(model_, psd.name, "range_finder",
                           {{"radiation", "infrared"},
                            {"fov", "0"},
                            {"rings", "0"},
                            {"min_range", "0"},
                            {"max_range", number_text(psd.range_m)}},
                           base, X_BR * psd.X_RS);
      model_.devices.back().place = psd.place;
      out.psds[psd.number] = psd.name;
    }
    if (camera_) {
      const int width = 320,
                height = std::clamp(static_cast<int>(std::lround(width / camera_->aspect)), 32, 3200);
      const double fov = fisheye_rad_.value_or(camera_->fov_rad);
      builders::add_device(model_, "camera", "camera",
                           {{"lens", fisheye_rad_ ? "equidistant" : "pinhole"},
                            {"width", std::to_string(width)},
                            {"height", std::to_string(height)},
                            {"horizontal_fov", number_text(fov)},
                            {"rate", "20"}},
                           base, X_BR * camera_->X_RS);
      model_.devices.back().place = camera_->place;
    }
    if (lidar_) {
      const double half = lidar_->range_rad / 2;
      // The points of a whole turn do not meet their first.
      const double last = lidar_->range_rad > 6.28 ? half - lidar_->range_rad / lidar_->points : half;
      builders::add_device(model_, "lidar", "laser_scanner",
                           {{"beams", std::to_string(lidar_->points)},
                            {"min_angle", number_text(-half)},
                            {"max_angle", number_text(last)},
                            {"max_range", "9.999"}},
                           base, {{0, 0, top_m_ + 0.02}, {}});
      model_.devices.back().place = lidar_->place;
    }
    for (const Bumper& bumper : bumpers_) {
      builders::add_device(model_, bumper.name, "contact", {}, base);
      model_.devices.back().place = bumper.place;
    }
    for (model::DeviceDecl& device : model_.devices)
      if (const Node keys = errors_.keys_for(device.kind); !keys.is_null()) merge(device.config, keys);
    out.instance.name = out.instance.original_name = name_;
    out.instance.devices = model_.devices;
    out.instance.place = place;
    out.instance.is_robot = true;
    out.instance.model = std::make_shared<const model::Model>(std::move(model_));
    return out;
  }

  /// The colliders share the mass; a robot without any is a box or a can above its wheels.
  void body(std::uint32_t base, const Pose& X_BR) {
    const double wheels_kg = 0.1 * mass_kg_;
    if (solids_.empty()) {
      const double radius = body_radius_m_.value_or(0.47 * axles_[0].track_m);
      const double low = 0.6 * radius_m(), height = std::max(1.6 * radius_m(), 0.05);
      if (drive_ == Drive::differential) {
        builders::add_round_body(model_, base, radius, height, low, mass_kg_ - wheels_kg,
                                 builders::colors::yellow);
      } else {
        builders::add_box_body(model_, base, {2.2 * radius, 0.8 * axles_[0].track_m, height}, low,
                               mass_kg_ - wheels_kg, builders::colors::yellow);
      }
      top_m_ = low + height;
    } else {
      double whole = 0;
      for (const Solid& solid : solids_) whole += volume_m3(solid.shape);
      for (const Solid& solid : solids_) {
        const Pose X_BC = X_BR * solid.X_RC;
        builders::add_part(model_, base,
                           {.shape = solid.shape,
                            .X_LP = X_BC,
                            .mass_kg = (mass_kg_ - wheels_kg) * volume_m3(solid.shape) / whole,
                            .color = builders::colors::yellow,
                            .shown = !mesh_});
        top_m_ = std::max(top_m_, X_BC.p.z + half_height(solid.shape));
      }
    }
    if (!mesh_) return;
    model::Visual visual{"model", X_BR * X_RMesh_, Mesh{mesh_}, {}, true, {}};
    // Without colliders the body was made up, to touch with: the mesh is what is seen.
    model_.links[base].visuals.clear();
    model_.links[base].visuals.push_back(std::move(visual));
  }

  static double half_height(const Shape& shape) {
    if (const auto* const box = std::get_if<Box>(&shape)) return box->size_m.z / 2;
    return bounding_radius_m(shape);
  }

  std::uint32_t add_wheel(const char* name, std::uint32_t parent, const Axle& axle, double x, double y) {
    return builders::add_wheel(model_, {.name = name,
                                        .parent = parent,
                                        .centre_M = {x, y, axle.diameter_m / 2},
                                        .radius_m = axle.diameter_m / 2,
                                        .width_m = std::min(0.3 * axle.diameter_m / 2, 0.2 * axle.track_m),
                                        .mass_kg = 0.025 * mass_kg_,
                                        .max_speed_radps = axle.max_speed_radps});
  }

  void add_encoder(const char* device, const char* joint, const Axle& axle) {
    builders::add_device(model_, device, "wheel_encoder",
                         {{"joint", joint},
                          {"ticks_per_turn", std::to_string(static_cast<long long>(axle.ticks))},
                          {"rate", "0"}});
  }

  std::string max_speed(const Axle& axle) const {
    if (top_speed_mps_) return number_text(*top_speed_mps_);
    return number_text(axle.max_speed_radps * axle.diameter_m / 2);
  }
  std::string max_turn(const Axle& axle) const {
    if (top_turn_radps_) return number_text(*top_turn_radps_);
    return number_text(axle.max_speed_radps * axle.diameter_m / axle.track_m);
  }

  void add_differential(std::uint32_t base) {
    const Axle& axle = axles_[0];
    // Balls that slide keep it level.
    model::Surface smooth;
    smooth.mu = smooth.mu2 = 0;
    const double ball = 0.25 * radius_m();
    for (const double end : {1.0, -1.0})
      builders::add_part(model_, base,
                         {Sphere{ball},
                          {{axle.forward_m + end * 0.4 * axle.track_m, 0, ball}, {}},
                          0.02 * mass_kg_,
                          builders::colors::grey,
                          smooth});
    add_wheel("left", base, axle, axle.forward_m, axle.track_m / 2);
    add_wheel("right", base, axle, axle.forward_m, -axle.track_m / 2);
    builders::add_device(model_, "drive", "diff_drive",
                         {{"left_joint", "left_joint"},
                          {"right_joint", "right_joint"},
                          {"wheel_radius", number_text(axle.diameter_m / 2)},
                          {"wheel_separation", number_text(axle.track_m)},
                          {"max_linear_speed", max_speed(axle)},
                          {"max_angular_speed", max_turn(axle)}});
    add_encoder("left_encoder", "left_joint", axle);
    add_encoder("right_encoder", "right_joint", axle);
  }

  void add_car(std::uint32_t base) {
    Axle& back = axles_[0];
    Axle& front = axles_[1];
    if (!front.wheel) {
      front.diameter_m = back.diameter_m;
      front.track_m = back.track_m;
      front.max_speed_radps = back.max_speed_radps;
    }
    // An axle in front of the other by less than a wheel has no place for both.
    if (std::abs(front.forward_m - back.forward_m) < back.diameter_m)
      front.forward_m = back.forward_m + 1.5 * back.track_m;
    for (const double side : {1.0, -1.0}) {
      const char* const name = side > 0 ? "left" : "right";
      add_wheel(name, base, back, back.forward_m, side * back.track_m / 2);
      const std::string front_name = std::string("front_") + name;
      const Vec3 pivot{front.forward_m, side * front.track_m / 2, front.diameter_m / 2};
      const std::uint32_t fork = builders::add_steering(model_, front_name, base, pivot, 0.6,
                                                        front.diameter_m / 2, 0.01 * mass_kg_);
      add_wheel(front_name.c_str(), fork, front, front.forward_m, side * front.track_m / 2);
    }
    builders::add_device(
        model_, "drive", "ackermann_drive",
        {{"left_joint", "left_joint"},
         {"right_joint", "right_joint"},
         {"passive_joint", std::vector<std::string>{"front_left_joint", "front_right_joint"}},
         {"left_steering_joint", "front_left_steering"},
         {"right_steering_joint", "front_right_steering"},
         {"wheelbase", number_text(front.forward_m - back.forward_m)},
         {"wheel_radius", number_text(back.diameter_m / 2)},
         {"max_linear_speed", max_speed(back)},
         {"max_angular_speed", max_turn(back)}});
    add_encoder("left_encoder", "left_joint", back);
    add_encoder("right_encoder", "right_joint", back);
  }

  void add_omni(std::uint32_t base) {
    const Axle& axle = axles_[0];
    const double wheelbase = std::max(axle.track_m, 1.3 * axle.diameter_m);
    for (const auto& [corner, x, y] : builders::corners)
      add_wheel(corner, base, axle, axle.forward_m + x * wheelbase / 2, y * axle.track_m / 2);
    builders::add_device(model_, "drive", "mecanum_drive",
                         {{"front_left_joint", "front_left_joint"},
                          {"front_right_joint", "front_right_joint"},
                          {"back_left_joint", "rear_left_joint"},
                          {"back_right_joint", "rear_right_joint"},
                          {"encoder_ticks", std::to_string(static_cast<long long>(axle.ticks))},
                          {"wheel_radius", number_text(axle.diameter_m / 2)},
                          {"track", number_text(axle.track_m)},
                          {"max_linear_speed", max_speed(axle)},
                          {"max_angular_speed", max_turn(axle)}});
  }

  const std::string& file_;
  const ReadOptions& options_;
  Diagnostics& diagnostics_;
  Drive drive_ = Drive::differential;
  bool drive_line_ = false;
  std::string name_ = "robot";
  double mass_kg_ = 2;
  std::optional<Vec3> centre_;
  std::vector<Solid> solids_;
  std::shared_ptr<const TriangleMesh> mesh_;
  Pose X_RMesh_;
  std::array<Axle, 2> axles_;  ///< that drives, that turns
  std::vector<Psd> psds_;
  bool numberless_psds_ = false;
  std::vector<Bumper> bumpers_;
  std::optional<double> top_speed_mps_, top_turn_radps_;
  ErrorModels errors_;
  std::optional<Camera> camera_;
  std::optional<double> fisheye_rad_, body_radius_m_;
  std::optional<Lidar> lidar_;
  model::Model model_;
  double top_m_ = 0;
};

}  // namespace

Result<Robi> read_robi(std::string_view text, const std::string& file, const ReadOptions& options,
                       Diagnostics& diagnostics) {
  SL_ASSIGN(const std::vector<Line> lines, lines_of(text, file));
  auto robot = RobiReader(file, options, diagnostics).read(lines);
  if (!robot && !robot.error().place.file)
    robot.error().place = lines.empty() ? Place{} : lines.front().place;
  return robot;
}

}  // namespace sandlot::formats::eyesim
