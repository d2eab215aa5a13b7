#include "devices/cameras/camera/camera.h"

#include "devices/cameras/camera_sdf.h"

namespace sandlot::camera {

namespace {
constexpr const char* sdf_types[] = {"sensor:camera", "sensor:wideanglecamera", "sensor:wide_angle_camera",
                                     "sensor:wide_angle"};
constexpr Preset presets[] = {
    {"raspberry_pi_v2",
     "Raspberry Pi camera module 2 (IMX219), pixels binned by two, all of the sensor: 1640 x 1232, 62.2 deg, "
     "rolling shutter (field of view from the maker's table; 18.9 us per row and the errors are general "
     "knowledge).",
     "{width: 1640, height: 1232, horizontal_fov: 62.2 deg, rate: 30, readout: 23.3 ms,"
     " noise: [{shot: {full_well: 8000}}, {gaussian: {std: 0.4 %}}]}"},
    {"logitech_c920",
     "Logitech C920 webcam: 1280 x 720, 70.4 deg, 30 pictures/s (field of view from the maker's page; the "
     "rolling shutter and the errors are general knowledge, as of a small sensor in a lit room).",
     "{width: 1280, height: 720, horizontal_fov: 70.42 deg, rate: 30, readout: 30 ms,"
     " noise: [{shot: {full_well: 5000}}, {gaussian: {std: 0.8 %}}]}"},
};
}  // namespace

constinit const Kind kind = make_kind<cameras::LevelledCamera<Spec>>({
    .name = "camera",
    .help = "Camera with a pinhole, wide-angle or fisheye lens: pictures, detected objects, or their poses.",
    .levels = cameras::camera_levels,
    .sdf_types = sdf_types,
    .from_sdf =
        [](const Node& element, Diagnostics& diagnostics) {
          return sdf_element::camera_keys(element, diagnostics, {.color = true});
        },
    .sdf_note = cameras::camera_sdf_note,
    .presets = presets,
    .needs_render_scene = true,
});

}  // namespace sandlot::camera
