#include "physics/rigid/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace sandlot::rigid {

TriangleTree::TriangleTree(const TriangleMesh& mesh)
    : mesh_(mesh), inside_out_(mass_properties(mesh).volume_m3 < 0), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

void TriangleTree::build(std::uint32_t first, std::uint32_t count) {
  constexpr std::uint32_t leaf = 4;
  const std::size_t self = nodes_.size();
  Node node;
  node.low = node.high = mesh_.vertices[mesh_.triangles[order_[first]][0]];
  for (std::uint32_t i = first; i < first + count; ++i)
    for (const std::uint32_t v : mesh_.triangles[order_[i]])
      for (std::size_t k = 0; k < 3; ++k) {
        node.low[k] = std::min(node.low[k], mesh_.vertices[v][k]);
        node.high[k] = std::max(node.high[k], mesh_.vertices[v][k]);
      }
  if (count <= leaf) node.first = first, node.count = count;
  nodes_.push_back(node);
  if (count > leaf) {
    const Vec3 size = node.high - node.low;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = [&](std::uint32_t t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      return mesh_.vertices[a][axis] + mesh_.vertices[b][axis] + mesh_.vertices[c][axis];
    };
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count, [&](std::uint32_t s, std::uint32_t t) {
      const double x = middle(s), y = middle(t);
      return x != y ? x < y : s < t;
    });
    build(first, count / 2);
    build(first + count / 2, count - count / 2);
  }
  nodes_[self].next = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace sandlot::rigid
