#pragma once
/// Meshes and terrain as rays see them: one Embree tree per mesh, shared by all solids made from it.
///
/// The tree is built once, in the mesh's own frame about the middle of its bounds, and kept while any shape
/// uses it. A ray is taken into that frame first (in double precision, solid.h), so that a tree neither moves
/// with its body nor loses digits far from the world's origin. Triangles are hit from both sides; edges have
/// no gaps (Embree's robust mode). Which triangle is hit is Embree's answer; where, is computed here: Embree
/// divides by way of the processor's estimate of a reciprocal, which every maker of processors rounds in his
/// own way.
///
/// Cost     a mesh: about 1 us and 100 bytes per triangle, once; terrain: about 30 bytes per sample.
#include "geometry/shape.h"
#include "optics/embree.h"
#include "optics/solid.h"

namespace sandlot::optics {

class TriangleTree {
 public:
  /// An empty tree over the triangles; commit() builds it. @pre shape is a Mesh or a Heightfield
  explicit TriangleTree(const Shape& shape);
  ~TriangleTree();
  TriangleTree(const TriangleTree&) = delete;
  TriangleTree& operator=(const TriangleTree&) = delete;

  /// Runs in the caller's task arena.
  void commit() { rtcCommitScene(scene_); }
  Vec3 centre_m() const { return centre_; }  ///< of the tree's frame in the shape's
  Vec3 half_size_m() const { return half_size_; }

  /// Distance to the first triangle at or behind `near` and not behind `far`; infinite where there is none.
  lanes::F distance_to(const LocalRays8& rays, lanes::F near, lanes::F far, const int* valid) const;

  /// The same, and where: the triangle's index and the weights of its second and third corner. Of a height
  /// field's grid only the distance means something.
  struct Hits {
    lanes::F t;
    lanes::I triangle;
    lanes::F b1, b2;
  };
  Hits nearest(const LocalSpread8& rays, lanes::F near, lanes::F far, const int* valid) const;
  /// Whether any triangle lies between near and far.
  lanes::I between(const LocalSpread8& rays, lanes::F near, lanes::F far, const int* valid) const;

 private:
  void add_triangles(const TriangleMesh& mesh);
  void add_grid(const HeightGrid& grid);
  void attach(RTCGeometry geometry);
  template <class Rays>
  Hits hit(const Rays& rays, lanes::F near, lanes::F far, const int* valid) const;
  template <class Rays>
  void place_on_mesh(const Rays& rays, Hits& hits) const;
  template <class Rays>
  void place_on_grid(const Rays& rays, Hits& hits) const;

  Shape shape_;  ///< keeps the mesh alive, and with it the address it is known by
  RTCScene scene_ = nullptr;
  const float* corners_ = nullptr;     ///< x, y, z in the tree's frame; the scene's
  const unsigned* indices_ = nullptr;  ///< three a triangle; null: corners_ are those of a grid
  Vec3 centre_, half_size_;
};

/// Identity of the mesh or grid from which shapes are made; null for every other shape.
const void* triangles_of(const Shape& shape);

}  // namespace sandlot::optics
