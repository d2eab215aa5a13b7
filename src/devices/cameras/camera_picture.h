#pragma once
/// Pictures of all cameras: from the picture scene to sensor_msgs/Image.
#include <vector>

#include "devices/cameras/camera_lens.h"
#include "noise/image_noise.h"
#include "optics/picture.h"

namespace sandlot::cameras {

/// Keys of the exposure. A Spec derives from it.
struct ExposureKeys {
  double near_m = 0.01, far_m = 1000;
  int samples = 1;
  bool shadows = true;
  double exposure = 1, gamma = 1;
  bool srgb = false;
  double aperture_m = 0, focus_distance_m = 1;
  double shutter_s = 0, readout_s = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"near", "m", "Nearest visible distance.", 0, 1e4}, s.near_m);
    visit(Field{"far", "m", "Farthest visible distance.", 1e-3, 1e6}, s.far_m);
    visit(Field{"samples", "1", "Number of rays per pixel, for anti-aliasing and smooth blur.", 1, 256,
                tunable},
          s.samples);
    visit(Field{"shadows", "", "Whether objects throw shadows.", 0, 1, tunable}, s.shadows);
    visit(Field{"exposure", "1", "Factor on all light.", 0, 1e3, tunable}, s.exposure);
    visit(Field{"gamma", "1", "Gamma of the picture: value^(1/gamma) is shown.", 0.1, 10, tunable}, s.gamma);
    visit(Field{"srgb", "", "Whether light is added up linearly and shown in sRGB.", 0, 1, tunable}, s.srgb);
    visit(Field{"aperture", "m",
                "Diameter of the lens, for depth of field (pinhole, samples > 1); 0: all is sharp.", 0, 1,
                tunable},
          s.aperture_m);
    visit(Field{"focus_distance", "m", "Distance at which the picture is sharp.", 1e-3, 1e6, tunable},
          s.focus_distance_m);
    visit(Field{"shutter", "s", "Exposure time, for motion blur.", 0, 10, tunable}, s.shutter_s);
    visit(
        Field{"readout", "s", "Time from the first row to the last, for a rolling shutter.", 0, 10, tunable},
        s.readout_s);
  }
};
/// Rules between those keys.
Status check_exposure(const ExposureKeys& keys, const DeviceBuild& build);

enum class Format : std::uint8_t { rgb8, bgr8, mono8 };
inline constexpr EnumName<Format> format_names[] = {
    {"rgb8", Format::rgb8}, {"bgr8", Format::bgr8}, {"mono8", Format::mono8}};
constexpr std::span<const EnumName<Format>> enum_names(Format) { return format_names; }

enum class Compression : std::uint8_t { none, jpeg, png };
inline constexpr EnumName<Compression> compression_names[] = {
    {"none", Compression::none}, {"jpeg", Compression::jpeg}, {"png", Compression::png}};
constexpr std::span<const EnumName<Compression>> enum_names(Compression) { return compression_names; }

/// Place of a camera on its robot, and its lens.
struct CameraMount {
  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link that carries it
  Pose X_LS;
  std::shared_ptr<const optics::LensTable> table;

  CameraMount() = default;
  CameraMount(const DeviceBuild& build, const optics::Lens& lens);
  const optics::Lens& lens() const { return table->lens(); }
  Pose X_WS(const Context& context) const { return context.engine.states()[body].X_WB * X_LS; }
  /// A job without planes.
  optics::PictureJob job(const ExposureKeys& keys, const Context& context) const;
};

/// One colour or grey image: rendered into `rgb()`, corrupted, and published.
class ColorImage {
 public:
  ColorImage() = default;
  /// @param use  which of the images of one device this is: each has errors of its own
  ColorImage(const DeviceBuild& build, Topic<msg::Image>* topic, const optics::Lens& lens, Format format,
             const ImageNoiseSpec& noise, const std::string& frame_id, std::uint64_t use = 0);
  /// From now on the picture goes out as a file's bytes, too.
  void compress(Topic<msg::CompressedImage>* topic, Compression compression, int quality,
                ImageEncoder encode);
  /// Room for the next picture, made at the first one.
  /// @param published  false: for the device itself; its topic stays as it is, since what is on it is State
  std::span<std::uint8_t> rgb(bool published = true);
  /// @param published  as it was in rgb()
  void finish(const ExposureKeys& keys, const ImageNoiseSpec& noise, double errors, std::uint64_t sample,
              const Context& context, bool published = true);
  /// The latest picture in its format, rows without gaps. @param published  as it was in finish()
  std::span<const std::uint8_t> pixels(bool published) const {
    return published ? topic_->message.data : hidden_;
  }

 private:
  Topic<msg::Image>* topic_ = nullptr;
  Topic<msg::CompressedImage>* compressed_ = nullptr;
  ImageEncoder encode_ = nullptr;
  int quality_ = 0;  ///< as ImageEncoder has it
  Format format_ = Format::rgb8;
  int width_ = 0, height_ = 0;
  std::uint64_t key_ = 0, use_ = 0;
  ImageNoise noise_;
  std::vector<std::uint8_t> rgb_;     ///< of mono8 and for compressing bgr8: others are drawn in place
  std::vector<std::uint8_t> hidden_;  ///< pixels that are not shown
};

/// Sizes and encoding. There are no pixels before the first picture: those of a level that is off would be State.
void shape_image(msg::Image& image, const optics::Lens& lens, const char* encoding, std::uint32_t pixel_bytes,
                 const std::string& frame_id);

/// Draws a batch without a list of its own on the heap: jobs are handed over sixteen at a time.
class JobBatch {
 public:
  explicit JobBatch(const Context& context) : scene_(context.pictures) { SL_CHECK(scene_ != nullptr); }
  void add(optics::PictureJob job) {
    jobs_[count_++] = std::move(job);
    if (count_ == jobs_.size()) flush();
  }
  void flush() {
    if (count_ > 0) scene_->render({jobs_.data(), count_});
    count_ = 0;
  }

 private:
  optics::PictureScene* scene_;
  std::array<optics::PictureJob, 16> jobs_;
  std::size_t count_ = 0;
};

}  // namespace sandlot::cameras
