#pragma once
/// Samples of RANSAC, and medians.
#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"

namespace sandlot::navigation::vo {

/// Middle one of the values (the upper of two), which are reordered; 0 of none.
double median(std::vector<double>& values);

/// `index.size()` different numbers below `count`. @pre count >= index.size()
void draw_distinct(Stream& random, std::uint32_t count, std::span<std::uint32_t> index);

/// End of RANSAC: after so many samples that one without outliers was among them with a probability of 0.9999, but no fewer than
/// `least`.
class RansacEnd {
 public:
  RansacEnd(int sample_size, int least, int most)
      : sample_size_(sample_size), least_(least), left_(most), most_(most) {}
  bool another() { return left_-- > 0; }
  /// @param share  of inliers, of the best sample until now
  void found(double share);

 private:
  int sample_size_, least_, left_, most_;
};

}  // namespace sandlot::navigation::vo
