#include "navigation/visual_odometry/sampling.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::navigation::vo {

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void draw_distinct(Stream& random, std::uint32_t count, std::span<std::uint32_t> index) {
  for (std::size_t i = 0; i < index.size();) {
    index[i] = random.below(count);
    if (std::find(index.begin(), index.begin() + static_cast<std::ptrdiff_t>(i), index[i]) ==
        index.begin() + static_cast<std::ptrdiff_t>(i))
      ++i;
  }
}

void RansacEnd::found(double share) {
  double all_good = 1;
  for (int i = 0; i < sample_size_; ++i) all_good *= share;
  // ln 0.0001 = -9.21
  const double needed = all_good < 1e-6 ? most_ : all_good > 0.999 ? 1 : -9.21 / math::log(1 - all_good);
  const int done = most_ - left_;
  left_ = std::min(left_,
                   std::max(static_cast<int>(std::min<double>(most_, std::ceil(needed))), least_) - done);
}

}  // namespace sandlot::navigation::vo
