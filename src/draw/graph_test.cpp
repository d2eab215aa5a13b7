#include "draw/graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

namespace sandlot::draw {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Graph graph_of(std::size_t nodes, std::vector<std::pair<std::size_t, std::size_t>> edges) {
  Graph out;
  for (std::size_t i = 0; i < nodes; ++i) out.nodes.push_back({"n" + std::to_string(i)});
  out.edges = std::move(edges);
  return out;
}

/// Middle and half size of each node, by its label of one line.
struct Drawn {
  double x, y, half_width;
};
std::map<std::string, Drawn> drawn(const std::string& svg) {
  std::map<std::string, Drawn> out;
  for (std::size_t at = 0; (at = svg.find("<ellipse cx=\"", at)) != std::string::npos; ++at) {
    Drawn node{};
    double half_height = 0;
    EXPECT_EQ(std::sscanf(svg.c_str() + at, "<ellipse cx=\"%lf\" cy=\"%lf\" rx=\"%lf\" ry=\"%lf\"", &node.x,
                          &node.y, &node.half_width, &half_height),
              4);
    const std::size_t text = svg.find("\"middle\">", at) + 9;
    out[svg.substr(text, svg.find('<', text) - text)] = node;
  }
  return out;
}

TEST(Graph, LiesInLayersThatEdgesLeadDown) {
  // 0 -> 1 -> 2 -> 3 and 4 -> 3: the longest way has three edges, and 4 moves down to just above what it leads to.
  EXPECT_THAT(layers_of(graph_of(5, {{0, 1}, {1, 2}, {2, 3}, {4, 3}})), ElementsAre(0, 1, 2, 3, 2));
  // A leaf stays high: 1 leads nowhere.
  EXPECT_THAT(layers_of(graph_of(4, {{0, 1}, {0, 2}, {2, 3}})), ElementsAre(0, 1, 1, 2));
  // A cycle ends: the edge that closes it is drawn upwards.
  EXPECT_THAT(layers_of(graph_of(3, {{0, 1}, {1, 2}, {2, 0}, {1, 1}})), ElementsAre(0, 1, 2));
  EXPECT_TRUE(layers_of({}).empty());
}

TEST(Graph, NodesOfALayerDoNotOverlapAndNeighboursLieInOrder) {
  // Two fans whose leaves are listed mixed: without an order of the layer their edges cross.
  const std::string svg = draw_graph(graph_of(8, {{0, 2}, {1, 3}, {0, 4}, {1, 5}, {0, 6}, {1, 7}}));
  const auto nodes = drawn(svg);
  ASSERT_EQ(nodes.size(), 8u);
  const bool first_left = nodes.at("n0").x < nodes.at("n1").x;
  for (const char* const of_0 : {"n2", "n4", "n6"})
    for (const char* const of_1 : {"n3", "n5", "n7"})
      EXPECT_EQ(nodes.at(of_0).x < nodes.at(of_1).x, first_left) << of_0 << " " << of_1;
  for (const auto& [a, first] : nodes) {
    EXPECT_GT(first.x - first.half_width, 0);
    for (const auto& [b, second] : nodes)
      if (a < b && first.y == second.y) {
        EXPECT_GE(std::abs(first.x - second.x), first.half_width + second.half_width + 9.8) << a << " " << b;
      }
  }
  // A parent stands over the middle of its leaves.
  EXPECT_NEAR(nodes.at("n0").x, (nodes.at("n2").x + nodes.at("n4").x + nodes.at("n6").x) / 3, 1);
}

TEST(Graph, DrawsFormsLinesAndArrows) {
  Graph graph = graph_of(2, {{0, 1}, {1, 0}});
  graph.nodes[0] = {"servo1_position_controller/command <1>", Graph::Form::box, "#d6eaf8"};
  const std::string svg = draw_graph(graph);
  EXPECT_THAT(svg, HasSubstr("fill=\"#d6eaf8\""));
  for (const char* const line : {">servo1_<", ">position_<", ">controller/<", ">command &lt;1&gt;<"})
    EXPECT_THAT(svg, HasSubstr(line));
  std::size_t arrows = 0;
  for (std::size_t at = 0; (at = svg.find("marker-end", at)) != std::string::npos; ++at) ++arrows;
  EXPECT_EQ(arrows, 2u);  // there, and back
  EXPECT_EQ(svg, draw_graph(graph));
  EXPECT_THAT(draw_graph({}), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace sandlot::draw
