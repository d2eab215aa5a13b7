#include "optics/ray_scene.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "base/check.h"
#include "optics/embree.h"
#include "optics/solid.h"
#include "optics/triangles.h"

namespace sandlot {
namespace {

using lanes::F;
using lanes::I;
using optics::Solid;
using optics::TriangleTree;

/// Context of the callback in addition to the packet: Embree hands it through to it.
struct Query : embree::QueryContext {
  double origin[3];
  std::uint32_t ignore_body;
};

/// Fields of a packet of n rays: n values of each, one after the other, in the order of RTCRayHit8.
float* field(RTCRayHitN* packet, unsigned n, unsigned index) {
  return reinterpret_cast<float*>(packet) + std::size_t{index} * n;
}
constexpr unsigned tnear_field = 3, dir_field = 4, tfar_field = 8, body_field = 17, found_field = 18;
static_assert(offsetof(RTCRayHit8, ray.tnear) == 32 * tnear_field);
static_assert(offsetof(RTCRayHit8, ray.dir_x) == 32 * dir_field);
static_assert(offsetof(RTCRayHit8, ray.tfar) == 32 * tfar_field);
// `primID` carries the body and `geomID` is 0 once something is hit: Embree passes both through untouched.
static_assert(offsetof(RTCRayHit8, hit.primID) == 32 * body_field);
static_assert(offsetof(RTCRayHit8, hit.geomID) == 32 * found_field);
constexpr int no_geometry = static_cast<int>(RTC_INVALID_GEOMETRY_ID);
constexpr float ray_infinity = std::numeric_limits<float>::infinity();
constexpr float largest_range = std::numeric_limits<float>::max();

/// Keeps the nearer of what each ray has and a surface of `body` at t. Of two at the same distance the
/// smaller body index stays, so that the answer does not depend on the order of traversal.
void keep_nearest(I valid, F t, F tnear, std::uint32_t body, F& tfar, I& bodies, I& found) {
  const I other = lanes::broadcast(static_cast<int>(body));
  const I tie_won = (found == no_geometry) | (other < bodies);
  const I take = valid & (t >= tnear) & (t <= largest_range) & ((t < tfar) | ((t == tfar) & tie_won));
  tfar = lanes::select(take, t, tfar);
  bodies = lanes::select(take, other, bodies);
  found = lanes::select(take, lanes::broadcast(0), found);
}

/// Solids that are built together, and Embree's tree over them.
struct Layer {
  struct Placement {
    std::uint32_t group;
    Pose X_GC;
  };
  std::vector<Placement> placements;
  std::vector<Solid> solids;
  std::vector<const TriangleTree*> trees;  ///< of each solid: null but for those made of triangles
  float margin_m = 0;
  RTCGeometry geometry = nullptr;
  RTCScene scene = nullptr;

  Layer() = default;
  Layer(const Layer&) = delete;
  Layer& operator=(const Layer&) = delete;
  ~Layer() { clear(); }

