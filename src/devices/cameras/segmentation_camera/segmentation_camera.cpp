#include "devices/cameras/segmentation_camera/segmentation_camera.h"

#include <cmath>
#include <cstring>

#include "base/text.h"
#include "devices/cameras/camera_sdf.h"
#include "devices/cameras/instances.h"

namespace sandlot::segmentation_camera {
namespace {

/// Colours far apart for neighbouring numbers, never black: hues in steps of the golden ratio.
std::array<std::uint8_t, 3> color_of(std::uint32_t number) {
  if (number == 0) return {0, 0, 0};
  const std::uint32_t hue = number * 0x9E3779B9U;  // 2^32 / golden ratio
  const std::uint32_t part = hue / 0x2AAAAAABU;    // sixth of the circle
  const auto rise = static_cast<std::uint8_t>((static_cast<std::uint64_t>(hue % 0x2AAAAAABU) * 255) /
                                              0x2AAAAAABU);
  const auto fall = static_cast<std::uint8_t>(255 - rise);
  switch (part) {
    case 0: return {255, rise, 40};
    case 1: return {fall, 255, 40};
    case 2: return {40, 255, rise};
    case 3: return {40, fall, 255};
    case 4: return {rise, 40, 255};
    default: return {255, 40, fall};
  }
}

std::uint8_t number_of(const std::string& label, const std::vector<std::string>& labels) {
  if (labels.empty()) {
    double number = 0;
    const bool whole = parse_number(label, number) && number == std::floor(number);
    return whole && number >= 1 && number <= 255 ? static_cast<std::uint8_t>(number) : std::uint8_t{0};
  }
  const auto at = std::find(labels.begin(), labels.end(), label);
  return at == labels.end() ? std::uint8_t{0} : static_cast<std::uint8_t>(at - labels.begin() + 1);
}

void show(Camera& camera, const Context& context) {
  std::uint32_t last = 0;  // neighbours are mostly of one thing
  std::uint8_t label = 0;
  std::array<std::uint8_t, 3> color{};
  // Sizes as they were declared, whatever a snapshot held.
  camera.labels->message.data.resize(camera.seen.size());
  camera.instances->message.data.resize(4 * camera.seen.size());
  camera.colored->message.data.resize(3 * camera.seen.size());
  for (std::size_t i = 0; i < camera.seen.size(); ++i) {
    const std::uint32_t instance = camera.seen[i];
    if (instance != last) {
      last = instance;
      label = 0;
      const LabelledObject* const target = cameras::labelled_object(context.labelled_objects, instance);
      if (target) label = number_of(target->label, camera.spec.labels);
      color = color_of(label == 0 || camera.spec.color_by == ColorBy::label ? label : instance);
    }
    const std::uint32_t shown = label == 0 ? 0 : instance;
    camera.labels->message.data[i] = label;
    std::memcpy(camera.instances->message.data.data() + 4 * i, &shown, 4);
    std::memcpy(camera.colored->message.data.data() + 3 * i, color.data(), 3);
  }
  for (Topic<msg::Image>* topic : {camera.labels, camera.instances, camera.colored})
    topic->publish(context.now);
  camera.info->publish(context.now);
}

}  // namespace

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(cameras::check_exposure({spec.near_m, spec.far_m}, build));
  SL_ASSIGN(const optics::Lens lens, cameras::lens_of(spec, build));
  const std::string optical = build.frame("optical", cameras::X_S_optical);
  auto* const labels = build.publish<msg::Image>(0, "labels");
  auto* const instances = build.publish<msg::Image>(0, "instances");
  auto* const colored = build.publish<msg::Image>(0, "colored");
  auto* const info = build.publish<msg::CameraInfo>(0, "camera_info");
  cameras::shape_image(labels->message, lens, "mono8", 1, optical);
  cameras::shape_image(instances->message, lens, "32SC1", 4, optical);
  cameras::shape_image(colored->message, lens, "rgb8", 3, optical);
  cameras::fill_info(info->message, lens, optical);
  Camera camera{std::move(spec), {}, cameras::CameraMount(build, lens), labels, instances, colored, info};
  camera.seen.resize(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height));
  return camera;
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  cameras::draw_instances(pool, context);
  for (const std::uint32_t index : pool.due) show(pool.all[index], context);
}

namespace {
constexpr LevelInfo levels[] = {{"labels", msg::Image::ros_type, "", "Class and instance of every pixel."}};
constexpr const char* sdf_types[] = {"sensor:segmentation", "sensor:segmentation_camera"};

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  SL_ASSIGN(Node config, sdf_element::camera_keys(element, diagnostics, {}));
  const Node* const type = sdf_element::find(element, "camera/segmentation_type");
  const std::string name = sdf_element::text(type);
  if (type && (name == "panoptic" || name == "instance"))
    config.set("color_by", Node::scalar("instance", type->place()));
  return config;
}
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "segmentation_camera",
    .help = "Camera of the class and instance of every pixel.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = cameras::camera_sdf_note,
    .needs_render_scene = true,
});

}  // namespace sandlot::segmentation_camera
