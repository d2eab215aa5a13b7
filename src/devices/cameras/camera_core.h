#pragma once
/// Core of the cameras with levels: the directed one and the one below a mirror.
///
/// Levels   `image` (the default): sensor_msgs/Image on <device>/image, CameraInfo on <device>/camera_info,
///          with `compressed` CompressedImage on <device>/image/compressed. `objects`:
///          sandlot_msgs/ObjectArray in the sensor's frame. `world`: sandlot_msgs/ObjectPoseArray in `world`.
///          See devices/cameras/detector.h. Any of them together; what is not active costs nothing: without
///          `image` no picture is drawn.
/// Zoom     with `zoom`: devices/cameras/zoom.h. All levels look through the zoomed lens.
/// Switch   zoom and numbers of samples go on; the topics of a level that is left keep their last message.
/// Time     everything is as it is at the end of the tick (with a shutter: the middle of the first row's
///          exposure).
#include <optional>

#include "devices/cameras/detector.h"
#include "devices/cameras/zoom.h"
#include "physics/parallel.h"

namespace sandlot::cameras {

/// A Spec derives from it and from the keys of its lens.
struct CameraKeys : ExposureKeys {
  double rate_hz = 30;
  Format format = Format::rgb8;
  Compression compressed = Compression::none;
  int quality = 90;
  ImageNoiseSpec noise;
  std::optional<Zoom> zoom;
  ObjectKeys objects;
  WorldKeys world;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"format", "", "Format of the pixels."}, s.format);
    visit(Field{"compressed", "", "File format of an additional compressed picture on image/compressed."},
          s.compressed);
    visit(Field{"quality", "1", "JPEG quality.", 1, 100}, s.quality);
    visit(Field{"zoom", "", "Zoom lens; none: fixed focal length."}, s.zoom);
    ExposureKeys::fields(s, visit);
    visit(Field{"noise", "1", "Errors of the picture."}, s.noise);
    visit(Field{"objects", "", "Detector of level objects, also used by level world."}, s.objects);
    visit(Field{"world", "", "Detection of poses at level world."}, s.world);
    visit(errors_field, s.errors);
  }
};

struct CameraState {
  double zoom = 1;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"zoom", "1", "Present focal length, as a multiple of the spec's."}, s.zoom);
  }
};

enum Level : std::uint32_t { image, objects, world };
inline constexpr LevelInfo camera_levels[] = {
    {"image", msg::Image::ros_type, "", "Pictures of the scene."},
    {"objects", msg::ObjectArray::ros_type, "", "Detected objects: bearing, range, label."},
    {"world", msg::ObjectPoseArray::ros_type, "", "Poses of the detected objects in the world."},
};

/// Lens, pictures and topics of a camera, which are neither spec nor state.
class CameraCore {
 public:
  CameraCore() = default;
  CameraCore(const DeviceBuild& build, const optics::Lens& lens, const CameraKeys& keys);

  static bool fits(const CameraKeys& keys, const CameraState& state) {
    return state.zoom >= 1 && state.zoom <= (keys.zoom ? keys.zoom->max : 1);
  }
  /// Moves the zoom to its value at this sample.
  void turn_zoom(const CameraKeys& keys, CameraState& state, double since_s, Time now);
  optics::PictureJob job(const CameraKeys& keys, const Context& context);
  void finish(const CameraKeys& keys, std::uint64_t sample, const Context& context);
  void detect(const CameraKeys& keys, std::uint32_t levels, std::uint64_t sample, double since_s,
              const Context& context);

  const CameraMount& mount() const { return mount_; }

 private:
  optics::Lens unzoomed_;
  double zoom_of_table_ = 1;
  CameraMount mount_;
  ColorImage picture_;
  Topic<msg::CameraInfo>* info_ = nullptr;
  Topic<msg::ObjectArray>* objects_ = nullptr;
  Topic<msg::ObjectPoseArray>* poses_ = nullptr;
  Topic<msg::Float64>* zoom_command_ = nullptr;
  Topic<msg::Float64>* zoom_ = nullptr;  ///< what it is
};

/// A camera whose Spec has the keys above and a lens: lens_of(spec, build).
template <class Keys>
struct LevelledCamera {
  using Spec = Keys;
  using State = CameraState;
  Spec spec;
  State state;
  CameraCore core;

  static Result<LevelledCamera> create(const DeviceBuild& build, Spec spec) {
    SL_TRY(check_exposure(spec, build));
    SL_ASSIGN(const optics::Lens lens, lens_of(spec, build));
    LevelledCamera camera{std::move(spec), {}, {}};
    camera.core = CameraCore(build, lens, camera.spec);
    return camera;
  }
  static void sense(PoolView<LevelledCamera> pool, const Context& context);
  bool fits() const { return CameraCore::fits(spec, state); }
};

template <class Keys>
void LevelledCamera<Keys>::sense(PoolView<LevelledCamera> pool, const Context& context) {
  bool pictures = false;
  for (const std::uint32_t index : pool.due) {
    LevelledCamera& device = pool.all[index];
    device.core.turn_zoom(device.spec, device.state, pool.since[index].s(), context.now);
    pictures = pictures || (pool.levels[index] >> image & 1);
  }
  if (pictures) {
    JobBatch batch(context);
    for (const std::uint32_t index : pool.due)
      if (pool.levels[index] >> image & 1) batch.add(pool.all[index].core.job(pool.all[index].spec, context));
    batch.flush();
    for (const std::uint32_t index : pool.due)
      if (pool.levels[index] >> image & 1)
        pool.all[index].core.finish(pool.all[index].spec, pool.sample[index], context);
  }
  parallel_for(pool.due.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (; begin < end; ++begin) {
      const std::uint32_t index = pool.due[begin];
      LevelledCamera& device = pool.all[index];
      device.core.detect(device.spec, pool.levels[index], pool.sample[index], pool.since[index].s(), context);
    }
  });
}

}  // namespace sandlot::cameras
