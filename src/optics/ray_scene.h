#pragma once
/// Ray scene: collision shapes for the range sensors of a 3D world (Embree).
///
/// Geometry is given once per Model revision, poses once per tick (SceneFrame), questions in batches of
/// RayJobs. All three are plain, serialisable data: threads answer now, other processes may later.
///
/// Geometry   analytic boxes, spheres, cylinders, capsules, cones, ellipsoids, planes: silhouettes are exact.
///            Meshes and terrain as their triangles, hit from both sides; one tree per mesh, however many
///            shapes show it.
/// Precision  single precision inside; distances within 2e-6 of the size of the scene around the sensor.
/// Limits     surfaces only: a ray that starts inside a solid sees its far side. No materials yet.
/// Cost       update: nothing. The first cast after it: about 0.4 us per moving solid (one tree over them is
///            rebuilt), nothing for the others until the revision changes. A mesh: 1 us per triangle when it is
///            first seen, then as any solid.
///            cast: 20 ns per ray of a 2D fan on a soccer field; no allocation of ours.
/// Determinism  one answer per Embree isa (fixed, see `isa()`), for any thread count and grouping of jobs.
#include <memory>
#include <span>
#include <vector>

#include "geometry/rays.h"
#include "geometry/shape.h"

namespace sandlot {

/// One solid that rays can hit.
struct SceneShape {
  std::uint32_t group = 0;  ///< index into SceneFrame::X_WG
  Pose X_GC;                ///< shape frame in the group's frame
  Shape shape;
  std::uint32_t body = no_body;  ///< reported in RayJob::body and compared with RayJob::ignore_body
  bool moves = true;             ///< false: the group's pose never changes between revisions
};

/// Poses of all groups at one tick.
struct SceneFrame {
  std::uint64_t tick = 0;
  std::uint64_t revision = 0;
  std::vector<Pose> X_WG;
};

class RayScene final : public RayCaster {
 public:
  RayScene();
  ~RayScene() override;
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// Replaces all geometry; rays need an update() before them.
  void set_shapes(std::span<const SceneShape> shapes);
  /// Takes the poses of this tick; the first cast() after it builds the trees, and threads that ask meanwhile wait.
  /// @pre frame.X_WG covers all groups; the frame outlives the casts before the next update()
  void update(const SceneFrame& frame);
  void cast(std::span<const RayJob> jobs) const override;

  /// The instruction set that Embree was pinned to ("avx2" or "sse4.2"); part of the numeric profile.
  const char* isa() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot
