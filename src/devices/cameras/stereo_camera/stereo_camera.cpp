#include "devices/cameras/stereo_camera/stereo_camera.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "devices/cameras/camera_sdf.h"
#include "noise/deviates.h"
#include "physics/parallel.h"

namespace sandlot::stereo_camera {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Luma, as mono8 has it.
void to_grey(std::span<const std::uint8_t> pixels, cameras::Format format, std::vector<std::uint8_t>& grey) {
  if (format == cameras::Format::mono8) {
    grey.assign(pixels.begin(), pixels.end());
    return;
  }
  grey.resize(pixels.size() / 3);
  const std::size_t r = format == cameras::Format::rgb8 ? 0 : 2, b = 2 - r;
  for (std::size_t i = 0; i < grey.size(); ++i)
    grey[i] = static_cast<std::uint8_t>(
        (299U * pixels[3 * i + r] + 587U * pixels[3 * i + 1] + 114U * pixels[3 * i + b] + 500U) / 1000U);
}

}  // namespace

Calibration calibrated(const CalibrationKeys& keys, double scale, Stream random) {
  const auto drawn = [&](double deviation) { return scale * deviation * random.normal(); };
  Calibration out;
  // A focal length or a baseline of nothing would be no camera.
  out.focal = std::max(drawn(keys.focal), -0.9);
  out.baseline = std::max(drawn(keys.baseline), -0.9);
  out.column_px = drawn(keys.centre_px), out.row_px = drawn(keys.centre_px);
  Vec3 turn;
  for (std::size_t i = 0; i < 3; ++i) turn[i] = drawn(keys.rotation_rad);
  const double angle = norm(turn);
  if (angle > 0) out.q_right = quat_from_axis_angle(turn / angle, angle);
  return out;
}

void Calibration::apply(msg::CameraInfo& info) const {
  for (auto* const m : {&info.k[0], &info.k[4], &info.p[0], &info.p[5]}) *m *= 1 + focal;
  info.p[3] *= (1 + focal) * (1 + baseline);
  for (auto* const m : {&info.k[2], &info.p[2]}) *m += column_px;
  for (auto* const m : {&info.k[5], &info.p[6]}) *m += row_px;
}

Disparities::Disparities(Topic<msg::DisparityImage>* topic, Topic<msg::PointCloud2>* points,
                         const optics::Lens& lens, const Spec& spec, const Calibration& errors,
                         const std::string& frame_id)
    : topic_(topic),
      points_(points),
      width_(lens.width),
      height_(lens.height),
      baseline_m_(spec.baseline_m * (1 + errors.baseline)) {
  msg::CameraInfo info;
  cameras::fill_info(info, lens, frame_id);
  true_fb_m_ = info.k[0] * spec.baseline_m;
  errors.apply(info);
  fx_ = info.k[0], cx_ = info.k[2], fy_ = info.k[4], cy_ = info.k[5];
  msg::DisparityImage& message = topic->message;
  message.header.frame_id = frame_id;
  cameras::shape_image(message.image, lens, "32FC1", 4, frame_id);
  message.f = static_cast<float>(fx_);
  message.t = static_cast<float>(baseline_m_);
  message.min_disparity = static_cast<float>(spec.matching.least);
  message.max_disparity = static_cast<float>(spec.matching.least + spec.matching.count - 1);
  values_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  if (!points) return;
  msg::PointCloud2& cloud = points->message;
  cloud.header.frame_id = frame_id;
  std::uint32_t offset = 0;
  for (const char* const name : {"x", "y", "z"}) {
    cloud.point_fields.push_back({name, offset, msg::PointField::float32, 1});
    offset += 4;
  }
  cloud.point_step = offset;
  cloud.is_dense = false;
}

