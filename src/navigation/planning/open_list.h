#pragma once
/// Open list of a best-first search: a heap with four children per node, which a search of 10^6 cells goes
/// through with half the cache misses of a binary one.
///
/// Ties     least key, then least heuristic (nearest to the goal), then least item: one order everywhere.
/// Cost     push and pop: logarithm to base 4.
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sandlot::navigation {

class OpenList {
 public:
  struct Entry {
    double key;       ///< cost so far + heuristic
    float heuristic;  ///< decides ties only
    std::uint32_t item;
  };
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
      for (std::size_t k = first + 1; k < end; ++k)
        if (before(heap_[k], heap_[best])) best = k;
      if (!before(heap_[best], last)) break;
      heap_[at] = heap_[best];
      at = best;
    }
    heap_[at] = last;
    return top;
  }

 private:
  static bool before(const Entry& a, const Entry& b) {
    if (a.key != b.key) return a.key < b.key;
    if (a.heuristic != b.heuristic) return a.heuristic < b.heuristic;
    return a.item < b.item;
  }
  std::vector<Entry> heap_;
};

}  // namespace sandlot::navigation
