#include "draw/graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "draw/plan.h"

namespace sandlot::draw {
namespace {

using Edge = std::pair<std::size_t, std::size_t>;

constexpr double font = 12, line_height = 15, letter_width = 0.56 * font, layer_gap = 34, node_gap = 10,
                 margin = 8;
constexpr std::size_t letters_per_line = 15;

/// Edges without those that close a cycle: found by a search in depth in the order of the nodes.
std::vector<Edge> downward_edges(const Graph& graph) {
  std::vector<std::vector<std::size_t>> next(graph.nodes.size());
  for (const auto& [from, to] : graph.edges) {
    SL_CHECK(from < graph.nodes.size() && to < graph.nodes.size());
    if (from != to) next[from].push_back(to);
  }
  enum class Mark { none, open, done };
  std::vector<Mark> marks(graph.nodes.size(), Mark::none);
  std::vector<Edge> out;
  struct Step {
    std::size_t node, child = 0;
  };
  for (std::size_t root = 0; root < graph.nodes.size(); ++root) {
    if (marks[root] != Mark::none) continue;
    std::vector<Step> stack{{root}};
    marks[root] = Mark::open;
    while (!stack.empty()) {
      Step& step = stack.back();
      if (step.child == next[step.node].size()) {
        marks[step.node] = Mark::done;
        stack.pop_back();
        continue;
      }
      const std::size_t from = step.node, to = next[from][step.child++];
      if (marks[to] == Mark::open) continue;
      out.emplace_back(from, to);
      if (marks[to] == Mark::none) {
        marks[to] = Mark::open;
        stack.push_back({to});
      }
    }
  }
  return out;
}

std::vector<int> layers_by(const std::vector<Edge>& edges, std::size_t count) {
  std::vector<int> layers(count, 0);
  // At most `count` rounds: the longest way has no more edges.
  for (bool moved = true; moved;) {
    moved = false;
    for (const auto& [from, to] : edges)
      if (layers[to] < layers[from] + 1) layers[to] = layers[from] + 1, moved = true;
  }
  // Those that lead somewhere go down as far as they can, so that edges are short.
  for (bool moved = true; moved;) {
    moved = false;
    std::vector<int> lowest(count, -1);
    for (const auto& [from, to] : edges)
      if (lowest[from] < 0 || layers[to] - 1 < lowest[from]) lowest[from] = layers[to] - 1;
    for (std::size_t i = 0; i < count; ++i)
      if (lowest[i] > layers[i]) layers[i] = lowest[i], moved = true;
  }
  return layers;
}

std::vector<std::string> label_lines(const std::string& label) {
  std::vector<std::string> parts(1);
  for (const char c : label) {
    parts.back() += c;
    if (c == '/' || c == '_') parts.emplace_back();
  }
  if (parts.back().empty()) parts.pop_back();
  std::vector<std::string> out(1);
  for (const std::string& part : parts) {
    if (!out.back().empty() && out.back().size() + part.size() > letters_per_line) out.emplace_back();
    out.back() += part;
  }
  return out;
}

/// A node of the graph, or where a long edge passes a layer.
struct GraphPlace {
  std::size_t node = ~std::size_t{0};  ///< ~0: an edge passes
  std::vector<std::string> lines;
  double width = 14, height = 0;
  double x = 0;                       ///< of the middle
  std::vector<std::size_t> up, down;  ///< neighbours in the layers above and below
};

struct Layout {
  std::vector<GraphPlace> places;
  std::vector<std::vector<std::size_t>> layers;  ///< places from left to right
  std::vector<std::vector<std::size_t>> ways;    ///< of each edge that leads down, its places
};

Layout make_layout(const Graph& graph, const std::vector<Edge>& edges, const std::vector<int>& layer) {
  Layout out;
  const int last = graph.nodes.empty() ? 0 : *std::max_element(layer.begin(), layer.end());
  out.layers.resize(static_cast<std::size_t>(last) + 1);
  const auto put = [&](int at, GraphPlace place) {
    out.places.push_back(std::move(place));
    out.layers[static_cast<std::size_t>(at)].push_back(out.places.size() - 1);
    return out.places.size() - 1;
  };
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    GraphPlace place{i, label_lines(graph.nodes[i].label)};
    std::size_t longest = 0;
    for (const std::string& line : place.lines) longest = std::max(longest, line.size());
    const bool round = graph.nodes[i].form == Graph::Form::ellipse;
    const double text = static_cast<double>(longest) * letter_width,
                 height = line_height * static_cast<double>(place.lines.size());
    // An ellipse around a box of text is sqrt(2) as wide and high; letters leave its corners free.
    place.width = round ? 1.25 * text + 14 : text + 12;
    place.height = round ? 1.25 * height + 8 : height + 8;
    put(layer[i], std::move(place));
  }
  for (const auto& [from, to] : edges) {
    std::vector<std::size_t>& way = out.ways.emplace_back();
    way.push_back(from);
    for (int at = layer[from] + 1; at < layer[to]; ++at) way.push_back(put(at, {}));
    way.push_back(to);
    for (std::size_t i = 1; i < way.size(); ++i) {
      out.places[way[i - 1]].down.push_back(way[i]);
      out.places[way[i]].up.push_back(way[i - 1]);
    }
  }
  return out;
}

/// Orders the layers by the means of the neighbours' places, downwards and upwards in turn.
void order_layers(Layout& layout) {
  std::vector<double> rank(layout.places.size());
  const auto number = [&](const std::vector<std::size_t>& layer) {
    for (std::size_t i = 0; i < layer.size(); ++i)
      rank[layer[i]] = static_cast<double>(i) - static_cast<double>(layer.size()) / 2;
  };
  for (const auto& layer : layout.layers) number(layer);
  for (int round = 0; round < 24; ++round) {
    const bool down = round % 2 == 0;
    for (std::size_t k = 0; k < layout.layers.size(); ++k) {
      auto& layer = layout.layers[down ? k : layout.layers.size() - 1 - k];
      std::vector<double> wanted(layout.places.size());
      for (const std::size_t p : layer) {
        const auto& neighbours = down ? layout.places[p].up : layout.places[p].down;
        double sum = 0;
        for (const std::size_t n : neighbours) sum += rank[n];
        wanted[p] = neighbours.empty() ? rank[p] : sum / static_cast<double>(neighbours.size());
      }
      std::stable_sort(layer.begin(), layer.end(),
                       [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
      number(layer);
    }
  }
}

/// Places as near to the means of their neighbours as order and widths allow.
void place_layers(Layout& layout) {
  auto& places = layout.places;
  const auto apart = [&](std::size_t a, std::size_t b) {
    return (places[a].width + places[b].width) / 2 + node_gap;
  };
  for (const auto& layer : layout.layers) {
    double x = 0;
    for (std::size_t i = 0; i < layer.size(); ++i)
      places[layer[i]].x = x += i ? apart(layer[i - 1], layer[i]) : 0;
    for (const std::size_t p : layer) places[p].x -= x / 2;
  }
  for (int round = 0; round < 60; ++round)
    for (const auto& layer : layout.layers) {
      std::vector<double> wanted;
      for (const std::size_t p : layer) {
        double sum = 0, count = 0;
        for (const auto* const side : {&places[p].up, &places[p].down})
          for (const std::size_t n : *side) sum += places[n].x, ++count;
        wanted.push_back(count > 0 ? sum / count : places[p].x);
      }
      // Least squares under the distances: what violates them is pooled (isotonic regression of the wanted place less the
      // distance from the left end).
      struct Pool {
        double sum, count;
      };
      std::vector<Pool> pools;
      std::vector<double> offset(layer.size(), 0);
      for (std::size_t i = 0; i < layer.size(); ++i) {
        if (i > 0) offset[i] = offset[i - 1] + apart(layer[i - 1], layer[i]);
        pools.push_back({wanted[i] - offset[i], 1});
        while (pools.size() > 1) {
          const Pool last = pools.back();
          Pool& before = pools[pools.size() - 2];
          if (before.sum / before.count <= last.sum / last.count) break;
          before.sum += last.sum, before.count += last.count;
          pools.pop_back();
        }
      }
      std::size_t i = 0;
      for (const Pool& pool : pools)
        for (double n = 0; n < pool.count; ++n, ++i) places[layer[i]].x = pool.sum / pool.count + offset[i];
    }
}

}  // namespace

std::vector<int> layers_of(const Graph& graph) {
  return layers_by(downward_edges(graph), graph.nodes.size());
}

std::string draw_graph(const Graph& graph) {
  const std::vector<Edge> edges = downward_edges(graph);
  Layout layout = make_layout(graph, edges, layers_by(edges, graph.nodes.size()));
  order_layers(layout);
  place_layers(layout);
  auto& places = layout.places;

  double low = 0, high = 0, y = margin;
  for (const GraphPlace& place : places)
    low = std::min(low, place.x - place.width / 2), high = std::max(high, place.x + place.width / 2);
  std::vector<double> middle(places.size());
  for (const auto& layer : layout.layers) {
    double height = 0;
    for (const std::size_t p : layer) height = std::max(height, places[p].height);
    for (const std::size_t p : layer) middle[p] = y + height / 2, places[p].x += margin - low;
    y += height + layer_gap;
  }
  const double width = high - low + 2 * margin, height = std::max(y - layer_gap, 0.0) + margin;

  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"{2:.0f}\" "
      "fill=\"#222222\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n"
      "<marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" "
      "orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" fill=\"#666666\"/></marker>\n",
      width, height, font);
  const auto curve = [&](double x0, double y0, double x1, double y1) {
    const double bend = (y1 - y0) / 2;
    return fmt::format("C{:.1f} {:.1f} {:.1f} {:.1f} {:.1f} {:.1f}", x0, y0 + bend, x1, y1 - bend, x1, y1);
  };
  constexpr const char* stroke =
      "fill=\"none\" stroke=\"#666666\" stroke-width=\"1.2\" marker-end=\"url(#tip)\"";
  for (const auto& way : layout.ways) {
    double x0 = places[way[0]].x, y0 = middle[way[0]] + places[way[0]].height / 2;
    std::string path = fmt::format("M{:.1f} {:.1f}", x0, y0);
    for (std::size_t i = 1; i < way.size(); ++i) {
      const double x1 = places[way[i]].x, y1 = middle[way[i]] - places[way[i]].height / 2;
      path += curve(x0, y0, x1, y1);
      x0 = x1, y0 = y1;
    }
    out += fmt::format("<path d=\"{}\" {}/>\n", path, stroke);
  }
  for (const Edge& edge : graph.edges) {
    const auto& [from, to] = edge;
    if (from == to || std::find(edges.begin(), edges.end(), edge) != edges.end()) continue;
    const double x0 = places[from].x + places[from].width / 2, x1 = places[to].x + places[to].width / 2;
    out += fmt::format("<path d=\"M{:.1f} {:.1f}C{:.1f} {:.1f} {:.1f} {:.1f} {:.1f} {:.1f}\" {}/>\n", x0,
                       middle[from], x0 + 40, middle[from], x1 + 40, middle[to], x1, middle[to], stroke);
  }
  for (std::size_t p = 0; p < graph.nodes.size(); ++p) {
    const GraphPlace& place = places[p];
    const Graph::Node& node = graph.nodes[p];
    const double x = place.x, at = middle[p];
    out += node.form == Graph::Form::ellipse
               ? fmt::format("<ellipse cx=\"{:.1f}\" cy=\"{:.1f}\" rx=\"{:.1f}\" ry=\"{:.1f}\"", x, at,
                             place.width / 2, place.height / 2)
               : fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"",
                             x - place.width / 2, at - place.height / 2, place.width, place.height);
    out += fmt::format(" fill=\"{}\" stroke=\"#444444\"/>\n", xml_text(node.fill));
    double line = at - line_height * static_cast<double>(place.lines.size()) / 2 + font - 0.5;
    for (const std::string& text : place.lines) {
      out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x, line,
                         xml_text(text));
      line += line_height;
    }
  }
  return out + "</svg>\n";
}

}  // namespace sandlot::draw
