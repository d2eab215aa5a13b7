#pragma once
/// Geometry that the picture scene traces: visuals as solids, planes and trees of triangles. Not for use
/// outside optics.
///
/// Rays are given relative to a base in double precision (the camera), so that what is near the camera is
/// sharp wherever in the world it stands.
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <tbb/task_arena.h>

#include "optics/embree.h"
#include "optics/lanes_math.h"
#include "optics/picture.h"
#include "optics/solid.h"
#include "optics/surface.h"
#include "optics/triangles.h"

namespace sandlot::optics {

/// A visual. Its index is its place in set_shapes(): of two surfaces in one plane the higher is seen.
struct Visual {
  PictureShape given;
  Solid solid{};                       ///< placed; not of planes
  Pose X_GC;                           ///< with the middle of its triangles
  const TriangleTree* tree = nullptr;  ///< of triangles only
  const Skin* skin = nullptr;
  // Planes: through a point, with the axes of their texture.
  bool is_plane = false;
  Vec3 point_W, normal_W, u_W, v_W;
};

/// Eight rays.
struct Rays {
  const double* base;      ///< in W
  lanes::F3 from;          ///< relative to base
  bool from_base = false;  ///< `from` is zero
  lanes::F3 direction;     ///< unit, in W
  lanes::F near, far;
  lanes::I valid;
};

struct Hits {
  lanes::F t;
  lanes::I visual;    ///< index, or -1
  lanes::I triangle;  ///< of meshes
  lanes::F b1, b2;
};

class PictureTree {
 public:
  PictureTree();
  ~PictureTree();
  PictureTree(const PictureTree&) = delete;
  PictureTree& operator=(const PictureTree&) = delete;

  void set(std::span<const PictureShape> shapes);
  /// @param fixed_too  what does not move may stand elsewhere, too
  void place(std::span<const Pose> X_WG, bool fixed_too);

  Hits trace(const Rays& rays, std::uint32_t ignore_body) const;
  /// Whether anything that casts shadows lies between near and far.
  /// @param doubtful     of the valid lanes those on which anything but a plane may throw a shadow
  /// @param ignore_body  casts none
  lanes::I shadowed(const Rays& rays, lanes::I doubtful, std::uint32_t ignore_body) const;

  const Visual& visual(std::size_t i) const { return visuals_[i]; }
  std::size_t size() const { return visuals_.size(); }
  std::uint32_t groups() const { return groups_; }
  const char* isa() const { return embree::choose_isa(); }

 private:
  /// Visuals that are built together.
  struct Layer {
    const PictureTree* owner = nullptr;
    std::vector<std::uint32_t> visuals;
    float margin_m = 0;
    RTCGeometry geometry = nullptr;
    RTCScene scene = nullptr;
    void clear();
    void attach(RTCSceneFlags flags, RTCBuildQuality quality);
  };
  static void bounds(const RTCBoundsFunctionArguments* arguments);
  static void intersect(const RTCIntersectFunctionNArguments* arguments);
  static void occluded(const RTCOccludedFunctionNArguments* arguments);
  void place(Layer& layer, std::span<const Pose> X_WG);

  tbb::task_arena arena_{1};
  std::vector<Visual> visuals_;
  std::vector<std::uint32_t> planes_;
  Layer fixed_, moving_;
  struct Triangles {
    std::unique_ptr<TriangleTree> tree;
    std::unique_ptr<Skin> skins[2];  ///< flat, smooth
  };
  /// By triangles_of(); looked up only, so its order does not matter.
  std::unordered_map<const void*, Triangles> triangles_;
  std::uint32_t groups_ = 0;
};

}  // namespace sandlot::optics
