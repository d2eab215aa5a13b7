#pragma once
/// Detector of the cameras' higher levels: labelled objects instead of pixels, with the errors of a detector.
///
/// Seen     an object (devices/labelled_object.h) of a wanted label within max_range of which a part is in
///          the picture and not hidden. Rays go to 3 x 3 places of its bounds: `visible` is the part of those
///          that hit it among those that something hides, the picture's edge too. What is seen by less than
///          min_visible is not reported, nor is the robot itself.
/// Objects  bearing, elevation and range of the middle of its bounds, in S. Errors, all scaled by `errors`:
///          missed with the probability miss_rate + miss_rate_per_m * range + miss_rate_hidden * (1 -
///          visible); angles + bearing_std n, range + (range_std + range_std_per_m * range) n; with the
///          probability confusion another wanted label. Ghosts come ghost_rate times a second, anywhere in
///          the picture. Confidence: (1 - probability of a miss) * visible; of ghosts anything up to 1/2.
/// World    poses of bodies in W, of the same objects at the same time: x and y + (position_std +
///          position_std_per_m * range) n, heading + heading_std n. `everything: true`: of all wanted
///          objects, wherever they are, none missed.
/// Random   one stream per sample and object, keyed by its name: errors of one object do not depend on the
///          others.
/// Limits   rays meet collision shapes, not visuals. What has none, or is open in the middle like a goal, is
///          seen if nothing stands before its middle. On the engine planar, objects are upright prisms to
///          rays.
/// Cost     nine rays per object in range and picture; no pictures are drawn.
#include <array>
#include <string>
#include <vector>

#include "devices/cameras/camera_picture.h"

namespace sandlot::cameras {

struct ObjectKeys {
  std::vector<std::string> labels;
  bool names = false;
  double max_range_m = 20, min_visible = 0.15;
  double miss_rate = 0, miss_rate_per_m = 0, miss_rate_hidden = 0, ghost_rate_hz = 0, confusion = 0;
  double bearing_std_rad = 0, range_std_m = 0, range_std_per_m = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"labels", "", "Labels of the objects to detect; none: all that have a label.", 0, 0,
                Field::none, 100},
          s.labels);
    visit(Field{"names", "", "Whether names of objects are reported, too.", 0, 1, tunable}, s.names);
    visit(Field{"max_range", "m", "Farthest distance at which objects are detected.", 1e-3, 1e4, tunable},
          s.max_range_m);
    visit(Field{"min_visible", "1", "Smallest visible part of an object that is detected.", 0, 1, tunable},
          s.min_visible);
    visit(Field{"miss_rate", "1", "Probability that an object is missed.", 0, 1, tunable}, s.miss_rate);
    visit(Field{"miss_rate_per_m", "1/m", "Increase of the probability of a miss per metre of range.", 0, 1,
                tunable},
          s.miss_rate_per_m);
    visit(Field{"miss_rate_hidden", "1",
                "Increase of the probability of a miss for an object that is all but hidden.", 0, 1, tunable},
          s.miss_rate_hidden);
    visit(Field{"ghost_rate", "Hz", "Number of false detections per second.", 0, 1e3, tunable},
          s.ghost_rate_hz);
    visit(Field{"confusion", "1", "Probability of a wrong label.", 0, 1, tunable}, s.confusion);
    visit(Field{"bearing_std", "rad", "Standard deviation of bearing and elevation.", 0, 3, tunable},
          s.bearing_std_rad);
    visit(Field{"range_std", "m", "Standard deviation of the range.", 0, 1e3, tunable}, s.range_std_m);
    visit(Field{"range_std_per_m", "1", "Increase of the range's standard deviation per metre of range.", 0,
                10, tunable},
          s.range_std_per_m);
  }
};

struct WorldKeys {
  bool everything = false;
  double position_std_m = 0, position_std_per_m = 0, heading_std_rad = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"everything", "", "Whether hidden objects are reported, too.", 0, 1, tunable}, s.everything);
    visit(Field{"position_std", "m", "Standard deviation of x and y.", 0, 1e3, tunable}, s.position_std_m);
    visit(Field{"position_std_per_m", "1",
                "Increase of the standard deviation of x and y per metre of range.", 0, 10, tunable},
          s.position_std_per_m);
    visit(Field{"heading_std", "rad", "Standard deviation of the heading.", 0, 10, tunable},
          s.heading_std_rad);
  }
};

/// Fills those of the two messages that are wanted (not null); publishing is the caller's.
/// @param since_s  time since the previous sample, for ghosts
void detect(const ObjectKeys& keys, const WorldKeys& world, double errors, const CameraMount& mount,
            std::uint64_t sample, double since_s, const Context& context, msg::ObjectArray* objects,
            msg::ObjectPoseArray* poses);

}  // namespace sandlot::cameras
