#include "optics/picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/math.h"
#include "optics/camera_rays.h"
#include "optics/picture_tree.h"
#include "optics/shade.h"
#include "physics/parallel.h"

namespace sandlot::optics {
namespace {

using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;
using lanes::select;

constexpr int tile = 16;
constexpr float infinity = std::numeric_limits<float>::infinity();

/// A picture on its way: what of its samples is taken in one placement of the scene.
struct Shot {
  const PictureJob* job;
  CameraRays camera;
  Scenery scenery;
  std::vector<float> sums;    ///< three per pixel, of several slices; empty: one slice
  int slice = 0;              ///< the present one
  int columns = 0, rows = 0;  ///< of tiles

  Shot(const PictureJob& j, const PictureTree& tree, const Surroundings& surroundings)
      : job(&j), camera(j), scenery{&tree,         {}, surroundings, j.exposure.shadows, j.exposure.srgb,
                                    j.exposure.lit} {
    const Lens& lens = j.lens->lens();
    columns = (lens.width + tile - 1) / tile;
    rows = (lens.height + tile - 1) / tile;
    const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
    const auto fits = [&](std::size_t size, std::size_t each) { return size == 0 || size == pixels * each; };
    SL_CHECK(fits(j.rgb.size(), 3) && fits(j.depth_m.size(), 1) && fits(j.label.size(), 1) &&
             fits(j.instance.size(), 1));
    if (camera.slices() > 1 && !j.rgb.empty()) sums.assign(3 * pixels, 0);
  }
  std::size_t tiles() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  void draw_tile(std::size_t index);
  void draw_packet(int u0, int v0);
  void write_planes(const Block& block, const Rays& rays, const Hits& hits);
  void write_rgb(const Block& block, const F3& sum);
};

/// R G B 0 of four pixels as twelve bytes, in each half.
I without_fourth_bytes(I colors) {
#if defined(__AVX2__)
  const __m256i order = _mm256_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1, 0, 1, 2, 4,
                                         5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
  return I(_mm256_shuffle_epi8(__m256i(colors), order));
#else
  std::uint8_t from[32], to[32] = {};
  lanes::store(from, colors);
  for (std::size_t i = 0; i < 8; ++i) std::memcpy(to + 16 * (i / 4) + 3 * (i % 4), from + 4 * i, 3);
  return lanes::load<I>(to);
#endif
}

void Shot::write_planes(const Block& block, const Rays& rays, const Hits& hits) {
  const F distance = job->depth_m.empty() ? hits.t : camera.depth(block, rays, hits.t);
  const I seen = rays.valid & (hits.visual >= 0);
  for (int i = 0; i < lanes::width; ++i) {
    if (!block.inside[i]) continue;
    const std::size_t at = block.index(i);
    if (!job->depth_m.empty()) job->depth_m[at] = seen[i] ? distance[i] : infinity;
    if (job->label.empty() && job->instance.empty()) continue;
    const PictureShape* shape = seen[i]
                                    ? &scenery.tree->visual(static_cast<std::size_t>(hits.visual[i])).given
                                    : nullptr;
    if (!job->label.empty()) job->label[at] = shape ? shape->label : std::uint16_t{0};
    if (!job->instance.empty()) job->instance[at] = shape ? shape->instance : 0;
  }
}

void Shot::write_rgb(const Block& block, const F3& sum) {
  const auto gain = static_cast<float>(job->exposure.gain) / static_cast<float>(camera.samples());
  const auto byte = [&](F x) {
    x = lanes::clamp(gain * x, 0, 1);
    if (job->exposure.srgb) x = srgb_encoded(x);
    return lanes::truncate(255 * x + 0.5f);
  };
  const I colors = byte(sum.x) | byte(sum.y) << 8 | byte(sum.z) << 16;
  alignas(32) std::uint8_t packed[32];  // the bytes of each half side by side: 12, then 4 unused
  lanes::store(packed, without_fourth_bytes(colors));
  // Row by row of the block, as many of its pixels as the image has.
  const int count = std::min(4, block.width - block.u[0]);
  std::uint8_t* const first = job->rgb.data() + 3 * block.index(0);
  if (!block.inside[4]) {
    std::memcpy(first, packed, static_cast<std::size_t>(3 * count));
    return;
  }
  const int more = std::min(4, block.width - block.u[4]);
  std::uint8_t* const second = job->rgb.data() + 3 * block.index(4);
  if (count == 4 && more == 4) {
    std::memcpy(first, packed, 12);
    std::memcpy(second, packed + 16, 12);
  } else {
    std::memcpy(first, packed, static_cast<std::size_t>(3 * count));
    std::memcpy(second, packed + 16, static_cast<std::size_t>(3 * more));
  }
}

void Shot::draw_packet(int u0, int v0) {
  const Block block = camera.block(u0, v0);
  const bool planes = !job->depth_m.empty() || !job->label.empty() || !job->instance.empty();
  const std::uint32_t ignored = job->ignore_body;
  // One sample goes through the pixel's centre, and serves all planes.
  const bool centre = planes && camera.centre_slice(block) == slice;
  const bool shared = camera.samples() == 1 && !camera.has_aperture();
  if (centre && !(shared && !job->rgb.empty())) {
    const Aim aim = camera.centre(block);
    write_planes(block, aim.rays, scenery.tree->trace(aim.rays, ignored));
  }
  if (job->rgb.empty()) return;
  const F zero = broadcast(0.0f);
  F3 sum{zero, zero, zero};
  bool any_sample = false;
  for (int i = 0; i < camera.samples(); ++i) {
    if (camera.slice_of(block, i) != slice) continue;
    any_sample = true;
    const Aim aim = camera.aim(block, i);
    const Hits hits = scenery.tree->trace(aim.rays, ignored);
    if (centre && shared) write_planes(block, aim.rays, hits);
    const F3 light = shade(scenery, aim.rays, hits, aim.cone);
    // Beyond the rim of a mirror or the circle of a fisheye no light comes through.
    sum = sum + select(aim.rays.valid, light, F3{zero, zero, zero});
  }
  if (sums.empty()) return write_rgb(block, sum);
  if (!any_sample) return;
  for (int i = 0; i < lanes::width; ++i) {
    if (!block.inside[i]) continue;
    float* const to = sums.data() + 3 * block.index(i);
    to[0] += sum.x[i], to[1] += sum.y[i], to[2] += sum.z[i];
  }
}

void Shot::draw_tile(std::size_t index) {
  const Lens& lens = job->lens->lens();
  const int u0 = static_cast<int>(index % static_cast<std::size_t>(columns)) * tile;
  const int v0 = static_cast<int>(index / static_cast<std::size_t>(columns)) * tile;
  for (int v = v0; v < std::min(v0 + tile, lens.height); v += camera.block_height())
    for (int u = u0; u < std::min(u0 + tile, lens.width); u += camera.block_width()) {
      draw_packet(u, v);
      if (sums.empty() || slice + 1 < camera.slices()) continue;
      const Block block = camera.block(u, v);
      F3 sum{};
      for (int i = 0; i < lanes::width; ++i) {
        if (!block.inside[i]) continue;
        const float* const from = sums.data() + 3 * block.index(i);
        sum.x[i] = from[0], sum.y[i] = from[1], sum.z[i] = from[2];
      }
      write_rgb(block, sum);
    }
}

}  // namespace

struct PictureScene::Impl {
  PictureTree tree;
  std::vector<PictureShape> shapes;
  std::vector<PictureLight> lights;
  Surroundings surroundings;
  SceneFrame frame;
  std::vector<Velocity> velocities;
  std::vector<Pose> later;        ///< poses at another time of the exposure
  std::vector<ShadowGrid> grids;  ///< one per light, used of suns
  bool new_shapes = false, new_fixed = true, new_poses = true;
  bool new_grids = true;  ///< shapes or lights stand elsewhere than when the grids were made

