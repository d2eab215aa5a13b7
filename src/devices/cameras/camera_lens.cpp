#include "devices/cameras/camera_lens.h"

#include <cmath>
#include <mutex>

#include "base/math.h"

namespace sandlot::cameras {
namespace {

using optics::Catadioptric;
using optics::Fisheye;
using optics::Lens;
using optics::Pinhole;

Fisheye::Mapping mapping_of(Projection projection) {
  switch (projection) {
    case Projection::equisolid: return Fisheye::Mapping::equisolid;
    case Projection::stereographic: return Fisheye::Mapping::stereographic;
    case Projection::orthographic: return Fisheye::Mapping::orthographic;
    case Projection::kannala_brandt: return Fisheye::Mapping::kannala_brandt;
    case Projection::pinhole:
    case Projection::equidistant: break;
  }
  return Fisheye::Mapping::equidistant;
}

std::vector<double> numbers_of(const Lens& lens) {
  std::vector<double> all{double(lens.width), double(lens.height), double(lens.model.index())};
  if (const auto* p = std::get_if<Pinhole>(&lens.model))
    for (const double x : {p->fx, p->fy, p->cx, p->cy, p->k1, p->k2, p->p1, p->p2, p->k3}) all.push_back(x);
  if (const auto* f = std::get_if<Fisheye>(&lens.model))
    for (const double x :
         {double(f->mapping), f->fx, f->fy, f->cx, f->cy, f->k1, f->k2, f->k3, f->k4, f->max_theta_rad})
      all.push_back(x);
  if (const auto* m = std::get_if<Catadioptric>(&lens.model))
    for (const double x : {double(m->mirror), m->a_m, m->b_m, m->rim_m, m->fx, m->fy, m->cx, m->cy})
      all.push_back(x);
  return all;
}

const char* key_of_fault(const LensKeys& keys, const DeviceBuild& build) {
  if (static_cast<double>(keys.width) * keys.height > (1 << 24)) return "width";
  return build.decl.config.find("fx") ? "fx" : "horizontal_fov";
}

}  // namespace

Error lens_error(const DeviceBuild& build, const char* key, const Error& error) {
  return build.error(key, error.what, error.fix);
}

Result<Lens> lens_of(const LensKeys& keys, const DeviceBuild& build) {
  const bool pinhole = keys.lens == Projection::pinhole;
  const Distortion& d = keys.distortion;
  if (!pinhole && keys.lens != Projection::kannala_brandt && !d.none())
    return build.error("distortion", "only the lenses pinhole and kannala_brandt have a distortion",
                       "leave it out, or choose one of them");
  if (pinhole ? d.k4 != 0 : d.p1 != 0 || d.p2 != 0)
    return build.error("distortion", "this lens does not have all of these terms",
                       pinhole ? "pinhole: k1 k2 p1 p2 k3" : "kannala_brandt: k1 k2 k3 k4");
  auto of_fov = pinhole
                    ? optics::pinhole_of_fov(keys.width, keys.height, keys.fx ? 1.0 : keys.horizontal_fov_rad)
                    : optics::fisheye_of_fov(keys.width, keys.height, keys.horizontal_fov_rad,
                                             mapping_of(keys.lens));
  if (!of_fov) return lens_error(build, key_of_fault(keys, build), of_fov.error());
  Lens lens = *of_fov;
  const auto set = [&](auto& model) {
    if (keys.fx) model.fx = model.fy = *keys.fx;
    if (keys.fy) model.fy = *keys.fy;
    if (keys.cx) model.cx = *keys.cx;
    if (keys.cy) model.cy = *keys.cy;
    model.k1 = d.k1, model.k2 = d.k2, model.k3 = d.k3;
  };
  if (auto* p = std::get_if<Pinhole>(&lens.model)) set(*p), p->p1 = d.p1, p->p2 = d.p2;
  else if (auto* f = std::get_if<Fisheye>(&lens.model)) set(*f), f->k4 = d.k4;
  if (const Status status = check(lens); !status)
    return lens_error(build, d.none() ? key_of_fault(keys, build) : "distortion", status.error());
  return lens;
}

std::shared_ptr<const optics::LensTable> shared_table(const Lens& lens) {
  // Twelve robots with the same mirror would else compute and keep twelve tables. Tables are constant: who
  // shares one cannot tell.
  struct Known {
    std::vector<double> numbers;
    std::weak_ptr<const optics::LensTable> table;
  };
  static std::mutex mutex;
  static std::vector<Known> known;
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const Known& each) { return each.table.expired(); });
  std::vector<double> numbers = numbers_of(lens);
  for (const Known& each : known)
    if (each.numbers == numbers)
      if (auto table = each.table.lock()) return table;
  auto table = optics::LensTable::make(lens);
  if (!table->is_plain_pinhole()) known.push_back({std::move(numbers), table});
  return table;
}

void fill_info(msg::CameraInfo& info, const Lens& lens, const std::string& frame_id, double baseline_m) {
  info.header.frame_id = frame_id;
  info.width = static_cast<std::uint32_t>(lens.width);
  info.height = static_cast<std::uint32_t>(lens.height);
  info.k = intrinsics(lens);
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto& k = info.k;
  info.p = {k[0], k[1], k[2], -k[0] * baseline_m, k[3], k[4], k[5], 0, k[6], k[7], k[8], 0};
  if (const auto* p = std::get_if<Pinhole>(&lens.model)) {
    info.distortion_model = "plumb_bob";
    info.d = {p->k1, p->k2, p->p1, p->p2, p->k3};
  } else if (const auto* f = std::get_if<Fisheye>(&lens.model)) {
    // ROS calls OpenCV's fisheye "equidistant"; the plain one is it without coefficients.
    constexpr const char* names[] = {"equidistant", "equisolid", "stereographic", "orthographic",
                                     "equidistant"};
    info.distortion_model = names[static_cast<int>(f->mapping)];
    info.d = {f->k1, f->k2, f->k3, f->k4};
  } else if (const auto* m = std::get_if<Catadioptric>(&lens.model)) {
    constexpr const char* names[] = {"mirror_hyperbolic", "mirror_parabolic", "mirror_spherical"};
    info.distortion_model = names[static_cast<int>(m->mirror)];
    info.d = {m->a_m, m->b_m, m->rim_m};
  }
}

}  // namespace sandlot::cameras
