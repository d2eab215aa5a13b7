#include "devices/camera_sdf.h"

#include <array>
#include <cmath>

#include "base/math.h"
#include "base/text.h"
#include "devices/sdf_noise.h"

namespace sandlot::sdf_element {
namespace {

constexpr double sdf_fov_rad = 1.047;

void set(Node& config, const char* key, const char* value, const Node& from) {
  config.set(key, Node::scalar(value, from.place()));
}

/// SDF names pixels R8G8B8, L8, ... and here and there rgb8, mono8.
void copy_format(const Node& camera, Node& config, Diagnostics& diagnostics) {
  const Node* const node = find(camera, "image/format");
  if (!node) return;
  const std::string name = text(node);
  const auto starts = [&](std::string_view with) { return name.rfind(with, 0) == 0; };
  const bool mono = starts("L") || starts("mono") || starts("INT");
  const bool bgr = starts("BGR") || starts("B8G8R8") || starts("bgr");
  set(config, "format", mono ? "mono8" : bgr ? "bgr8" : "rgb8", *node);
  for (const std::string_view known :
       {"L8", "L_INT8", "mono8", "R8G8B8", "RGB_INT8", "rgb8", "B8G8R8", "BGR_INT8", "bgr8"})
    if (name == known) return;
  diagnostics.warn(node->error("the pixel format '" + name.substr(0, 40) + "' is not supported",
                               mono ? "mono8 is used" : "rgb8 is used"));
}

Status copy_noise(const Node& camera, Node& config, Diagnostics& diagnostics) {
  const Node* const noise = find(camera, "noise");
  if (!noise) return {};
  SL_ASSIGN(const auto std, number(*noise, "stddev"));
  SL_ASSIGN(const auto mean, number(*noise, "mean"));
  if (const Node* const given = find(*noise, "mean"); given && mean.value_or(0) != 0)
    diagnostics.warn(given->error("a mean of the noise of pixels is not supported", "0 is used"));
  if (std.value_or(0) <= 0)
    return std.value_or(0) < 0 ? Status(noise->error("<stddev> is negative")) : Status();
  Node stage = Node::map(noise->place()), keys = Node::map(noise->place());
  keys.set("std", scalar(*std, *find(*noise, "stddev")));
  stage.set("gaussian", std::move(keys));
  Node stages = Node::sequence(noise->place());
  stages.push(std::move(stage));
  config.set("noise", std::move(stages));
  return {};
}

Status copy_distortion(const Node& camera, Node& config) {
  const Node* const distortion = find(camera, "distortion");
  if (!distortion) return {};
  Node keys = Node::map(distortion->place());
  bool any = false;
  for (const char* key : {"k1", "k2", "k3", "p1", "p2"}) {
    SL_ASSIGN(const auto value, number(*distortion, key));
    if (!value || *value == 0) continue;
    any = true;
    copy(*distortion, key, keys, key);
  }
  if (any) config.set("distortion", std::move(keys));
  return {};
}

/// The lens of a wide-angle camera: one of gazebo's names for r(theta).
Status copy_lens(const Node& camera, Node& config, Diagnostics& diagnostics) {
  const Node* const lens = find(camera, "lens");
  if (!lens) return {};
  for (const char* key : {"fx", "fy", "cx", "cy"}) {
    SL_ASSIGN(const auto value, number(*lens, std::string("intrinsics/") + key));
    if (value) copy(*lens, std::string("intrinsics/") + key, config, key);
  }
  const Node* const type = find(*lens, "type");
  const std::string name = text(type);
  if (!type || name == "gnomonical" || name.empty()) return {};
  for (const auto& [sdf, ours] : {std::pair{"stereographic", "stereographic"},
                                  {"equidistant", "equidistant"},
                                  {"equisolid_angle", "equisolid"},
                                  {"orthographic", "orthographic"}})
    if (name == sdf) {
      set(config, "lens", ours, *type);
      const Node* const scale = find(*lens, "scale_to_hfov");
      if (const std::string value = text(scale); scale && value != "true" && value != "1")
        diagnostics.warn(scale->error("a lens that is not scaled to the field of view is not supported",
                                      "it is scaled to <horizontal_fov>"));
      return {};
    }
  diagnostics.warn(
      type->error("the lens '" + name.substr(0, 40) + "' is not supported", "a pinhole is used"));
  return {};
}

Status copy_clip(const Node& camera, Node& config, bool depth) {
  const bool own = depth && find(camera, "depth_camera/clip");
  for (const auto& [sdf, ours, preset] : {std::tuple{"near", "near", 0.1}, std::tuple{"far", "far", 100.0}}) {
    const std::string shared = std::string("clip/") + sdf, of_depth = "depth_camera/" + shared;
    const std::string& path = own && find(camera, of_depth) ? of_depth : shared;
    SL_ASSIGN(const auto value, number(camera, path));
    if (value) copy(camera, path, config, ours);
    else config.set(ours, scalar(preset, camera));
  }
  return {};
}

}  // namespace

Result<Node> camera_keys(const Node& element, Diagnostics& diagnostics, CameraUse use) {
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  const Node* const found = find(element, "camera");
  const Node empty = Node::map(element.place());
  const Node& camera = found && found->is_map() ? *found : empty;
  if (const Node* const pose = find(camera, "pose"); pose && !use.pose)
    diagnostics.warn(
        pose->error("<pose> of <camera> is not supported and has no effect", "give it to the <sensor>"));
  warn_unknown(camera,
               {"pose", "horizontal_fov", "image", "clip", "noise", "distortion", "lens", "depth_camera",
                "topic", "camera_info_topic", "optical_frame_id", "visibility_mask", "save",
                "segmentation_type", "box_type", "trigger_topic", "triggered"},
               "<camera>", diagnostics);
  if (find(camera, "horizontal_fov")) copy(camera, "horizontal_fov", config, "horizontal_fov");
  else config.set("horizontal_fov", scalar(sdf_fov_rad, camera));
  copy(camera, "image/width", config, "width");
  copy(camera, "image/height", config, "height");
  SL_TRY(copy_distortion(camera, config));
  SL_TRY(copy_lens(camera, config, diagnostics));
  SL_TRY(copy_clip(camera, config, use.depth));
  if (use.color) {
    copy_format(camera, config, diagnostics);
    SL_TRY(copy_noise(camera, config, diagnostics));
    copy(camera, "image/anti_aliasing", config, "samples");
  }
  return config;
}

Result<Node> stereo_keys(const Node& element, Diagnostics& diagnostics) {
  const Node* const cameras = element.find("camera");
  if (!cameras || !cameras->is_sequence() || cameras->items().size() != 2)
    return element.error("a multicamera needs two cameras side by side", "write two <camera> elements");
  SL_ASSIGN(Node config, camera_keys(element, diagnostics, {.color = true, .pose = true}));
  // y of the two: the left one is the first, and the sensor's own place.
  std::array<double, 2> y{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Node* const pose = find(cameras->items()[i], "pose");
    if (!pose) continue;
    const std::string value = text(pose);
    std::size_t word = 0;
    for (const std::string_view each : split(value, ' ')) {
      double number = 0;
      if (each.empty()) continue;
      if (!parse_number(each, number)) return pose->error("<pose> is not six numbers");
      if (word++ == 1) y[i] = number;
      else if (number != 0)
        diagnostics.warn(pose->error("cameras of a multicamera stand side by side", "y alone is used"));
    }
  }
  if (!(y[0] > y[1]))
    return element.error("the first camera of a multicamera is the left one",
                         "give it the larger y in its <pose>");
  if (y[0] != 0)
    diagnostics.warn(cameras->items()[0].error("the left camera stands at the sensor's own place",
                                               "move the <sensor> there"));
  config.set("baseline", scalar(y[0] - y[1], *cameras));
  return config;
}

}  // namespace sandlot::sdf_element
