#pragma once
/// Small worlds and pictures of them, for the tests of optics.
#include "base/math.h"
#include "optics/picture.h"

namespace sandlot::optics::test {

inline constexpr Color white{1, 1, 1, 1}, black{0, 0, 0, 1};

/// A world that is put together in one statement, and pictures of it.
struct Studio {
  std::vector<PictureShape> shapes;
  std::vector<PictureLight> lights;
  SceneFrame frame{.X_WG = {Pose{}}};
  std::vector<Velocity> velocities;
  Surroundings surroundings{black, black};
  PictureScene scene;

  /// Shines by itself: its colour is what is seen.
  PictureShape& glow(Shape shape, Pose X, Color color = white) {
    PictureShape& s = add(std::move(shape), X, black);
    s.appearance.emissive = color;
    return s;
  }
  PictureShape& add(Shape shape, Pose X, Color color = white) {
    PictureShape s;
    s.X_GC = X;
    s.shape = std::move(shape);
    s.appearance.diffuse = color;
    s.label = static_cast<std::uint16_t>(shapes.size() + 1);
    s.instance = static_cast<std::uint32_t>(1000 + shapes.size());
    shapes.push_back(std::move(s));
    return shapes.back();
  }
  model::Light& light(model::Light::Type type, Pose X) {
    PictureLight l;
    l.light.type = type;
    l.light.X_PLight = X;
    l.light.color = white;
    l.light.cast_shadows = true;
    lights.push_back(l);
    return lights.back().light;
  }
  void ready() {
    scene.set_shapes(shapes);
    scene.set_lights(lights);
    scene.set_surroundings(surroundings);
    scene.update(frame, velocities);
  }
};

struct Shot {
  int width;
  std::vector<std::uint8_t> rgb;
  std::vector<float> depth_m;
  std::vector<std::uint16_t> label;
  std::vector<std::uint32_t> instance;

  Shot(Studio& studio, PictureJob job) : width(job.lens->lens().width) {
    studio.ready();
    const auto pixels = static_cast<std::size_t>(width * job.lens->lens().height);
    rgb.resize(3 * pixels), depth_m.resize(pixels), label.resize(pixels), instance.resize(pixels);
    job.rgb = rgb, job.depth_m = depth_m, job.label = label, job.instance = instance;
    studio.scene.render({&job, 1});
  }
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v * width + u); }
  int red(int u, int v) const { return rgb[3 * index(u, v)]; }
};

inline std::shared_ptr<const LensTable> pinhole(int width = 160, int height = 120,
                                                double fov = math::pi / 2) {
  return LensTable::make(pinhole_of_fov(width, height, fov).value());
}
/// Looks straight down from a height, x of the world to the top of the image.
inline Pose above(double x, double y, double z) { return {{x, y, z}, quat_from_rpy(0, math::pi / 2, 0)}; }
/// Directional light that shines along `direction`.
inline Quat along(Vec3 direction) { return quat_between({0, 0, -1}, normalised(direction)); }

}  // namespace sandlot::optics::test
