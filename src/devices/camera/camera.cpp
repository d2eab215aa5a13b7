#include "devices/camera/camera.h"

#include "devices/camera_sdf.h"

namespace sandlot::camera {

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(eye::check_exposure(spec, build));
  SL_ASSIGN(const optics::Lens lens, eye::lens_of(spec, build));
  Camera camera{std::move(spec), {}, {}};
  camera.look = eye::Look(build, lens, camera.spec);
  return camera;
}

namespace {
constexpr const char* sdf_types[] = {"sensor:camera", "sensor:wideanglecamera", "sensor:wide_angle_camera",
                                     "sensor:wide_angle"};
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "camera",
    .help = "Camera with a pinhole, wide-angle or fisheye lens: pictures, things seen, or their poses.",
    .levels = eye::look_levels,
    .sdf_types = sdf_types,
    .from_sdf =
        [](const Node& element, Diagnostics& diagnostics) {
          return sdf_element::camera_keys(element, diagnostics, {.color = true});
        },
    .sdf_note = eye::camera_sdf_note,
    .sees = true,
});

}  // namespace sandlot::camera
