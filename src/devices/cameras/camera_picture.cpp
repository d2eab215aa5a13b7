#include "devices/cameras/camera_picture.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "physics/parallel.h"

namespace sandlot::cameras {

Status check_exposure(const ExposureKeys& keys, const DeviceBuild& build) {
  if (keys.far_m <= keys.near_m)
    return build.error("far", "far must be greater than near", "near is " + number_text(keys.near_m) + " m");
  return {};
}

CameraMount::CameraMount(const DeviceBuild& build, const optics::Lens& lens)
    : key(build.key), body(build.body().index), X_LS(build.decl.X_LS), table(shared_table(lens)) {}

optics::PictureJob CameraMount::job(const ExposureKeys& keys, const Context& context) const {
  const BodyState& carrier = context.engine.states()[body];
  optics::PictureJob job;
  job.X_WS = carrier.X_WB * X_LS;
  job.velocity = {carrier.V_WB.linear + cross(carrier.V_WB.angular, rotate(carrier.X_WB.q, X_LS.p)),
                  carrier.V_WB.angular};
  job.lens = table;
  job.exposure.samples = keys.samples;
  job.exposure.shadows = keys.shadows;
  job.exposure.gain = keys.exposure;
  job.exposure.srgb = keys.srgb;
  job.exposure.aperture_m = keys.aperture_m;
  job.exposure.focus_m = keys.focus_distance_m;
  job.exposure.shutter_s = keys.shutter_s;
  job.exposure.readout_s = keys.readout_s;
  job.key = key;
  job.ignore_body = body;
  job.near_m = keys.near_m;
  job.far_m = keys.far_m;
  return job;
}

void shape_image(msg::Image& image, const optics::Lens& lens, const char* encoding, std::uint32_t pixel_bytes,
                 const std::string& frame_id) {
  image.header.frame_id = frame_id;
  image.width = static_cast<std::uint32_t>(lens.width);
  image.height = static_cast<std::uint32_t>(lens.height);
  image.encoding = encoding;
  image.step = image.width * pixel_bytes;
}

ColorImage::ColorImage(const DeviceBuild& build, Topic<msg::Image>* topic, const optics::Lens& lens,
                       Format format, const ImageNoiseSpec& noise, const std::string& frame_id,
                       std::uint64_t use)
    : topic_(topic), format_(format), width_(lens.width), height_(lens.height), key_(build.key), use_(use) {
  const std::uint32_t channels = format == Format::mono8 ? 1 : 3;
  shape_image(topic->message, lens, format_names[static_cast<int>(format)].name, channels, frame_id);
  noise_.reset(noise, Stream(build.seed, build.key, Purpose::initial, 0).fork(use));
}

void ColorImage::compress(Topic<msg::CompressedImage>* topic, Compression compression, int quality,
                          ImageEncoder encode) {
  SL_CHECK(compression != Compression::none && encode != nullptr);
  compressed_ = topic;
  encode_ = encode;
  quality_ = compression == Compression::jpeg ? quality : 0;
  topic->message.header.frame_id = topic_->message.header.frame_id;
  topic->message.format = compression_names[static_cast<int>(compression)].name;
}

std::span<std::uint8_t> ColorImage::rgb(bool published) {
  const std::size_t step = static_cast<std::size_t>(width_) * (format_ == Format::mono8 ? 1 : 3);
  if (published) {
    // Sizes are set again: a snapshot may hold others.
    msg::Image& image = topic_->message;
    image.width = static_cast<std::uint32_t>(width_);
    image.height = static_cast<std::uint32_t>(height_);
    image.step = static_cast<std::uint32_t>(step);
  }
  std::vector<std::uint8_t>& data = published ? topic_->message.data : hidden_;
  data.resize(step * static_cast<std::size_t>(height_));
  if (format_ != Format::mono8) return data;
  rgb_.resize(3 * data.size());
  return rgb_;
}

void ColorImage::finish(const ExposureKeys& keys, const ImageNoiseSpec& noise, double errors,
                        std::uint64_t sample, const Context& context, bool published) {
  std::vector<std::uint8_t>& data = published ? topic_->message.data : hidden_;
  const int channels = format_ == Format::mono8 ? 1 : 3;
  if (channels == 1)
    for (std::size_t i = 0; i < data.size(); ++i)
      data[i] = static_cast<std::uint8_t>(
          (299U * rgb_[3 * i] + 587U * rgb_[3 * i + 1] + 114U * rgb_[3 * i + 2] + 500U) / 1000U);
  const Stream random = Stream(context.seed, key_, Purpose::noise, sample).fork(use_);
  std::array<std::uint8_t, 256> shown{};
  if (keys.gamma != 1)
    for (std::size_t i = 0; i < shown.size(); ++i)
      shown[i] = static_cast<std::uint8_t>(
          std::lround(255 * math::pow(static_cast<double>(i) / 255, 1 / keys.gamma)));
  const std::size_t row = static_cast<std::size_t>(width_) * static_cast<std::size_t>(channels);
  parallel_for(static_cast<std::size_t>(height_), 16, [&](std::size_t begin, std::size_t end) {
    const std::span<std::uint8_t> rows = std::span(data).subspan(begin * row, (end - begin) * row);
    noise_.corrupt(noise, rows, width_, height_, channels, random, errors, static_cast<int>(begin));
    if (keys.gamma != 1)
      for (std::uint8_t& value : rows) value = shown[value];
    if (format_ == Format::bgr8)
      for (std::size_t i = 0; i + 2 < rows.size(); i += 3) std::swap(rows[i], rows[i + 2]);
  });
  if (!published) return;
  topic_->publish(context.now);
  if (!compressed_) return;
  std::span<const std::uint8_t> pixels = data;
  if (format_ == Format::bgr8) {
    rgb_.assign(data.begin(), data.end());
    for (std::size_t i = 0; i + 2 < rgb_.size(); i += 3) std::swap(rgb_[i], rgb_[i + 2]);
    pixels = rgb_;
  }
  const std::string bytes = encode_(width_, height_, channels, pixels, quality_);
  compressed_->message.data.assign(bytes.begin(), bytes.end());
  compressed_->publish(context.now);
}

}  // namespace sandlot::cameras
