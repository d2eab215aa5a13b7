#include "devices/cameras/omni_camera/omni_camera.h"

namespace sandlot::omni_camera {
namespace {

/// a and b where the file gives none; see the header.
optics::Catadioptric mirror_of(const Spec& spec) {
  optics::Catadioptric m;
  m.rim_m = spec.rim_m;
  switch (spec.mirror) {
    case Shape::hyperbolic:
      m.mirror = Mirror::hyperbolic;
      m.a_m = spec.a_m.value_or(0.0763708);  // 5 sqrt(233.3) mm
      m.b_m = spec.b_m.value_or(0.1685007);  // 5 sqrt(1135.7) mm
      break;
    case Shape::parabolic:
      m.mirror = Mirror::parabolic;
      m.a_m = spec.a_m.value_or(0.034);
      m.b_m = spec.b_m.value_or(0);
      break;
    case Shape::spherical:
      m.mirror = Mirror::spherical;
      m.a_m = spec.a_m.value_or(0.06);
      m.b_m = spec.b_m.value_or(0.2);
      break;
  }
  return m;
}

}  // namespace

Result<optics::Lens> lens_of(const Spec& spec, const DeviceBuild& build) {
  if (spec.aperture_m > 0)
    return build.error("aperture", "depth of field below a mirror is not simulated", "leave it out");
  const optics::Catadioptric mirror = mirror_of(spec);
  const char* const key = static_cast<double>(spec.width) * spec.height > (1 << 24) ? "width"
                          : build.decl.config.find("a")                             ? "a"
                          : build.decl.config.find("b")                             ? "b"
                          : build.decl.config.find("rim")                           ? "rim"
                                                                                    : "mirror";
  auto lens = optics::omni_that_fills(spec.width, spec.height, mirror);
  if (!lens) return cameras::lens_error(build, key, lens.error());
  if (spec.focal_length) {
    auto& model = std::get<optics::Catadioptric>(lens->model);
    model.fx = model.fy = *spec.focal_length;
    if (const Status status = check(*lens); !status)
      return cameras::lens_error(build, "focal_length", status.error());
  }
  return lens;
}

constinit const Kind kind = make_kind<cameras::LevelledCamera<Spec>>({
    .name = "omni_camera",
    .help = "Camera that looks into a convex mirror and sees all around.",
    .levels = cameras::camera_levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::omni_camera
