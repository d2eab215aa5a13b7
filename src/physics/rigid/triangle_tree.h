#pragma once
/// Tree of the bounding boxes of a mesh's triangles, to find those in a box; double precision, in the mesh's
/// own frame.
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace sandlot::rigid {

class TriangleTree {
 public:
  /// @pre the mesh outlives the tree
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Calls each(a, b, c) for every triangle whose bounding box meets that of low and high, its front facing
  /// out of the solid; in an order that depends on the mesh alone.
  template <class Each>
  void visit(Vec3 low, Vec3 high, Each&& each) const {
    for (std::size_t n = 0; n < nodes_.size();) {
      const Node& node = nodes_[n];
      if (!meets(node, low, high)) {
        n = node.next;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const auto& t = mesh_.triangles[order_[i]];
        const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
        if (inside_out_) each(a, c, b);
        else each(a, b, c);
      }
      ++n;
    }
  }

 private:
  struct Node {
    Vec3 low, high;
    std::uint32_t first = 0, count = 0;  ///< triangles; 0: the children follow
    std::uint32_t next = 0;              ///< the node after this one and all below it
  };
  static bool meets(const Node& node, Vec3 low, Vec3 high) {
    return node.low.x <= high.x && node.high.x >= low.x && node.low.y <= high.y && node.high.y >= low.y &&
           node.low.z <= high.z && node.high.z >= low.z;
  }
  void build(std::uint32_t first, std::uint32_t count);

  const TriangleMesh& mesh_;
  bool inside_out_ = false;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;  ///< depth first
};

}  // namespace sandlot::rigid
