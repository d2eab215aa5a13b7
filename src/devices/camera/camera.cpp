#include "devices/camera/camera.h"

#include "devices/camera_sdf.h"

namespace sandlot::camera {

namespace {
constexpr const char* sdf_types[] = {"sensor:camera", "sensor:wideanglecamera", "sensor:wide_angle_camera",
                                     "sensor:wide_angle"};
}  // namespace

constinit const Kind kind = make_kind<eye::LookingCamera<Spec>>({
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
