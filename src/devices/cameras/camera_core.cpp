#include "devices/cameras/camera_core.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::cameras {

CameraCore::CameraCore(const DeviceBuild& build, const optics::Lens& lens, const CameraKeys& keys)
    : unzoomed_(lens), mount_(build, lens) {
  const bool mirror = std::holds_alternative<optics::Catadioptric>(lens.model);
  const std::string optical = build.frame("optical", mirror ? X_S_optical_mirror : X_S_optical);
  picture_ = ColorImage(build, build.publish<msg::Image>(image, "image"), lens, keys.format, keys.noise,
                        optical);
  info_ = build.publish<msg::CameraInfo>(image, "camera_info");
  fill_info(info_->message, lens, optical);
  if (keys.compressed != Compression::none && build.encode_image)
    picture_.compress(build.publish<msg::CompressedImage>(image, "image/compressed"), keys.compressed,
                      keys.quality, build.encode_image);
  objects_ = build.publish<msg::ObjectArray>(objects, "objects");
  objects_->message.header.frame_id = build.frame_id();
  poses_ = build.publish<msg::ObjectPoseArray>(world, "world");
  poses_->message.header.frame_id = "world";
  if (!keys.zoom) return;
  constexpr std::uint32_t always = std::size(camera_levels);  // a level beyond all: whatever is active
  zoom_command_ = build.accept<msg::Float64>(always, "zoom");
  zoom_ = build.publish<msg::Float64>(always, "zoom");
}

void CameraCore::turn_zoom(const CameraKeys& keys, CameraState& state, double since_s, Time now) {
  if (!keys.zoom) return;
  const double wanted = zoom_command_->message.data;
  if (zoom_command_->count > 0 && std::isfinite(wanted)) {
    const double most = math::pow(keys.zoom->rate_per_s, since_s);
    state.zoom = std::clamp(std::clamp(wanted, 1.0, keys.zoom->max), state.zoom / most, state.zoom * most);
  }
  zoom_->message.data = state.zoom;
  zoom_->publish(now);
  if (state.zoom == zoom_of_table_) return;
  optics::Lens lens = unzoomed_;
  std::visit([&](auto& model) { model.fx *= state.zoom, model.fy *= state.zoom; }, lens.model);
  if (!check(lens)) return;  // so long that it shows nothing: the lens stays where it is
  mount_.table = shared_table(lens);
  zoom_of_table_ = state.zoom;
  const std::string optical = info_->message.header.frame_id;
  fill_info(info_->message, lens, optical);
}

optics::PictureJob CameraCore::job(const CameraKeys& keys, const Context& context) {
  optics::PictureJob job = mount_.job(keys, context);
  job.rgb = picture_.rgb();
  return job;
}

void CameraCore::finish(const CameraKeys& keys, std::uint64_t sample, const Context& context) {
  picture_.finish(keys, keys.noise, keys.errors, sample, context);
  info_->publish(context.now);
}

void CameraCore::detect(const CameraKeys& keys, std::uint32_t levels, std::uint64_t sample, double since_s,
                        const Context& context) {
  const bool wants_objects = levels >> objects & 1, wants_poses = levels >> world & 1;
  if (!wants_objects && !wants_poses) return;
  cameras::detect(keys.objects, keys.world, keys.errors, mount_, sample, since_s, context,
                  wants_objects ? &objects_->message : nullptr, wants_poses ? &poses_->message : nullptr);
  if (wants_objects) objects_->publish(context.now);
  if (wants_poses) poses_->publish(context.now);
}

}  // namespace sandlot::cameras