  void add(const SceneShape& shape, const TriangleTree* tree) {
    placements.push_back({shape.group, tree ? shape.X_GC * Pose{tree->centre_m(), {}} : shape.X_GC});
    solids.push_back(tree ? optics::make_triangles(tree->half_size_m(), shape.body)
                          : optics::make_solid(shape.shape, shape.body));
    trees.push_back(tree);
  }
  void clear() {
    if (scene) rtcReleaseScene(scene);
    if (geometry) rtcReleaseGeometry(geometry);
    scene = nullptr;
    geometry = nullptr;
    placements.clear();
    solids.clear();
    trees.clear();
  }
  /// Makes the (still empty) tree.
  void attach(RTCSceneFlags flags, RTCBuildQuality quality) {
    if (solids.empty()) return;
    scene = rtcNewScene(embree::device());
    rtcSetSceneFlags(scene, flags);
    rtcSetSceneBuildQuality(scene, quality);
    geometry = rtcNewGeometry(embree::device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(solids.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcAttachGeometry(scene, geometry);
  }
  void place(std::span<const Pose> X_WG) {
    double size_m = 0;
    for (std::size_t i = 0; i < solids.size(); ++i) {
      solids[i].place(X_WG[placements[i].group] * placements[i].X_GC);
      const optics::Bounds box = optics::bounds(solids[i]);
      for (std::size_t k = 0; k < 3; ++k)
        size_m = std::max({size_m, std::abs(box.lower[k]), std::abs(box.upper[k])});
    }
    // Embree clips rays against boxes in single precision, with an origin rounded to it: boxes a few such
    // roundings too large lose no ray, and the exact solids inside decide what is hit.
    margin_m = static_cast<float>(1e-6 * size_m);
  }
  void commit(tbb::task_arena& arena) {
    if (solids.empty()) return;
    rtcCommitGeometry(geometry);
    arena.execute([this] { rtcCommitScene(scene); });
  }

  static void bounds(const RTCBoundsFunctionArguments* arguments);
  static void intersect(const RTCIntersectFunctionNArguments* arguments);
};

void Layer::bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& layer = *static_cast<const Layer*>(arguments->geometryUserPtr);
  embree::fill_bounds(optics::bounds(layer.solids[arguments->primID]), layer.margin_m, *arguments->bounds_o);
}

/// One float beyond `far`, so that of two surfaces at equal distances both are seen and the rule for ties
/// decides.
F distance_to(const TriangleTree& tree, const Solid& solid, const double* origin, const optics::Rays8& rays,
              F far, I valid) {
  alignas(32) int lanes_in[lanes::width];
  lanes::store(lanes_in, valid);
  return tree.distance_to(optics::to_local(solid, origin, rays), rays.near,
                          lanes::select((far > 0) & (far < largest_range), F(I(far) + 1), far), lanes_in);
}

void Layer::intersect(const RTCIntersectFunctionNArguments* arguments) {
  const auto& layer = *static_cast<const Layer*>(arguments->geometryUserPtr);
  const Solid& solid = layer.solids[arguments->primID];
  const auto& query = *static_cast<const Query*>(arguments->context);
  if (solid.body == query.ignore_body && solid.body != no_body) return;
  const unsigned n = arguments->N;
  for (unsigned first = 0; first < n; first += lanes::width) {
    const unsigned count = std::min(n - first, unsigned{lanes::width});
    const auto at = [&](unsigned index) { return field(arguments->rayhit, n, index) + first; };
    const optics::Rays8 rays{lanes::load<F>(at(dir_field), count), lanes::load<F>(at(dir_field + 1), count),
                             lanes::load<F>(at(dir_field + 2), count),
                             lanes::load<F>(at(tnear_field), count)};
    const I valid = lanes::load<I>(arguments->valid + first, count);
    F tfar = lanes::load<F>(at(tfar_field), count);
    const F t = solid.type == Solid::Type::triangles
                    ? distance_to(*layer.trees[arguments->primID], solid, query.origin, rays, tfar, valid)
                    : optics::distance_to(solid, query.origin, rays);
    I bodies = lanes::load<I>(at(body_field), count), found = lanes::load<I>(at(found_field), count);
    keep_nearest(valid, t, rays.near, solid.body, tfar, bodies, found);
    lanes::store(at(tfar_field), tfar, count);
    lanes::store(at(body_field), bodies, count);
    lanes::store(at(found_field), found, count);
  }
}

/// Planes have no bounds, so no tree holds them: every ray meets every plane.
struct WorldPlane {
  std::uint32_t group;
  Pose X_GC;
  Vec3 normal_C;
  std::uint32_t body;
  Vec3 point_W, normal_W;

