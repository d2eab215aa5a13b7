/// Robots on wheels as .robi files.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/text.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/robi.h"
#include "geometry/bounds.h"
#include "geometry/mesh.h"

namespace sandlot::formats::eyesim {
namespace {

std::string decimal(double value, double digits = 1e6) {
  const double rounded = std::floor(value * digits + 0.5) / digits;
  return number_text(rounded == 0 ? 0 : rounded);
}
/// To a nanometre: what was typed comes back as it was.
std::string in_mm(double m) { return decimal(m * 1e3); }
std::string in_degrees(double rad) { return decimal(rad * (180 / math::pi)); }
/// A point of ours in model space, which has x right, y up, z forward.
std::string in_model_space(Vec3 p) { return in_mm(-p.y) + " " + in_mm(p.z) + " " + in_mm(p.x); }

double number_of(const model::DeviceDecl& device, const char* key, double otherwise) {
  const Node* const node = device.config.find(key);
  double value = 0;
  return node && node->is_scalar() && parse_number(node->text(), value) ? value : otherwise;
}
/// The first name that a key holds.
std::string text_of_key(const model::DeviceDecl& device, const char* key) {
  const Node* const node = device.config.find(key);
  if (!node) return "";
  return node->is_sequence() ? (node->items().empty() ? "" : node->items().front().text()) : node->text();
}

struct Wheel {
  Vec3 centre_m;
  double radius_m = 0, max_speed_radps = 0;
};

class Writer {
 public:
  Writer(const model::Instance& robot, Diagnostics& diagnostics)
      : robot_(robot), model_(*robot.model), diagnostics_(diagnostics) {}

  Result<std::string> write() {
    const model::DeviceDecl* drive = nullptr;
    for (const model::DeviceDecl& device : robot_.devices)
      if (device.kind == "diff_drive" || device.kind == "ackermann_drive" || device.kind == "mecanum_drive")
        drive = &device;
    if (!drive)
      return Error{"'" + robot_.name + "' has no drive that a .robi file knows",
                   "it has robots on two wheels, cars and robots on four Mecanum wheels"};
    SL_ASSIGN(std::string wheels, wheel_lines(*drive));
    std::string name = robot_.original_name;
    name.erase(std::remove(name.begin(), name.end(), '"'), name.end());
    out_ += "name " + (name.find_first_of(" \t#;") == std::string::npos ? name : '"' + name + '"') + "\n";
    body();
    out_ += wheels;
    devices();
    return out_;
  }

 private:
  void leave_out(const std::string& what, const Place& place) const {
    diagnostics_.warn({what + " is left out: a .robi file has no line for it", "", place});
  }

  Result<Wheel> wheel(const std::string& joint) const {
    const auto error = [&](const char* what) {
      return Error{"the wheel at joint '" + joint + "' of '" + robot_.name + "' " + what};
    };
    const auto found = std::find_if(model_.joints.begin(), model_.joints.end(),
                                    [&](const model::Joint& each) { return each.name == joint; });
    if (found == model_.joints.end()) return error("is not there");
    const model::Link& link = model_.links[found->child];
    Wheel out{link.X_ML.p, 0, found->max_velocity};
    for (const model::Collision& each : link.collisions) {
      if (const auto* const round = std::get_if<Cylinder>(&each.shape)) out.radius_m = round->radius_m;
      if (const auto* const ball = std::get_if<Sphere>(&each.shape)) out.radius_m = ball->radius_m;
    }
    if (!(out.radius_m > 0))
      for (const model::Visual& each : link.visuals)
        if (const auto* const round = std::get_if<Cylinder>(&each.shape)) out.radius_m = round->radius_m;
    return out.radius_m > 0 ? Result<Wheel>(out) : error("is neither a cylinder nor a ball");
  }

