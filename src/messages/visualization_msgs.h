#pragma once
/// visualization_msgs (Humble): shapes for viewers. Interactive and image markers are left out: nobody here sends or takes them.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"
#include "messages/sensor_images.h"

namespace sandlot::msg {

/// A point of a texture.
struct UVCoordinate {
  static constexpr const char* ros_type = "visualization_msgs/msg/UVCoordinate";
  float u = 0;
  float v = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"u", "1", "Coordinate from left to right."}, s.u);
    visit(Field{"v", "1", "Coordinate from top to bottom."}, s.v);
  }
};

/// A mesh as a file.
struct MeshFile {
  static constexpr const char* ros_type = "visualization_msgs/msg/MeshFile";
  std::string filename;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"filename", "", "Name of the file; its extension gives the format."}, s.filename);
    visit(Field{"data", "", "Bytes of the file."}, s.data);
  }
};

/// A shape that a viewer draws.
struct Marker {
  static constexpr const char* ros_type = "visualization_msgs/msg/Marker";
  static constexpr std::int32_t arrow = 0;
  static constexpr std::int32_t cube = 1;
  static constexpr std::int32_t sphere = 2;
  static constexpr std::int32_t cylinder = 3;
  static constexpr std::int32_t line_strip = 4;
  static constexpr std::int32_t line_list = 5;
  static constexpr std::int32_t text_view_facing = 9;
  static constexpr std::int32_t add = 0;
  static constexpr std::int32_t remove = 2;
  static constexpr std::int32_t remove_all = 3;
  Header header;
  std::string ns;
  std::int32_t id = 0;
  std::int32_t type = 0;
  std::int32_t action = 0;
  Pose pose;
  Vec3 scale;
  ColorRGBA color;
  Duration lifetime;
  bool frame_locked = false;
  std::vector<Point> points;
  std::vector<ColorRGBA> colors;
  std::string texture_resource;
  CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text;
  std::string mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;
  static void constants(auto&& visit) {
    visit("ARROW", arrow);
    visit("CUBE", cube);
    visit("SPHERE", sphere);
    visit("CYLINDER", cylinder);
    visit("LINE_STRIP", line_strip);
    visit("LINE_LIST", line_list);
    visit("CUBE_LIST", std::int32_t{6});
    visit("SPHERE_LIST", std::int32_t{7});
    visit("POINTS", std::int32_t{8});
    visit("TEXT_VIEW_FACING", text_view_facing);
    visit("MESH_RESOURCE", std::int32_t{10});
    visit("TRIANGLE_LIST", std::int32_t{11});
    visit("ADD", add);
    visit("MODIFY", std::int32_t{0});
    visit("DELETE", remove);
    visit("DELETEALL", remove_all);
  }
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"ns", "", "Namespace; with `id` the name of the marker."}, s.ns);
    visit(Field{"id", "1", "Identifier; with `ns` the name of the marker."}, s.id);
    visit(Field{"type", "1", "Shape of the marker."}, s.type);
    visit(Field{"action", "1", "Action on the marker. 0: add or change, 2: remove, 3: remove all."},
          s.action);
    visit(Field{"pose", "", "Pose in header.frame_id."}, s.pose);
    visit(Field{"scale", "m", "Size of the shape."}, s.scale);
    visit(Field{"color", "1", "Colour of the marker."}, s.color);
    visit(Field{"lifetime", "s", "Time after which the marker is removed; 0: never."}, s.lifetime);
    visit(Field{"frame_locked", "", "Whether the marker moves with its frame."}, s.frame_locked);
    visit(Field{"points", "m", "Points of lists and strips."}, s.points);
    visit(Field{"colors", "1", "Colours of the points; or none."}, s.colors);
    visit(Field{"texture_resource", "", "Name of a texture."}, s.texture_resource);
    visit(Field{"texture", "", "Bytes of the texture."}, s.texture);
    visit(Field{"uv_coordinates", "", "Texture coordinates of the points."}, s.uv_coordinates);
    visit(Field{"text", "", "Text of a marker text_view_facing."}, s.text);
    visit(Field{"mesh_resource", "", "Name of a mesh."}, s.mesh_resource);
    visit(Field{"mesh_file", "", "Bytes of the mesh."}, s.mesh_file);
    visit(Field{"mesh_use_embedded_materials", "", "Whether the mesh brings its own colours."},
          s.mesh_use_embedded_materials);
  }
};

/// Several markers.
struct MarkerArray {
  static constexpr const char* ros_type = "visualization_msgs/msg/MarkerArray";
  std::vector<Marker> markers;
  static void fields(auto& s, auto&& visit) { visit(Field{"markers", "", "Markers to show."}, s.markers); }
};

}  // namespace sandlot::msg
