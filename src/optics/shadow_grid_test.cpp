#include "optics/shadow_grid.h"

#include <gtest/gtest.h>

#include <bit>

#include "base/math.h"
#include "base/random.h"
#include "geometry/mesh.h"
#include "optics/test_studio.h"

namespace sandlot::optics {
namespace {

using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;

Rays towards(Vec3 light, const double* base, const F3& at) {
  const F3 direction{broadcast(static_cast<float>(light.x)), broadcast(static_cast<float>(light.y)),
                     broadcast(static_cast<float>(light.z))};
  return {base, at, false, direction, broadcast(0.0f), broadcast(1e30f), broadcast(-1)};
}

TEST(ShadowGrid, NoShadowIsMissed) {
  int dark = 0, spared = 0, points = 0;
  for (int scene = 0; scene < 40; ++scene) {
    Stream r(7, entity_key("shadow grid"), Purpose::placement, static_cast<std::uint64_t>(scene));
    test::Studio studio;
    const Vec3 far = scene % 4 == 3 ? Vec3{3000, -5000, 100} : Vec3{};  // also far from the origin
    const auto somewhere = [&] {
      return Pose{far + Vec3{r.uniform(-6, 6), r.uniform(-6, 6), r.uniform(0, 2)},
                  quat_from_rpy(r.uniform(-3, 3), r.uniform(-3, 3), r.uniform(-3, 3))};
    };
    studio.add(Box{{100, 80, 0.1}}, {far + Vec3{0, 0, -0.05}, {}});
    for (int i = 0; i < 12; ++i) {
      studio.add(Box{{r.uniform(0.05, 2), 0.3, 0.2}}, somewhere());
      studio.add(Sphere{r.uniform(0.02, 0.5)}, somewhere());
      studio.add(Mesh{std::make_shared<TriangleMesh>(tessellate(Cylinder{0.2, 0.6}))}, somewhere());
    }
    PictureTree tree;
    tree.set(studio.shapes);
    tree.place(studio.frame.X_WG, true);
    const Vec3 light = normalised(Vec3{r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(0, 1)});
    ShadowGrid grid;
    grid.make(tree, light);
    const double base[] = {far.x + 1, far.y - 2, far.z + 1};
    const ShadowGrid::View view = grid.from(base);
    for (int packet = 0; packet < 100; ++packet) {
      F3 at{};
      for (int i = 0; i < lanes::width; ++i) {
        at.x[i] = static_cast<float>(r.uniform(-9, 9));
        at.y[i] = static_cast<float>(r.uniform(-9, 9));
        at.z[i] = static_cast<float>(packet % 2 ? r.uniform(-1, 2) : -0.999);
      }
      const I shaded = tree.shadowed(towards(light, base, at), broadcast(-1), no_body);
      const I doubtful = ShadowGrid::doubtful(view, at, broadcast(-1), broadcast(-1));
      EXPECT_FALSE(lanes::any(shaded & ~doubtful)) << scene;
      // On the carpet the carpet itself does not count.
      if (packet % 2 == 0) {
        const I others = ShadowGrid::doubtful(view, at, broadcast(-1), I{});
        EXPECT_FALSE(lanes::any(shaded & ~others)) << scene;
        spared += std::popcount(lanes::bits(~others));
        points += lanes::width;
      }
      dark += std::popcount(lanes::bits(shaded));
    }
  }
  EXPECT_GT(dark, 1000);
  EXPECT_GT(spared, points / 4) << "or there is no use in it";
}

TEST(ShadowGrid, OnlyWhatIsBeforeTheSunIsDoubtful) {
  test::Studio studio;
  studio.add(Box{{20, 20, 0.1}}, {{0, 0, -0.05}, {}});
  studio.add(Sphere{0.5}, {{3, 0, 2}, {}});
  studio.add(Sphere{0.5}, {{-3, 0, 2}, {}}).cast_shadows = false;
  PictureTree tree;
  tree.set(studio.shapes);
  tree.place(studio.frame.X_WG, true);
  ShadowGrid grid;
  grid.make(tree, normalised(Vec3{1, 0, 1}));
  const double base[] = {0, 0, 0};
  // The sphere's shadow lies around x = 3 - 2 = 1; below the one without a shadow, behind both, above, and
  // beyond the field.
  const F3 at{F{1, 1, -5, 6, 1, 4.5f, 30, -40}, F{0, 3, 0, 0, 0, 0, 0, 0},
              F{0.01f, 0.01f, 0.01f, 0.01f, 4, 3.5f, 40, 60}};
  EXPECT_EQ(lanes::bits(ShadowGrid::doubtful(grid.from(base), at, broadcast(-1), I{})), 1u);
  const I two{-1, 0, 0, 0, 0, 0, -1, 0};
  EXPECT_EQ(lanes::bits(ShadowGrid::doubtful(grid.from(base), at, two, I{})), 1u);
}

TEST(ShadowGrid, ABoardSeenFromItsEdgeHasNoWidth) {
  const auto board = std::make_shared<const TriangleMesh>(TriangleMesh{
      .vertices = {{0, -1, 0}, {0, 1, 0}, {0, 1, 2}, {0, -1, 2}}, .triangles = {{0, 1, 2}, {0, 2, 3}}});
  test::Studio studio;
  studio.add(Mesh{board}, {});
  PictureTree tree;
  tree.set(studio.shapes);
  tree.place(studio.frame.X_WG, true);
  ShadowGrid grid;
  grid.make(tree, {0, 0, 1});
  const double base[] = {0, 0, 0};
  const F3 at{F{0, 1, 0, 0, 0, 0, 0, 0}, F{}, F{1, 1, 3, 1, 1, 1, 1, 1}};
  const unsigned doubtful = lanes::bits(
      ShadowGrid::doubtful(grid.from(base), at, broadcast(-1), broadcast(-1)));
  EXPECT_EQ(doubtful & 7u, 1u);  // in the board, beside it, above it
}

}  // namespace
}  // namespace sandlot::optics
