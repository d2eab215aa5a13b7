#pragma once
/// Particles of a filter in the plane: their number by KLD-sampling, low-variance resampling, bins of poses and clusters
/// of bins.
///
/// Frame    particles are poses of the robot in the map M. Bins are 0.5 m x 0.5 m x 10 degrees.
/// Cost     linear in the number of particles; no allocation once the lists have grown.
/// Source   D. Fox, Adapting the sample size in particle filters through KLD-sampling (2003), eq. 7; S. Thrun, W. Burgard,
///          D. Fox, Probabilistic Robotics (2005), table 4.4.
#include <cstdint>
#include <span>
#include <vector>

#include "navigation/localisation/planar.h"

namespace sandlot::navigation::amcl {

struct Particle {
  Pose2 pose;  ///< X_MB
  double weight = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Position along x of the map."}, s.pose.x);
    visit(Field{"y", "m", "Position along y of the map."}, s.pose.y);
    visit(Field{"theta", "rad", "Heading."}, s.pose.theta);
    visit(Field{"weight", "1", "Weight; those of all particles add up to 1.", 0, 1}, s.weight);
  }
};

/// Number of particles with which, by `quantile` standard deviations, the Kullback-Leibler distance between the samples'
/// and the true distribution over `bins` occupied bins stays below `error`; 1 for a single bin. At most 1e9.
/// @param quantile  upper quantile of the standard normal distribution
double kld_particles(std::size_t bins, double error, double quantile);

/// Low-variance (systematic) resampling: which of the items each of `out.size()` draws takes, in ascending order. An item of
/// weight w is drawn floor(w n) or ceil(w n) times.
/// @param weights  not negative, of any positive sum
/// @param offset   random number in [0, 1)
void resample_low_variance(std::span<const double> weights, double offset, std::span<std::uint32_t> out);

/// Hash table of the bins that poses lie in, with the weight in each.
class PoseBins {
 public:
  /// @param most  number of poses that will be added at most between two clear()
  explicit PoseBins(std::size_t most);
  void clear();
  /// Index of the pose's bin among those occupied, in the order in which they were.
  std::uint32_t add(const Pose2& pose, double weight);
  std::size_t occupied() const { return bins_.size(); }

  /// Clusters: bins that touch, at faces, edges or corners. Bins lighter than a thousandth of the heaviest one belong
  /// to none: they would join clusters and widen them.
  struct Clusters {
    std::uint32_t count = 0;
    std::uint32_t best = 0;  ///< the one with the greatest weight
  };
  Clusters find_clusters();
  /// After find_clusters(); `none` for a bin of no cluster.
  std::uint32_t cluster_of(std::uint32_t bin) const { return bins_[bin].cluster; }
  static constexpr std::uint32_t none = 0xffffffff;

 private:
  struct Bin {
    std::int32_t x = 0, y = 0, turn = 0;
    std::uint32_t slot = 0, cluster = none;
    double weight = 0;
  };
  /// Slot of a bin, or the free one where it belongs.
  std::uint32_t slot_of(std::int32_t x, std::int32_t y, std::int32_t turn) const;
  std::vector<std::uint32_t> slots_;  ///< index of a bin plus one; 0: free
  std::vector<Bin> bins_;
  std::vector<std::uint32_t> open_;
};

}  // namespace sandlot::navigation::amcl
