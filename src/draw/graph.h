#pragma once
/// Directed graph as an SVG figure: layers from top to bottom, in which each edge leads downwards.
///
/// Layers   a node lies below all that lead to it; a node that nothing leads to lies just above the first that it leads to.
///          Edges of a cycle that would lead upwards are drawn upwards.
/// Order    within a layer by the medians of neighbours, which leaves few crossings. The same graph gives the same bytes.
/// Limits   of some dozens of nodes; larger ones become wide.
/// Source   K. Sugiyama, S. Tagawa, M. Toda, Methods for visual understanding of hierarchical system structures, IEEE Trans.
///          SMC 11 (1981).
#include <string>
#include <utility>
#include <vector>

namespace sandlot::draw {

struct Graph {
  enum class Form { ellipse, box };
  struct Node {
    std::string label;  ///< broken at / and _ into lines
    Form form = Form::ellipse;
    std::string fill = "#ffffff";
  };
  std::vector<Node> nodes;
  std::vector<std::pair<std::size_t, std::size_t>> edges;  ///< from, to
};

/// Layer of each node, 0 at the top.
std::vector<int> layers_of(const Graph& graph);

std::string draw_graph(const Graph& graph);

}  // namespace sandlot::draw
