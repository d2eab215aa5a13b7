#include "devices/cameras/boundingbox_camera/boundingbox_camera.h"

#include "devices/cameras/camera_sdf.h"
#include "devices/cameras/instances.h"

namespace sandlot::boundingbox_camera {
namespace {

void find_boxes(Camera& camera, const Context& context) {
  camera.box.assign(context.labelled_objects.size(), {1 << 30, 1 << 30, -1, -1, 0});
  const optics::Lens& lens = camera.mount.lens();
  std::uint32_t last = 0;
  const LabelledObject* target = nullptr;
  std::size_t i = 0;
  for (int v = 0; v < lens.height; ++v)
    for (int u = 0; u < lens.width; ++u, ++i) {
      if (camera.seen[i] != last)
        target = cameras::labelled_object(context.labelled_objects, last = camera.seen[i]);
      if (!target) continue;
      Camera::Box& box = camera.box[static_cast<std::size_t>(target - context.labelled_objects.data())];
      box = {std::min(box.left, u), std::min(box.top, v), std::max(box.right, u), std::max(box.bottom, v),
             box.pixels + 1};
    }
}

void show(Camera& camera, const Context& context) {
  auto& detections = camera.boxes->message.detections;
  const auto& labels = camera.spec.labels;
  std::size_t used = 0;
  for (std::size_t i = 0; i < camera.box.size(); ++i) {
    const Camera::Box& box = camera.box[i];
    const LabelledObject& target = context.labelled_objects[i];
    if (box.pixels < camera.spec.min_pixels) continue;
    if (!labels.empty() && std::find(labels.begin(), labels.end(), target.label) == labels.end()) continue;
    if (used == detections.size()) detections.emplace_back();
    msg::vision::Detection2D& out = detections[used++];
    out.header.stamp = context.now;
    out.header.frame_id = camera.frame_id;
    out.results.resize(1);
    out.results[0].hypothesis.class_id = target.label;
    out.results[0].hypothesis.score = 1;
    out.bbox.center.position = {0.5 * (box.left + box.right), 0.5 * (box.top + box.bottom)};
    out.bbox.size_x = box.right - box.left + 1;
    out.bbox.size_y = box.bottom - box.top + 1;
    out.id = target.name;
  }
  detections.resize(used);
  camera.boxes->publish(context.now);
  camera.info->publish(context.now);
}

}  // namespace

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(cameras::check_exposure({spec.near_m, spec.far_m}, build));
  SL_ASSIGN(const optics::Lens lens, cameras::lens_of(spec, build));
  const std::string optical = build.frame("optical", cameras::X_S_optical);
  auto* const boxes = build.publish<msg::vision::Detection2DArray>(0, "boxes");
  auto* const info = build.publish<msg::CameraInfo>(0, "camera_info");
  boxes->message.header.frame_id = optical;
  cameras::fill_info(info->message, lens, optical);
  Camera camera{std::move(spec), {}, cameras::CameraMount(build, lens), boxes, info, optical};
  camera.seen.resize(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height));
  return camera;
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  cameras::draw_instances(pool, context);
  for (const std::uint32_t index : pool.due) {
    find_boxes(pool.all[index], context);
    show(pool.all[index], context);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"boxes", msg::vision::Detection2DArray::ros_type, "", "Boxes around visible objects."}};
constexpr const char* sdf_types[] = {"sensor:boundingbox", "sensor:boundingbox_camera"};

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  const Node* const type = sdf_element::find(element, "camera/box_type");
  if (const std::string name = sdf_element::text(type); type && name != "2d" && name != "visible_2d")
    diagnostics.warn(type->error("boxes of type '" + name.substr(0, 40) + "' are not supported",
                                 "boxes around what is seen (visible_2d) are given"));
  return sdf_element::camera_keys(element, diagnostics, {});
}
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "boundingbox_camera",
    .help = "Camera that draws boxes around visible objects.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = cameras::camera_sdf_note,
    .needs_render_scene = true,
});

}  // namespace sandlot::boundingbox_camera
