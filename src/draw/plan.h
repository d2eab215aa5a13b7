#pragma once
/// Plan: drawing of a world from above as plain data, and its SVG.
///
/// Frame    the world's: x to the right, y up the page; lengths in metres.
/// Output   one self-contained SVG file: no scripts, no fonts, no links. Coordinates are whole millimetres,
///          so that the same plan gives the same bytes. Solids are drawn in the order of their upper edges;
///          solids above all robots are translucent, because robots drive below them.
/// Limits   at most 8000 solids (the largest ones) and 60,000 corners of paths (coarser where there are
///          more); with more than 100 robots no scans, names or details of robots. Below 1.5 MB up to 3000
///          robots.
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.h"
#include "geometry/shape.h"
#include "model/model.h"

namespace sandlot::draw {

struct Plan {
  struct Solid {
    Shape shape;
    Pose X_WC;
    Color color;
    bool moves = false;
  };
  /// A planar scan: where the sensor was, and where its beams ended.
  struct Scan {
    Vec3 origin_m;
    std::vector<Vec3> ends_m;  ///< in the order of the beams
    std::vector<bool> hit;     ///< per beam: something was seen there
  };
  struct Robot {
    std::string name;
    Pose X_WB;
    std::vector<Solid> solids;
    std::vector<std::vector<Vec3>> path;  ///< in order of time; a new part after each jump
    double driven_m = 0;
    std::vector<Scan> scans;
  };
  std::string title, subtitle;
  Color ground{0.95f, 0.94f, 0.91f, 1};
  std::vector<Solid> solids;
  std::vector<Robot> robots;
};

std::string to_svg(const Plan& plan);

/// Text for XML: markup characters replaced, control characters left out.
std::string xml_text(std::string_view text);

}  // namespace sandlot::draw
