/// Pairs of a round of a swiss tournament, by perfect matchings of the graph of pairings that are allowed.
#include <algorithm>
#include <numeric>

#include "base/check.h"
#include "run/tournament/schedule.h"

namespace sandlot::tournament {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

/// Graph whose vertices may be taken out, two at a time.
class Pairings {
 public:
  explicit Pairings(std::size_t vertices)
      : edges_(vertices, std::vector<bool>(vertices, false)), taken_(vertices, false) {}
  void allow(std::size_t a, std::size_t b) { edges_[a][b] = edges_[b][a] = true; }
  bool allowed(std::size_t a, std::size_t b) const { return !taken_[a] && !taken_[b] && edges_[a][b]; }
  void take(std::size_t a, std::size_t b) { taken_[a] = taken_[b] = true; }
  void put_back(std::size_t a, std::size_t b) { taken_[a] = taken_[b] = false; }
  bool taken(std::size_t a) const { return taken_[a]; }
  std::size_t size() const { return taken_.size(); }

  /// Whether all vertices that are left can be paired at once.
  /// Source   J. Edmonds, Paths, trees, and flowers (1965), in the form that contracts blossoms by their bases: O(V^3).
  bool can_pair_all() const { return Matching(*this).is_perfect(); }

 private:
  class Matching {
   public:
    explicit Matching(const Pairings& graph)
        : graph_(graph), mate_(graph.size(), none), parent_(graph.size()), base_(graph.size()) {}

    bool is_perfect() {
      for (std::size_t v = 0; v < graph_.size(); ++v)
        if (!graph_.taken(v) && mate_[v] == none && !augment(v)) return false;
      return true;
    }

   private:
    /// Base of the smallest blossom that holds both.
    std::size_t common_base(std::size_t a, std::size_t b) const {
      std::vector<bool> above(graph_.size(), false);
      for (;;) {
        a = base_[a];
        above[a] = true;
        if (mate_[a] == none) break;
        a = parent_[mate_[a]];
      }
      for (;;) {
        b = base_[b];
        if (above[b]) return b;
        b = parent_[mate_[b]];
      }
    }

    void mark(std::size_t v, std::size_t base, std::size_t child, std::vector<bool>& in_blossom) {
      while (base_[v] != base) {
        in_blossom[base_[v]] = in_blossom[base_[mate_[v]]] = true;
        parent_[v] = child;
        child = mate_[v];
        v = parent_[mate_[v]];
      }
    }

    void contract(std::size_t a, std::size_t b, std::vector<bool>& reached, std::vector<std::size_t>& queue) {
      const std::size_t base = common_base(a, b);
      std::vector<bool> in_blossom(graph_.size(), false);
      mark(a, base, b, in_blossom);
      mark(b, base, a, in_blossom);
      for (std::size_t v = 0; v < graph_.size(); ++v) {
        if (!in_blossom[base_[v]]) continue;
        base_[v] = base;
        if (reached[v]) continue;
        reached[v] = true;
        queue.push_back(v);
      }
    }

    /// Looks for a path from an unpaired vertex to another that exchanges pairs along it.
    bool augment(std::size_t root) {
      std::fill(parent_.begin(), parent_.end(), none);
      std::iota(base_.begin(), base_.end(), std::size_t{0});
      std::vector<bool> reached(graph_.size(), false);
      std::vector<std::size_t> queue{root};
      reached[root] = true;
      for (std::size_t head = 0; head < queue.size(); ++head) {
        const std::size_t v = queue[head];
        for (std::size_t to = 0; to < graph_.size(); ++to) {
          if (!graph_.allowed(v, to) || base_[v] == base_[to] || mate_[v] == to) continue;
          if (to == root || (mate_[to] != none && parent_[mate_[to]] != none)) {
            contract(v, to, reached, queue);
          } else if (parent_[to] == none) {
            parent_[to] = v;
            if (mate_[to] == none) return exchange(to), true;
            reached[mate_[to]] = true;
            queue.push_back(mate_[to]);
          }
        }
      }
      return false;
    }

    void exchange(std::size_t v) {
      while (v != none) {
        const std::size_t before = parent_[v], next = mate_[before];
        mate_[v] = before;
        mate_[before] = v;
        v = next;
      }
    }

    const Pairings& graph_;
    std::vector<std::size_t> mate_, parent_, base_;
  };

  std::vector<std::vector<bool>> edges_;
  std::vector<bool> taken_;
};

}  // namespace

std::vector<std::array<std::size_t, 2>> swiss_pairs(std::span<const std::size_t> ranked,
                                                    const std::vector<std::vector<int>>& met,
                                                    std::span<const int> byes) {
  const std::size_t teams = ranked.size(), places = teams + teams % 2;
  const auto meetings = [&](std::size_t i, std::size_t j) {  // by place; the bye is the last one
    return j == teams ? byes[ranked[i]] : met[ranked[i]][ranked[j]];
  };
  for (int most = 0;; ++most) {
    Pairings graph(places);
    bool all = true;
    for (std::size_t i = 0; i < places; ++i)
      for (std::size_t j = i + 1; j < places; ++j)
        if (meetings(i, j) <= most) graph.allow(i, j);
        else all = false;
    SL_CHECK(!all || graph.can_pair_all());
    if (!graph.can_pair_all()) continue;
    std::vector<std::array<std::size_t, 2>> out;
    for (std::size_t i = 0; i < places; ++i) {
      for (std::size_t j = i + 1; j < places && !graph.taken(i); ++j) {
        if (!graph.allowed(i, j)) continue;
        graph.take(i, j);
        if (graph.can_pair_all()) out.push_back({ranked[i], j == teams ? teams : ranked[j]});
        else graph.put_back(i, j);
      }
    }
    return out;
  }
}

}  // namespace sandlot::tournament
