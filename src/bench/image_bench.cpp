#include <tbb/task_arena.h>

#include "bench/bench.h"
#include "bench/msl_scene.h"

namespace sandlot::bench {

namespace {

std::vector<Row> pictures_of_a_field() {
  const MslScene field;
  optics::PictureScene scene;
  scene.set_shapes(field.shapes);
  scene.set_lights(field.lights);
  scene.update(field.frame);
  std::vector<Row> rows;
  struct Camera {
    const char* name;
    std::shared_ptr<const optics::LensTable> lens;
  };
  const optics::Catadioptric mirror{
      .mirror = optics::Catadioptric::Mirror::hyperbolic, .a_m = 0.0306, .b_m = 0.0674, .rim_m = 0.018};
  for (const Camera& camera :
       {Camera{"camera", optics::LensTable::make(optics::pinhole_of_fov(640, 480, 1.2).value())},
        Camera{"omni-camera", optics::LensTable::make(optics::omni_that_fills(640, 480, mirror).value())}}) {
    constexpr std::size_t pixels = 640 * 480;
    std::vector<std::uint8_t> rgb(3 * pixels);
    std::vector<float> depth_m(pixels);
    std::vector<optics::PictureJob> pictures, depths;
    for (const std::size_t i : {0u, 5u, 10u}) {
      optics::PictureJob job;
      job.X_WS = field.robots[i] * Pose{{0, 0, 0.8}, {}};
      job.lens = camera.lens;
      job.ignore_body = static_cast<std::uint32_t>(i + 1);
      depths.push_back(job);
      depths.back().depth_m = depth_m;
      pictures.push_back(job);
      pictures.back().rgb = rgb;
    }
    const Timing t = compare(
        9,
        [&] {
          for (const auto& job : pictures) scene.render({&job, 1});
        },
        [&] {
          for (const auto& job : depths) scene.render({&job, 1});
        });
    const double per_picture = 1e3 / static_cast<double>(pictures.size());
    rows.push_back(row("P5 " + std::string(camera.name) + " 640 x 480 with shadows, against its depth alone",
                       "ms", t.ours_s * per_picture, t.reference_s * per_picture, 1.6));
  }
  return rows;
}

}  // namespace

std::vector<Row> images() {
  tbb::task_arena one(1);  // the clock is that of one thread
  return one.execute(pictures_of_a_field);
}

}  // namespace sandlot::bench
