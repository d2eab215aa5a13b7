#pragma once
/// Axis-aligned boxes around things, for checks and listings.
/// Cost     a dozen operations per shape; of a mesh one per vertex.
#include "geometry/pose.h"
#include "geometry/shape.h"

namespace sandlot {

struct Bounds {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};  ///< [m]; nothing in it yet: low above high

  bool empty() const { return !(low.x <= high.x); }
  Vec3 centre() const { return 0.5 * (low + high); }
  Vec3 size() const { return empty() ? Vec3{} : high - low; }
  void include(Vec3 point);
  void include(const Bounds& other);
  /// Distance from a point to the box, 0 inside. @pre not empty
  double distance_m(Vec3 point) const;
};

/// The least box in frame A around a shape whose frame G stands at `X_AG`; empty for planes, which have no
/// bounds. Of a height field: around the box it fills in G, from its lowest to its highest sample.
Bounds bounds_of(const Shape& shape, const Pose& X_AG = {});

}  // namespace sandlot
