#pragma once
/// Viewpoint of a picture for people: a camera of a robot, one that follows a robot, from above, or from
/// anywhere.
///
/// A robot's camera gives the images that it publishes, errors and all. The others are pinhole cameras that
/// belong to no robot: they show the visuals without errors, and no run is changed by them.
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "base/time.h"
#include "draw/moment.h"
#include "geometry/pose.h"

namespace sandlot {
class RenderScene;
class Simulation;
namespace assets {
struct Picture;
}
namespace optics {
class LensTable;
}
}  // namespace sandlot

namespace sandlot::draw {

struct ViewpointOptions {
  std::string camera;  ///< "robot/device", "follow:robot" or "overhead"; "": from
  std::optional<Vec3> from, at;
  std::optional<int> width, height;     ///< 960 x 540 if left out; a robot's camera has its own
  double fov_rad = 1.0471975511965976;  ///< across the picture
  std::string plane = "rgb";            ///< depth, labels or instances; as colours
  int samples = 4;
  bool shadows = true;
};

class Viewpoint {
 public:
  /// Errors   options that do not go together, a size that cannot be, no such robot or camera (with those
  ///          there are).
  static Result<Viewpoint> make(const ViewpointOptions& options, Simulation& simulation);

  /// The picture at the end of the last tick. A robot's camera: the last one that it published; an empty
  /// picture if there is none yet.
  /// @param moment  what a view that is not a device shows instead of the end of the last tick
  /// Errors   the robot has gone, or the camera's messages are not pictures.
  Result<assets::Picture> picture(Simulation& simulation, const Moment* moment = nullptr);
  /// Pose of a viewpoint that is not a device, at the end of the last tick or at the moment.
  Result<Pose> pose(Simulation& simulation, const Moment* moment = nullptr);
  bool is_device() const { return !topic_.empty(); }
  std::uint64_t messages(const Simulation& simulation) const;

 private:
  ViewpointOptions options_;
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

}  // namespace sandlot::draw