  std::string wheel_line(const char* which, const Wheel& left, const Wheel& right, double max_speed_radps) {
    return std::string("wheel ") + which + in_mm(2 * left.radius_m) + " " + in_degrees(max_speed_radps) +
           " " + decimal(ticks_) + " " + in_mm(std::abs(left.centre_m.y - right.centre_m.y)) + "\n";
  }

  /// The lines of axles and wheels; the robot's own point is at the height of the wheels that drive.
  Result<std::string> wheel_lines(const model::DeviceDecl& drive) {
    for (const model::DeviceDecl& device : robot_.devices)
      if (device.kind == "wheel_encoder") ticks_ = number_of(device, "ticks_per_turn", ticks_);
    ticks_ = std::max(1.0, std::floor(number_of(drive, "encoder_ticks", ticks_)));
    const bool mecanum = drive.kind == "mecanum_drive", car = drive.kind == "ackermann_drive";
    SL_ASSIGN(const Wheel left, wheel(text_of_key(drive, mecanum ? "front_left_joint" : "left_joint")));
    SL_ASSIGN(const Wheel right, wheel(text_of_key(drive, mecanum ? "front_right_joint" : "right_joint")));
    origin_m_ = left.centre_m.z;
    double speed_radps = number_of(drive, "max_linear_speed", 0) / left.radius_m;
    if (!(speed_radps > 0)) speed_radps = left.max_speed_radps;
    if (!(speed_radps > 0 && speed_radps < 1e6)) speed_radps = 20;
    if (!car) {
      out_ = mecanum ? "drive OMNI_DRIVE\n" : "drive DIFFERENTIAL_DRIVE\n";
      share_ = mecanum ? shares::omni : shares::differential;
      double forward = left.centre_m.x;
      if (mecanum) {
        SL_ASSIGN(const Wheel back, wheel(text_of_key(drive, "back_left_joint")));
        forward = (left.centre_m.x + back.centre_m.x) / 2;
      }
      return "axis 0 " + in_mm(forward) + "\n" + wheel_line("", left, right, speed_radps);
    }
    out_ = "drive ACKERMANN_DRIVE\n";
    share_ = shares::ackermann;
    const Node* const front = drive.config.find("passive_joint");
    if (!front || front->items().size() < 2)
      return Error{"'" + robot_.name + "' has no two wheels that turn",
                   "a .robi file has cars with one axle that drives and one that turns"};
    SL_ASSIGN(const Wheel front_left, wheel(front->items()[0].text()));
    SL_ASSIGN(const Wheel front_right, wheel(front->items()[1].text()));
    return "axel drive 0 " + in_mm(left.centre_m.x) + "\naxel turn " +
           in_mm(front_left.centre_m.z - origin_m_) + " " + in_mm(front_left.centre_m.x) + "\n" +
           wheel_line("drive ", left, right, speed_radps) +
           wheel_line("turn ", front_left, front_right,
                      front_left.max_speed_radps < 1e6 ? front_left.max_speed_radps : speed_radps);
  }

