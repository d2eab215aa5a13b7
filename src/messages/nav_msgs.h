#pragma once
/// nav_msgs (Humble): odometry, paths, maps.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"

namespace sandlot::msg {

/// Pose in header.frame_id, twist in child_frame_id.
struct Odometry {
  static constexpr const char* ros_type = "nav_msgs/msg/Odometry";
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"child_frame_id", "", "Frame of the twist."}, s.child_frame_id);
    visit(Field{"pose", "", "Pose of the child frame."}, s.pose);
    visit(Field{"twist", "", "Velocity in the child frame."}, s.twist);
  }
};

/// Poses to go through.
struct Path {
  static constexpr const char* ros_type = "nav_msgs/msg/Path";
  Header header;
  std::vector<PoseStamped> poses;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"poses", "", "Poses in order."}, s.poses);
  }
};

/// What a map covers.
struct MapMetaData {
  static constexpr const char* ros_type = "nav_msgs/msg/MapMetaData";
  Time map_load_time;
  float resolution = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose origin;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"map_load_time", "s", "Time at which the map was loaded."}, s.map_load_time);
    visit(Field{"resolution", "m", "Side of a cell."}, s.resolution);
    visit(Field{"width", "1", "Number of cells along x."}, s.width);
    visit(Field{"height", "1", "Number of cells along y."}, s.height);
    visit(Field{"origin", "", "Pose of the corner of cell (0, 0)."}, s.origin);
  }
};

/// A map of cells, row by row from (0, 0).
struct OccupancyGrid {
  static constexpr const char* ros_type = "nav_msgs/msg/OccupancyGrid";
  Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"info", "", "Size and place of the map."}, s.info);
    visit(Field{"data", "%", "Occupancy of the cells. 0: free, 100: occupied, -1: unknown."}, s.data);
  }
};

/// Cells of one size.
struct GridCells {
  static constexpr const char* ros_type = "nav_msgs/msg/GridCells";
  Header header;
  float cell_width = 0;
  float cell_height = 0;
  std::vector<Point> cells;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"cell_width", "m", "Extent of a cell along x."}, s.cell_width);
    visit(Field{"cell_height", "m", "Extent of a cell along y."}, s.cell_height);
    visit(Field{"cells", "m", "Centres of the cells."}, s.cells);
  }
};

}  // namespace sandlot::msg
