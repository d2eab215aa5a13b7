#pragma once
/// Zoom lens of a camera: its keys and topics, shared by cameras and pan-tilt units.
///
/// Command  <camera>/zoom/command: std_msgs/Float64, the focal length wanted in those of the spec, cut to 1
///          ... `max`.
/// Output   <camera>/zoom: std_msgs/Float64, the focal length now, with every sample at any level.
/// Speed    the lens gets there by at most the factor `rate` per second, so all of it takes log(max) /
///          log(rate) seconds.
/// Picture  the tangent of half the field of view is divided by the zoom; the distortion of a pinhole and the
///          pixels stay.
#include "base/fields.h"

namespace sandlot {

struct Zoom {
  double max = 4, rate_per_s = 4;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"max", "1", "Longest focal length, as a multiple of the spec's.", 1, 1000}, s.max);
    visit(Field{"rate", "1/s", "Largest factor per second by which the focal length changes.", 1.001, 1e6},
          s.rate_per_s);
  }
};

}  // namespace sandlot