void Disparities::publish(Time now) {
  msg::DisparityImage& message = topic_->message;
  msg::Image& picture = message.image;
  picture.width = static_cast<std::uint32_t>(width_);
  picture.height = static_cast<std::uint32_t>(height_);
  picture.step = picture.width * 4;
  picture.data.resize(values_.size() * 4);
  std::memcpy(picture.data.data(), values_.data(), picture.data.size());
  picture.header.stamp = now;
  topic_->publish(now);
  if (!points_) return;
  fill_points();
  points_->publish(now);
}

void Disparities::fill_points() {
  msg::PointCloud2& cloud = points_->message;
  cloud.width = static_cast<std::uint32_t>(width_);
  cloud.height = static_cast<std::uint32_t>(height_);
  cloud.point_step = 12;
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(values_.size() * 12);
  const double fb = fx_ * baseline_m_;
  for (int v = 0; v < height_; ++v)
    for (int u = 0; u < width_; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(u);
      std::array<float, 3> point{nan, nan, nan};
      if (values_[i] > 0) {
        const double z = fb / static_cast<double>(values_[i]);
        point = {static_cast<float>((u - cx_) / fx_ * z), static_cast<float>((v - cy_) / fy_ * z),
                 static_cast<float>(z)};
      }
      std::memcpy(cloud.data.data() + 12 * i, point.data(), 12);
    }
}

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(cameras::check_exposure(spec, build));
  if (spec.lens != cameras::Projection::pinhole || !spec.distortion.none())
    return build.error(spec.distortion.none() ? "lens" : "distortion",
                       "the pictures of a stereo camera are rectified", "a pinhole without distortion");
  SL_ASSIGN(const optics::Lens lens, cameras::lens_of(spec, build));
  const std::string optical = build.frame("optical", cameras::X_S_optical);
  const Calibration errors = calibrated(spec.calibration, spec.errors,
                                        Stream(build.seed, build.key, Purpose::initial, 0));
  Camera camera{std::move(spec), {}, {}, {}, {}, {}};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string side = i == 0 ? "left" : "right";
    Side& s = camera.sides[i];
    s.mount = cameras::CameraMount(build, lens);
    if (i == 1) s.mount.X_LS = s.mount.X_LS * Pose{{0, -camera.spec.baseline_m, 0}, errors.q_right};
    s.picture = cameras::ColorImage(build, build.publish<msg::Image>(image, (side + "/image").c_str()), lens,
                                    camera.spec.format, camera.spec.noise, optical, i);
    s.info = build.publish<msg::CameraInfo>(image, (side + "/camera_info").c_str());
    cameras::fill_info(s.info->message, lens, optical, i == 0 ? 0 : camera.spec.baseline_m);
    errors.apply(s.info->message);
  }
  const auto disparities = [&](Level level, const std::string& name) {
    auto* const topic = build.publish<msg::DisparityImage>(level, name.c_str());
    auto* const points = camera.spec.points
                             ? build.publish<msg::PointCloud2>(level, (name + "/points").c_str())
                             : nullptr;
    return Disparities(topic, points, lens, camera.spec, errors, optical);
  };
  camera.matched = disparities(disparity, "disparity");
  camera.computed = disparities(closed_form, "closed_form");
  return camera;
}

void Camera::match() {
  const optics::Lens& lens = sides[0].mount.lens();
  const auto columns = static_cast<std::size_t>(lens.width);
  parallel_for(static_cast<std::size_t>(lens.height), 32, [&](std::size_t begin, std::size_t end) {
    cameras::match_rows(spec.matching, sides[0].grey, sides[1].grey, lens.width, lens.height,
                        static_cast<int>(begin), static_cast<int>(end),
                        matched.values().subspan(begin * columns, (end - begin) * columns));
  });
}

