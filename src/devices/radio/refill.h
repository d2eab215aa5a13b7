#pragma once
/// Refill: writes the list of a message anew, sample by sample, with the memory of its former entries.
#include <cstddef>
#include <utility>
#include <vector>

namespace sandlot {

template <class T>
class Refill {
 public:
  /// The next entry, to be written whole.
  T& next(std::vector<T>& list) {
    if (used_ == list.size()) {
      if (spare_.empty()) {
        list.emplace_back();
      } else {
        list.push_back(std::move(spare_.back()));
        spare_.pop_back();
      }
    }
    return list[used_++];
  }
  std::size_t used() const { return used_; }
  /// Cuts the list to the entries written, and begins again.
  void finish(std::vector<T>& list) {
    for (; list.size() > used_; list.pop_back()) spare_.push_back(std::move(list.back()));
    used_ = 0;
  }

 private:
  std::size_t used_ = 0;
  std::vector<T> spare_;
};

}  // namespace sandlot