  void make_current() {
    if (new_shapes) {
      tree.set(shapes);
      new_shapes = false;
      new_fixed = true;
    }
    if (!new_poses && !new_fixed) return;
    SL_CHECK(frame.X_WG.size() >= tree.groups());
    tree.place(frame.X_WG, new_fixed);
    new_fixed = new_poses = false;
    new_grids = true;
  }
  void place_at(double t_s) {
    later = frame.X_WG;
    for (std::size_t i = 0; i < velocities.size(); ++i) later[i] = moved(later[i], velocities[i], t_s);
    tree.place(later, false);
    new_poses = new_grids = true;
  }
  void light(Shot& shot, std::span<const Pose> X_WG) const {
    shot.scenery.lights.clear();
    const Vec3 p = shot.job->X_WS.p;
    const double base[] = {p.x, p.y, p.z};
    for (const PictureLight& l : lights) shot.scenery.lights.push_back(light_now(l, X_WG, base));
    for (std::size_t i = 0; i < lights.size(); ++i)
      if (has_grid(lights[i].light) && i < grids.size()) shot.scenery.lights[i].grid = grids[i].from(base);
  }
  /// The shadow grids for the present placement of the scene, where one of the jobs wants shadows.
  void look_from_suns(std::span<const PictureJob> jobs, std::span<const Pose> X_WG) {
    const bool wanted = std::any_of(jobs.begin(), jobs.end(), [](const PictureJob& job) {
      return !job.rgb.empty() && job.exposure.shadows && job.exposure.lit;
    });
    if (!wanted || !new_grids) return;
    new_grids = false;
    grids.resize(lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i)
      if (has_grid(lights[i].light))
        grids[i].make(tree, rotate((X_WG[lights[i].group] * lights[i].light.X_PLight).q, {0, 0, 1}));
  }
  static bool has_grid(const model::Light& light) {
    return light.type == model::Light::Type::directional && light.cast_shadows;
  }
};

PictureScene::PictureScene() : impl_(std::make_unique<Impl>()) {}
PictureScene::~PictureScene() = default;
const char* PictureScene::isa() const { return impl_->tree.isa(); }

void PictureScene::set_shapes(std::span<const PictureShape> shapes) {
  impl_->shapes.assign(shapes.begin(), shapes.end());
  impl_->new_shapes = true;
}
void PictureScene::set_lights(std::span<const PictureLight> lights) {
  impl_->lights.assign(lights.begin(), lights.end());
  impl_->new_grids = true;
}
void PictureScene::set_surroundings(const Surroundings& surroundings) { impl_->surroundings = surroundings; }

void PictureScene::update(const SceneFrame& frame, std::span<const Velocity> velocities) {
  Impl& s = *impl_;
  SL_CHECK(velocities.empty() || velocities.size() >= frame.X_WG.size());
  s.new_fixed = s.new_fixed || frame.revision != s.frame.revision;
  s.new_poses = true;
  s.frame = frame;
  s.velocities.assign(velocities.begin(), velocities.end());
  s.velocities.resize(std::min(s.velocities.size(), frame.X_WG.size()));
}

void PictureScene::render(std::span<const PictureJob> jobs) {
  if (jobs.empty()) return;
  Impl& s = *impl_;
  const embree::FlushDenormals flush;
  s.make_current();
  for (const PictureLight& light : s.lights) SL_CHECK(light.group < s.frame.X_WG.size());
  s.look_from_suns(jobs, s.frame.X_WG);
  std::vector<Shot> shots;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> work;  // shot and tile
  shots.reserve(jobs.size());
  for (const PictureJob& job : jobs) {
    Shot& shot = shots.emplace_back(job, s.tree, s.surroundings);
    s.light(shot, s.frame.X_WG);
    if (shot.camera.slices() > 1) continue;
    for (std::uint32_t i = 0; i < shot.tiles(); ++i)
      work.emplace_back(static_cast<std::uint32_t>(shots.size() - 1), i);
  }
  parallel_for(work.size(), 2, [&](std::size_t begin, std::size_t end) {
    const embree::FlushDenormals in_this_thread;
    for (std::size_t i = begin; i < end; ++i) shots[work[i].first].draw_tile(work[i].second);
  });
  for (Shot& shot : shots) {
    if (shot.camera.slices() == 1) continue;
    for (shot.slice = 0; shot.slice < shot.camera.slices(); ++shot.slice) {
      s.place_at(shot.camera.time_of_slice(shot.slice));
      s.look_from_suns({shot.job, 1}, s.later);
      s.light(shot, s.later);
      parallel_for(shot.tiles(), 2, [&](std::size_t begin, std::size_t end) {
        const embree::FlushDenormals in_this_thread;
        for (std::size_t i = begin; i < end; ++i) shot.draw_tile(i);
      });
    }
  }
}

void PictureScene::illuminate(std::span<LightProbe> probes) {
  if (probes.empty()) return;
  Impl& s = *impl_;
  const embree::FlushDenormals flush;
  s.make_current();
  Scenery scenery{&s.tree, {}, s.surroundings};
  for (LightProbe& probe : probes) {
    const double base[] = {probe.p_W.x, probe.p_W.y, probe.p_W.z};
    scenery.lights.clear();
    for (const PictureLight& light : s.lights) {
      SL_CHECK(light.group < s.frame.X_WG.size());
      scenery.lights.push_back(light_now(light, s.frame.X_WG, base));
    }
    scenery.shadowless_body = probe.ignore_body;
    const float normal[] = {static_cast<float>(probe.normal_W.x), static_cast<float>(probe.normal_W.y),
                            static_cast<float>(probe.normal_W.z)};
    const F zero = broadcast(0.0f);
    I one{};
    one[0] = -1;
    const F3 light = light_at(scenery, base, F3{zero, zero, zero}, lanes::broadcast3(normal), one);
    probe.light = {light.x[0], light.y[0], light.z[0], 1};
  }
}

}  // namespace sandlot::optics
