#include "devices/cameras/depth_image.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "physics/parallel.h"

namespace sandlot::cameras {
namespace {

constexpr float nan_m = std::numeric_limits<float>::quiet_NaN();

/// The points of depth 1 m, in the optical frame.
std::vector<std::array<float, 3>> points_at_one_m(const optics::Lens& lens) {
  const bool pinhole = std::holds_alternative<optics::Pinhole>(lens.model);
  std::vector<std::array<float, 3>> points;
  points.reserve(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height));
  for (int v = 0; v < lens.height; ++v)
    for (int u = 0; u < lens.width; ++u) {
      const auto ray = ray_through(lens, u, v);
      if (!ray) {
        points.push_back({nan_m, nan_m, nan_m});
        continue;
      }
      const Vec3 p_S = pinhole ? ray->direction / ray->direction.x : ray->direction;
      const Vec3 p = rotate_inverse(X_S_optical.q, p_S);
      points.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
  return points;
}

std::uint16_t millimetres(float m) {
  return std::isfinite(m) && m > 0 && m < 65.5F ? static_cast<std::uint16_t>(std::lround(m * 1000))
                                                : std::uint16_t{0};
}

}  // namespace

DepthImage::DepthImage(Topic<msg::Image>* topic, Topic<msg::PointCloud2>* points, const optics::Lens& lens,
                       DepthEncoding encoding, const std::string& frame_id, bool colored)
    : topic_(topic),
      points_(points),
      encoding_(encoding),
      width_(lens.width),
      height_(lens.height),
      colored_(colored) {
  const bool metres = encoding == DepthEncoding::metres;
  shape_image(topic->message, lens, metres ? "32FC1" : "16UC1", metres ? 4 : 2, frame_id);
  depth_m_.resize(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height));
  if (!points) return;
  at_one_m_ = points_at_one_m(lens);
  msg::PointCloud2& cloud = points->message;
  cloud.header.frame_id = frame_id;
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "rgb"}) {
    if (offset == 12 && !colored) break;
    cloud.point_fields.push_back({name, offset, msg::PointField::float32, 1});
    offset += 4;
  }
  cloud.point_step = offset;
  cloud.is_dense = false;
}

void DepthImage::finish(double near_m, const DepthNoiseSpec& noise, double errors, const Stream& random,
                        std::span<const std::uint8_t> rgb, Time now) {
  const auto columns = static_cast<std::size_t>(width_);
  const auto nearest = static_cast<float>(near_m);
  parallel_for(static_cast<std::size_t>(height_), 16, [&](std::size_t begin, std::size_t end) {
    const std::span<float> rows = std::span(depth_m_).subspan(begin * columns, (end - begin) * columns);
    corrupt_depth(noise, rows, width_, height_, random, errors, static_cast<int>(begin));
    for (float& d : rows)
      if (d < nearest) d = -std::numeric_limits<float>::infinity();
  });
  msg::Image& image = topic_->message;
  image.width = static_cast<std::uint32_t>(width_);
  image.height = static_cast<std::uint32_t>(height_);
  if (encoding_ == DepthEncoding::metres) {
    image.step = image.width * 4;
    image.data.resize(depth_m_.size() * 4);
    std::memcpy(image.data.data(), depth_m_.data(), image.data.size());
  } else {
    image.step = image.width * 2;
    image.data.resize(depth_m_.size() * 2);
    for (std::size_t i = 0; i < depth_m_.size(); ++i) {
      const std::uint16_t mm = millimetres(depth_m_[i]);
      std::memcpy(image.data.data() + 2 * i, &mm, 2);
    }
  }
  topic_->publish(now);
  if (!points_) return;
  fill_points(rgb);
  points_->publish(now);
}

void DepthImage::fill_points(std::span<const std::uint8_t> rgb) {
  msg::PointCloud2& cloud = points_->message;
  const std::size_t step = colored_ ? 16 : 12;
  cloud.point_step = static_cast<std::uint32_t>(step);
  cloud.width = static_cast<std::uint32_t>(width_);
  cloud.height = static_cast<std::uint32_t>(height_);
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(depth_m_.size() * step);
  for (std::size_t i = 0; i < depth_m_.size(); ++i) {
    const float d = depth_m_[i];
    const auto& one = at_one_m_[i];
    std::array<float, 3> point{nan_m, nan_m, nan_m};
    if (std::isfinite(d)) point = {one[0] * d, one[1] * d, one[2] * d};
    std::uint8_t* const at = cloud.data.data() + i * step;
    std::memcpy(at, point.data(), 12);
    if (!colored_) continue;
    const std::uint8_t bgr0[4] = {rgb[3 * i + 2], rgb[3 * i + 1], rgb[3 * i], 0};
    std::memcpy(at + 12, bgr0, 4);
  }
}

}  // namespace sandlot::cameras