  void body() {
    double mass_kg = 0;
    for (const model::Link& link : model_.links) mass_kg += link.inertial.mass_kg;
    const model::Link& base = model_.links.front();
    const Vec3 up{0, 0, origin_m_};
    out_ += "mass " + decimal(mass_kg / share_, 1e9) + " " +
            in_model_space(base.X_ML * base.inertial.X_LCo.p - up) + "\n";
    for (const model::Collision& each : base.collisions) {
      const Pose X = base.X_ML * each.X_LC;
      const std::string centre = " " + in_model_space(X.p - up) + "\n";
      const bool upright = std::abs(X.q.x) < 1e-9 && std::abs(X.q.y) < 1e-9;
      if (const auto* const ball = std::get_if<Sphere>(&each.shape)) {
        // Balls that slide are what the reader adds.
        if (each.surface.mu != 0) out_ += "collider sphere " + in_mm(ball->radius_m) + centre;
        continue;
      }
      const auto* const capsule = std::get_if<Capsule>(&each.shape);
      if (capsule && upright) {
        out_ += "collider capsule " + in_mm(capsule->radius_m) + " " +
                in_mm(capsule->length_m + 2 * capsule->radius_m) + centre;
        continue;
      }
      if (std::holds_alternative<Plane>(each.shape)) continue;
      const Bounds bounds = bounds_of(each.shape, X);
      if (!std::holds_alternative<Box>(each.shape) || !upright || std::abs(X.q.z) > 1e-9)
        diagnostics_.warn({"the collider '" + each.name + "' of '" + robot_.name + "' becomes a box",
                           "a .robi file has boxes along its axes, balls and upright capsules", base.place});
      const Vec3 size = bounds.high - bounds.low;
      out_ += "collider box " + in_mm(size.y) + " " + in_mm(size.z) + " " + in_mm(size.x) + " " +
              in_model_space((bounds.low + bounds.high) * 0.5 - up) + "\n";
    }
    for (const model::Visual& each : base.visuals)
      if (const auto* const mesh = std::get_if<Mesh>(&each.shape)) {
        leave_out("the mesh '" + mesh->mesh->source + "' of '" + robot_.name + "'", base.place);
        break;
      }
  }

  void devices() {
    int number = 0;
    for (const model::DeviceDecl& device : robot_.devices) {
      const Pose X = model_.links[device.link].X_ML * device.X_LS;
      const Vec3 at = X.p - Vec3{0, 0, origin_m_};
      const std::string place = in_mm(at.x) + " " + in_mm(at.y) + " " + in_mm(at.z);
      const Vec3 rpy = rpy_from_quat(X.q);
      if (device.kind == "range_finder") {
        if (std::abs(rpy.x) > 1e-6 || std::abs(rpy.y) > 1e-6)
          diagnostics_.warn({"'" + device.name + "' looks level in a .robi file", "", device.place});
        out_ += "psd " + device.name + " " + std::to_string(++number) + " " + place + " " +
                in_degrees(rpy.z) + "\n";
      } else if (device.kind == "camera" && !camera_) {
        camera_ = true;
        const double width = number_of(device, "width", 320), height = number_of(device, "height", 240);
        double fov = number_of(device, "horizontal_fov", 1.0471975511965976);
        const bool fisheye = text_of_key(device, "lens") == "equidistant";
        const double wide = fisheye ? 1.0471975511965976 : std::min(fov, 3.1);
        const double high = 2 * math::atan2(math::tan(wide / 2) * height / width, 1);
        out_ += "camera " + place + " " + in_degrees(rpy.z) + " " + in_degrees(-rpy.y) + " " +
                in_degrees(wide) + " " + in_degrees(high) + "\n";
        if (fisheye) out_ += "fisheye " + in_degrees(fov) + "\n";
      } else if (device.kind == "laser_scanner" && !lidar_) {
        lidar_ = true;
        const double beams = number_of(device, "beams", 360);
        double range = number_of(device, "max_angle", math::pi) - number_of(device, "min_angle", -math::pi);
        // A whole turn lacks the step from its last beam to its first.
        if (range * beams / std::max(1.0, beams - 1) > 6.28) range = 2 * math::pi;
        out_ += "lidar " + in_degrees(range) + " " + decimal(beams) + "\n";
      } else if (device.kind != "wheel_encoder" && device.kind.find("_drive") == std::string::npos) {
        leave_out("device '" + device.name + "' of '" + robot_.name + "'", device.place);
      }
    }
  }

  const model::Instance& robot_;
  const model::Model& model_;
  Diagnostics& diagnostics_;
  std::string out_;
  double ticks_ = 1024, origin_m_ = 0, share_ = 1;
  bool camera_ = false, lidar_ = false;
};

}  // namespace

Result<std::string> robi_of(const model::Instance& instance, Diagnostics& diagnostics) {
  return Writer(instance, diagnostics).write();
}

}  // namespace sandlot::formats::eyesim
