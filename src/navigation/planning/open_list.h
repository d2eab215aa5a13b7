#pragma once
/// Open list of a best-first search: a heap with four children per node.
///
/// Ties     keys are compared in steps of 2^-24 (6e-8), so that sums which differ by rounding alone are equal;
///          then the least heuristic (nearest to the goal), then the least item: one order everywhere.
/// Cost     push and pop: logarithm to base 4, comparisons without branches. A binary heap of doubles visits up
///          to four times as many cells of an open map, since rounding orders its ties.
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sandlot::navigation {

class OpenList {
 public:
  struct Entry {
    std::uint64_t key;
    std::uint64_t tie;
    std::uint32_t item() const { return static_cast<std::uint32_t>(tie); }
  };
  /// @param cost       so far; together with the heuristic in [0, 1e11]
  /// @param heuristic  estimate of the rest
  static Entry entry(double cost, double heuristic, std::uint32_t item) {
    constexpr double steps = 1 << 24, most = 4e9;
    return {static_cast<std::uint64_t>((cost + heuristic) * steps),
            static_cast<std::uint64_t>(heuristic * 16 < most ? heuristic * 16 : most) << 32 | item};
  }
  bool empty() const { return heap_.empty(); }
  void push(Entry entry) {
    std::size_t at = heap_.size();
    heap_.push_back(entry);
    while (at > 0) {
      const std::size_t up = (at - 1) / 4;
      if (!before(entry, heap_[up])) break;
      heap_[at] = heap_[up];
      at = up;
    }
    heap_[at] = entry;
  }
  /// @pre  not empty
  Entry pop() {
    const Entry top = heap_.front(), last = heap_.back();
    heap_.pop_back();
    if (heap_.empty()) return top;
    std::size_t at = 0;
    for (;;) {
      const std::size_t first = 4 * at + 1;
      if (first >= heap_.size()) break;
      const std::size_t end = first + 4 < heap_.size() ? first + 4 : heap_.size();
      std::size_t best = first;
      for (std::size_t k = first + 1; k < end; ++k) best = before(heap_[k], heap_[best]) ? k : best;
      if (!before(heap_[best], last)) break;
      heap_[at] = heap_[best];
      at = best;
    }
    heap_[at] = last;
    return top;
  }

 private:
  static bool before(const Entry& a, const Entry& b) {
    return static_cast<bool>(static_cast<int>(a.key < b.key) |
                             (static_cast<int>(a.key == b.key) & static_cast<int>(a.tie < b.tie)));
  }
  std::vector<Entry> heap_;
};

}  // namespace sandlot::navigation
