#include "devices/cameras/camera_sdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/math.h"
#include "base/text.h"
#include "devices/sdf_noise.h"

namespace sandlot::sdf_element {
namespace {

constexpr double sdf_fov_rad = 1.047, sdf_width = 320;

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

/// Mapping of angles by a wide-angle lens, r = c1 f fun(theta / c2): written with slope 1 at 0 as c2
/// fun(theta / c2), and what that has to be multiplied by.
struct Curve {
  enum class Function : std::uint8_t { id, sin, tan } function;
  double c2, scale;

  double radius(double theta) const {
    switch (function) {
      case Function::sin: return c2 * math::sin(theta / c2);
      case Function::tan: return c2 * math::tan(theta / c2);
      case Function::id: break;
    }
    return theta;
  }
  /// Its largest angle: beyond, the sine falls again, and the tangent leaves any image.
  double largest_theta() const {
    const double half_turn = std::numbers::pi;
    if (function == Function::sin) return std::min(half_turn, 0.5 * half_turn * c2);
    if (function == Function::tan) return std::min(half_turn, 0.47 * half_turn * c2);
    return half_turn;
  }
};

struct NamedCurve {
  const char *sdf, *ours;
  Curve curve;
};
constexpr NamedCurve named_curves[] = {{"stereographic", "stereographic", {Curve::Function::tan, 2, 1}},
                                       {"equidistant", "equidistant", {Curve::Function::id, 1, 1}},
                                       {"equisolid_angle", "equisolid", {Curve::Function::sin, 2, 1}},
                                       {"orthographic", "orthographic", {Curve::Function::sin, 1, 1}}};

Result<Curve> custom_curve(const Node& lens, Diagnostics& diagnostics) {
  double c1 = 1, c2 = 1, c3 = 0, f = 1;
  for (auto [key, value] : {std::pair{"c1", &c1}, {"c2", &c2}, {"c3", &c3}, {"f", &f}}) {
    SL_ASSIGN(const auto given, number(lens, std::string("custom_function/") + key));
    if (given) *value = *given;
  }
  if (!(c1 * f > 0) || !(c2 > 0)) return lens.error("c1 f and c2 of a lens' <custom_function> are above 0");
  if (c3 != 0)
    diagnostics.warn(lens.error("c3 of <custom_function> is not supported: the optical axis is its own image",
                                "0 is used"));
  const Node* const node = find(lens, "custom_function/fun");
  const std::string fun = text(node);
  if (node && fun != "tan" && fun != "sin" && fun != "id")
    return node->error("'" + fun.substr(0, 40) + "' is not a function of a lens", "write sin, tan or id");
  if (fun == "id") return Curve{Curve::Function::id, 1, c1 * f / c2};
  return Curve{fun == "sin" ? Curve::Function::sin : Curve::Function::tan, c2, c1 * f / c2};
}

/// The polynomial of a fisheye (kannala_brandt) through four places of the curve: those of Chebyshev in
/// theta^2, so that what it errs by between them is spread evenly.
Node polynomial_of(const Curve& curve, double up_to_rad, const Place& place) {
  constexpr int n = 4;
  double x[n], p[n];
  for (int i = 0; i < n; ++i) {
    x[i] = 0.5 * up_to_rad * up_to_rad * (1 - math::cos(std::numbers::pi * (2 * i + 1) / (2 * n)));
    const double theta = std::sqrt(x[i]);
    p[i] = (curve.radius(theta) / theta - 1) / x[i];
  }
  for (int k = 1; k < n; ++k)  // Newton's divided differences ...
    for (int i = n - 1; i >= k; --i) p[i] = (p[i] - p[i - 1]) / (x[i] - x[i - k]);
  double k[n] = {p[n - 1]};  // ... multiplied out
  for (int i = n - 2; i >= 0; --i) {
    for (int j = n - 1; j > 0; --j) k[j] = k[j - 1] - x[i] * k[j];
    k[0] = p[i] - x[i] * k[0];
  }
  Node keys = Node::map(place);
  for (int i = 0; i < n; ++i) keys.set("k" + std::to_string(i + 1), Node::scalar(number_text(k[i]), place));
  return keys;
}

/// The lens of a wide-angle camera. The image ends at <horizontal_fov> (or has the scale of the lens' own
/// function), the picture in it at <cutoff_angle>.
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
  const auto named = std::find_if(std::begin(named_curves), std::end(named_curves),
                                  [&](const NamedCurve& each) { return name == each.sdf; });
  if (named == std::end(named_curves) && name != "custom") {
    std::vector<std::string> known{"gnomonical", "custom"};
    for (const NamedCurve& each : named_curves) known.emplace_back(each.sdf);
    return type->error("'" + name.substr(0, 40) + "' is not a type of a lens", suggestion(name, known));
  }
  Curve curve{};
  if (named != std::end(named_curves)) {
    curve = named->curve;
  } else {
    SL_ASSIGN(curve, custom_curve(*lens, diagnostics));
  }
  SL_ASSIGN(const auto fov, number(camera, "horizontal_fov"));
  SL_ASSIGN(const auto width, number(camera, "image/width"));
  SL_ASSIGN(const auto cutoff, number(*lens, "cutoff_angle"));
  const double largest = std::min(cutoff.value_or(std::numbers::pi / 2), curve.largest_theta());
  const double edge = 0.5 * fov.value_or(sdf_fov_rad), half_width = 0.5 * width.value_or(sdf_width);
  if (!(largest > 0) || !(edge > 0)) return type->error("this lens sees nothing", "angles above 0");
  if (!config.find("fx")) {
    const std::string scaled = text(find(*lens, "scale_to_hfov"));
    const bool own = scaled == "false" || scaled == "0";
    if (!own && edge > curve.largest_theta())
      return type->error("no lens of this type is as wide as <horizontal_fov>",
                         "at most " + short_text(2 * curve.largest_theta()) + " rad");
    config.set("fx", scalar(half_width * (own ? curve.scale : 1 / curve.radius(edge)), *type));
  }
  config.set("horizontal_fov", scalar(2 * largest, *type));
  set(config, "lens", named != std::end(named_curves) ? named->ours : "kannala_brandt", *type);
  if (named == std::end(named_curves)) config.set("distortion", polynomial_of(curve, largest, type->place()));
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
  if (const Node* const mask = find(camera, "visibility_mask"))
    if (const std::string bits = text(mask);
        bits != "4294967295" && bits != "0xFFFFFFFF" && bits != "0xffffffff")
      diagnostics.warn(mask->error("visibility masks are not supported", "every visual is seen"));
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
