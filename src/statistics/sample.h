#pragma once
/// Sample: count, mean and spread of numbers, without the numbers.
///
/// Source   B. P. Welford, Note on a method for calculating corrected sums of squares (1962).
/// Limits   numbers that are not finite are the caller's to leave out.
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sandlot::statistics {

class Sample {
 public:
  void add(double x) {
    ++count_;
    const double apart = x - mean_;
    mean_ += apart / static_cast<double>(count_);
    squares_ += apart * (x - mean_);
    min_ = count_ == 1 ? x : std::min(min_, x);
    max_ = count_ == 1 ? x : std::max(max_, x);
  }

  std::uint64_t count() const { return count_; }
  double mean() const { return mean_; }
  /// Unbiased; 0 for fewer than two numbers.
  double variance() const { return count_ < 2 ? 0 : squares_ / static_cast<double>(count_ - 1); }
  double deviation() const { return std::sqrt(variance()); }
  double min() const { return min_; }
  double max() const { return max_; }

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0, squares_ = 0, min_ = 0, max_ = 0;
};

}  // namespace sandlot::statistics