void Camera::compute(std::uint64_t sample, const Context& context) {
  const optics::Lens& lens = sides[0].mount.lens();
  const auto columns = static_cast<std::size_t>(lens.width);
  const Stream random = Stream(context.seed, sides[0].mount.key, Purpose::noise, sample).fork(sides.size());
  const auto blocks = static_cast<std::uint32_t>((columns + 7) / 8);
  const double fb = computed.focal_baseline_m(), least = spec.matching.least,
               most = least + spec.matching.count - 1;
  const auto scale = static_cast<float>(spec.errors * spec.match_std);
  parallel_for(static_cast<std::size_t>(lens.height), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<float> normals(columns), nearest(columns);
    for (std::size_t v = begin; v < end; ++v) {
      const std::span<const float> depth = std::span(depth_m).subspan(v * columns, columns);
      const std::span<float> out = computed.values().subspan(v * columns, columns);
      // What the right eye sees in a column is the point of the largest disparity.
      std::fill(nearest.begin(), nearest.end(), 0.0F);
      const auto seen_in = [&](std::size_t u, float d) {
        return std::lround(static_cast<double>(u) - static_cast<double>(d));
      };
      for (std::size_t u = 0; u < columns; ++u) {
        const float z = depth[u];
        out[u] = std::isfinite(z) && z > 0 ? static_cast<float>(fb / static_cast<double>(z))
                                           : cameras::no_disparity;
        if (out[u] < 0) continue;
        if (const long at = seen_in(u, out[u]); at >= 0) {
          float& most_near = nearest[static_cast<std::size_t>(at)];
          most_near = std::max(most_near, out[u]);
        }
      }
      fill_normals(random, static_cast<std::uint32_t>(v) * blocks, normals);
      for (std::size_t u = 0; u < columns; ++u) {
        float& d = out[u];
        if (d < 0) continue;
        const long at = seen_in(u, d);
        const bool visible = at >= 0 && d > nearest[static_cast<std::size_t>(at)] - 1;
        d += scale * normals[u];
        if (!visible || !(d > 0) || static_cast<double>(d) < least || static_cast<double>(d) > most)
          d = cameras::no_disparity;
      }
    }
  });
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  const auto has = [&](std::uint32_t index, Level level) { return (pool.levels[index] >> level & 1) != 0; };
  cameras::JobBatch batch(context);
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    if (has(index, image) || has(index, disparity))
      for (Side& side : camera.sides) {
        optics::PictureJob job = side.mount.job(camera.spec, context);
        job.rgb = side.picture.rgb(has(index, image));
        batch.add(std::move(job));
      }
    if (!has(index, closed_form)) continue;
    optics::PictureJob job = camera.sides[0].mount.job({camera.spec.near_m, camera.spec.far_m}, context);
    camera.depth_m.resize(camera.computed.values().size());
    job.depth_m = camera.depth_m;
    batch.add(std::move(job));
  }
  batch.flush();
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    const bool shows = has(index, image), matches = has(index, disparity);
    if (shows || matches)
      for (Side& side : camera.sides) {
        side.picture.finish(camera.spec, camera.spec.noise, camera.spec.errors, pool.sample[index], context,
                            shows);
        if (shows) side.info->publish(context.now);
        if (matches) to_grey(side.picture.pixels(shows), camera.spec.format, side.grey);
      }
    if (matches) {
      camera.match();
      camera.matched.publish(context.now);
    }
    if (has(index, closed_form)) {
      camera.compute(pool.sample[index], context);
      camera.computed.publish(context.now);
    }
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"image", msg::Image::ros_type, "", "Pictures of both eyes."},
    {"disparity", msg::DisparityImage::ros_type, "",
     "Disparities found by matching blocks of both pictures."},
    {"closed_form", msg::DisparityImage::ros_type, "",
     "Disparities of the true depths with normal errors, without pictures."},
};
constexpr const char* sdf_types[] = {"sensor:multicamera"};
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "stereo_camera",
    .help = "Two cameras side by side with rectified pictures, and the disparities in them.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = sdf_element::stereo_keys,
    .sdf_note = cameras::camera_sdf_note,
    .needs_render_scene = true,
});

}  // namespace sandlot::stereo_camera
