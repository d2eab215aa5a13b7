#pragma once
/// Shadow grid: places where nothing can stand between a surface and the sun, so that no shadow ray is
/// needed.
///
/// The world is seen from a directional light: a grid across its rays keeps, for each cell, how far towards
/// the light what casts shadows there reaches at most, by its bounding boxes. A point that lies higher is
/// lit. Never wrong, mostly enough: on a soccer field nine of ten points need no ray.
///
/// Cells    those at the border reach to infinity, so points and shapes may lie anywhere.
/// Self     a convex solid throws no shadow on its outside where that faces the light; so each cell knows the
///          highest visual, and the highest of the others.
/// Limits   planes are left out (PictureTree::shadowed() has them).
/// Cost     256 to 16384 cells of 12 bytes; 10 to 100 us to make, once for each placement of the scene.
#include <cstdint>
#include <vector>

#include "optics/picture_tree.h"

namespace sandlot::optics {

class ShadowGrid {
 public:
  /// The grid as seen from the base of a camera's rays: what turns points relative to it into cells.
  struct View {
    const ShadowGrid* grid = nullptr;
    float column[3], row[3], height[3];  ///< per metre
    float column_0, row_0, height_0;     ///< of the base
  };

  /// @param to_light  unit, in W
  void make(const PictureTree& tree, Vec3 to_light);
  View from(const double base[3]) const;

  /// Mask of the valid lanes that something might shade.
  /// @param at    relative to the base, in W
  /// @param self  the convex visual on whose outside the point lies, where it faces the light; -1: none
  static lanes::I doubtful(const View& view, const lanes::F3& at, lanes::I valid, lanes::I self);

 private:
  /// Reach of the highest visual, of the others, and which the highest is.
  struct Cell {
    float first, others;
    std::int32_t highest;
  };
  void add(const Bounds& box, int visual, double margin_m);
  void raise(Cell& cell, float reach, int visual) const;

  Vec3 across_[2], to_light_;
  double corner_m_[2] = {0, 0}, cell_m_[2] = {1, 1};  ///< along across_, from W's origin
  int side_ = 0;                                      ///< cells along each
  float far_m_ = 0;  ///< from the base: beyond, single precision is too coarse for an answer
  std::vector<Cell> cells_;
  std::vector<double> reach_m_[2];  ///< while it is made
};

}  // namespace sandlot::optics