  void place(std::span<const Pose> X_WG) {
    const Pose X_WC = X_WG[group] * X_GC;
    point_W = X_WC.p;
    normal_W = rotate(X_WC.q, normal_C);
  }
};

/// Rotation as a matrix: cheaper than the quaternion from the second direction on.
struct Rotation {
  Vec3 x, y, z;  ///< columns
  explicit Rotation(Quat q) : x(rotate(q, {1, 0, 0})), y(rotate(q, {0, 1, 0})), z(rotate(q, {0, 0, 1})) {}
};

typedef double D4 __attribute__((vector_size(32)));
typedef float F4 __attribute__((vector_size(16)));
struct FourDirections {
  F4 x, y, z;
};

/// Four directions in W, rotated in double precision.
inline FourDirections rotate_four(const Rotation& R, const Vec3& a, const Vec3& b, const Vec3& c,
                                  const Vec3& d) {
  const D4 x{a.x, b.x, c.x, d.x}, y{a.y, b.y, c.y, d.y}, z{a.z, b.z, c.z, d.z};
  return {__builtin_convertvector(R.x.x * x + R.y.x * y + R.z.x * z, F4),
          __builtin_convertvector(R.x.y * x + R.y.y * y + R.z.y * z, F4),
          __builtin_convertvector(R.x.z * x + R.y.z * y + R.z.z * z, F4)};
}

/// Whole vectors: Embree would have to wait for two halves that are stored one by one.
inline F join(F4 a, F4 b) { return F{a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]}; }

}  // namespace

struct RayScene::Impl {
  // Embree's own `threads=` option would limit oneTBB in the whole process; an arena of one builds the trees
  // in the calling thread alone.
  tbb::task_arena arena{1};
  Layer fixed, moving;
  /// By triangles_of(); looked up only, so its order does not matter.
  std::unordered_map<const void*, std::unique_ptr<TriangleTree>> trees;
  std::vector<WorldPlane> planes;
  std::uint32_t groups = 0;  ///< that a frame must have
  std::uint64_t revision = 0;
  bool fixed_is_current = false;

  /// Poses whose trees are built once a ray asks: most ticks of most worlds cast none.
  const SceneFrame* frame = nullptr;
  std::atomic<bool> stale = false;
  std::mutex building;

  /// The tree of a mesh, taken over from the last revision if that had it; null for shapes without triangles.
  const TriangleTree* tree_of(const Shape& shape, decltype(trees)& old) {
    const void* const key = optics::triangles_of(shape);
    if (!key) return nullptr;
    std::unique_ptr<TriangleTree>& tree = trees[key];
    if (tree) return tree.get();
    if (const auto known = old.find(key); known != old.end()) {
      tree = std::move(known->second);
    } else {
      tree = std::make_unique<TriangleTree>(shape);
      arena.execute([&] { tree->commit(); });
    }
    return tree.get();
  }

