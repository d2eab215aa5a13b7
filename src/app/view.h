#pragma once
/// Where pictures for people are taken from: a camera of a robot, one that follows a robot, from above, or from anywhere.
///
/// A robot's camera gives the images that it publishes, errors and all. The others are pinholes that no device is: they
/// look at the visuals as they are, and no run is changed by them.
#include <memory>
#include <optional>
#include <string>

#include "assets/image/visible.h"
#include "geometry/vec3.h"
#include "optics/picture.h"
#include "sim/world/simulation.h"

namespace sandlot::app {

struct ViewOptions {
  std::string camera;  ///< "robot/device", "follow:robot" or "overhead"; "": from
  std::optional<Vec3> from, at;
  std::optional<int> width, height;     ///< 960 x 540 if left out; a robot's camera has its own
  double fov_rad = 1.0471975511965976;  ///< of the width
  std::string plane = "rgb";            ///< depth, labels or instances; as colours
  int samples = 4;
  bool shadows = true;
};

/// "640x480"
Status read_size(const char* flag, const std::string& text, ViewOptions& out);
/// "1,2,0.5"
Status read_point(const char* flag, const std::string& text, std::optional<Vec3>& out);

class View {
 public:
  /// Errors   options that do not go together, a size that cannot be, no such robot or camera (with those there are).
  static Result<View> make(const ViewOptions& options, Simulation& simulation);

  /// The picture at the end of the last tick. A robot's camera: the last one that it published; an empty picture if there is
  /// none yet.
  /// Errors   the robot has gone, or the camera's messages are no pictures.
  Result<assets::Picture> picture(Simulation& simulation);
  /// Where a view that is no device looks from, at the end of the last tick.
  Result<Pose> pose(Simulation& simulation);
  bool is_device() const { return !topic_.empty(); }
  std::uint64_t messages(const Simulation& simulation) const;

 private:
  ViewOptions options_;
  std::string topic_;   ///< of a robot's camera
  std::string follow_;  ///< robot
  Pose X_WS_;           ///< of a view that stands still
  double distance_m_ = 0;
  std::shared_ptr<const optics::LensTable> lens_;
  // Of a view that follows: where the robot seems to be, which comes after it with a lag.
  struct Lag {
    Time at;
    Vec3 place;
    double heading_x = 1, heading_y = 0;
  };
  std::optional<Lag> lag_;
};

}  // namespace sandlot::app