  void build();
  void cast(const RayJob& job) const;
};

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;
const char* RayScene::isa() const { return embree::choose_isa(); }

void RayScene::set_shapes(std::span<const SceneShape> shapes) {
  Impl& s = *impl_;
  const embree::FlushDenormals flush;
  s.fixed.clear();
  s.moving.clear();
  s.planes.clear();
  s.groups = 0;
  auto old_trees = std::exchange(s.trees, {});
  for (const SceneShape& shape : shapes) {
    s.groups = std::max(s.groups, shape.group + 1);
    if (const auto* plane = std::get_if<Plane>(&shape.shape))
      s.planes.push_back({shape.group, shape.X_GC, plane->normal, shape.body});
    else (shape.moves ? s.moving : s.fixed).add(shape, s.tree_of(shape.shape, old_trees));
  }
  s.fixed.attach(RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
  s.moving.attach(RTC_SCENE_FLAG_DYNAMIC, RTC_BUILD_QUALITY_MEDIUM);
  s.fixed_is_current = false;
}

void RayScene::update(const SceneFrame& frame) {
  Impl& s = *impl_;
  SL_CHECK(frame.X_WG.size() >= s.groups);
  s.frame = &frame;
  s.stale.store(true, std::memory_order_release);
}

/// Of all threads that ask at the same time the first one builds, and the others wait for it.
void RayScene::Impl::build() {
  const std::lock_guard lock(building);
  if (!stale.load(std::memory_order_acquire)) return;
  SL_CHECK(frame->X_WG.size() >= groups);
  if (!fixed_is_current || frame->revision != revision) {
    fixed.place(frame->X_WG);
    fixed.commit(arena);
    fixed_is_current = true;
    revision = frame->revision;
  }
  moving.place(frame->X_WG);
  moving.commit(arena);
  for (WorldPlane& plane : planes) plane.place(frame->X_WG);
  stale.store(false, std::memory_order_release);
}

void RayScene::Impl::cast(const RayJob& job) const {
  SL_CHECK(job.distance_m.size() == job.directions.size());
  SL_CHECK(job.body.empty() || job.body.size() == job.directions.size());
  const Rotation R(job.X_WS.q);
  Query query;
  embree::init_context(query);
  for (std::size_t i = 0; i < 3; ++i) query.origin[i] = job.X_WS.p[i];
  query.ignore_body = job.ignore_body;

  alignas(64) RTCRayHit8 packet{};
  const F tnear = lanes::broadcast(static_cast<float>(job.min_m)),
          tmax = lanes::broadcast(static_cast<float>(job.max_m));
  lanes::store(packet.ray.org_x, lanes::broadcast(static_cast<float>(job.X_WS.p.x)));
  lanes::store(packet.ray.org_y, lanes::broadcast(static_cast<float>(job.X_WS.p.y)));
  lanes::store(packet.ray.org_z, lanes::broadcast(static_cast<float>(job.X_WS.p.z)));
  lanes::store(packet.ray.tnear, tnear);
  lanes::store(packet.ray.mask, lanes::broadcast(-1));
  const Vec3 o = job.X_WS.p;
  const bool begins = std::abs(o.x) + std::abs(o.y) + std::abs(o.z) + std::abs(job.min_m) <= embree::most &&
                      job.max_m >= job.min_m;

  // A packet never holds rays of two jobs: the answer depends on the job alone.
  for (std::size_t first = 0; first < job.directions.size(); first += lanes::width) {
    const std::size_t count = std::min(job.directions.size() - first, std::size_t{lanes::width});
    alignas(32) int valid[lanes::width];
    // Lanes beyond the last ray repeat the first.
    const auto in = [&](std::size_t i) -> const Vec3& { return job.directions[first + (i < count ? i : 0)]; };
    const FourDirections low = rotate_four(R, in(0), in(1), in(2), in(3)),
                         high = rotate_four(R, in(4), in(5), in(6), in(7));
    const F dx = join(low.x, high.x), dy = join(low.y, high.y), dz = join(low.z, high.z);
    lanes::store(packet.ray.dir_x, dx);
    lanes::store(packet.ray.dir_y, dy);
    lanes::store(packet.ray.dir_z, dz);
    const I sound = embree::size(dx) + embree::size(dy) + embree::size(dz) <= embree::most;
    lanes::store(valid, sound & (I{0, 1, 2, 3, 4, 5, 6, 7} < static_cast<int>(begins ? count : 0)));
    F tfar = tmax;
    I bodies = lanes::broadcast(static_cast<int>(no_body)), found = lanes::broadcast(no_geometry);
    for (const WorldPlane& plane : planes) {
      if (plane.body == job.ignore_body && plane.body != no_body) continue;
      const Vec3 n = plane.normal_W;
      const F towards = static_cast<float>(n.x) * dx + static_cast<float>(n.y) * dy +
                        static_cast<float>(n.z) * dz;
      const F t = static_cast<float>(dot(n, plane.point_W - job.X_WS.p)) / towards;
      keep_nearest(lanes::broadcast(-1), t, tnear, plane.body, tfar, bodies, found);
    }
    lanes::store(packet.ray.tfar, tfar);
    lanes::store(packet.hit.primID, bodies);
    lanes::store(packet.hit.geomID, found);
    lanes::store(packet.hit.instID[0], lanes::broadcast(no_geometry));
    for (const Layer* layer : {&fixed, &moving})
      if (layer->scene) embree::ask(valid, layer->scene, query, embree::incoherent, packet);
    tfar = lanes::select(lanes::load<I>(packet.hit.geomID) == no_geometry, lanes::broadcast(ray_infinity),
                         lanes::load<F>(packet.ray.tfar));
    lanes::store(job.distance_m.data() + first, tfar, static_cast<unsigned>(count));
    if (!job.body.empty())
      lanes::store(job.body.data() + first, lanes::load<I>(packet.hit.primID), static_cast<unsigned>(count));
  }
}

void RayScene::cast(std::span<const RayJob> jobs) const {
  const embree::FlushDenormals flush;
  if (impl_->stale.load(std::memory_order_acquire)) impl_->build();
  for (const RayJob& job : jobs) impl_->cast(job);
}

}  // namespace sandlot
