#include "navigation/localisation/particles.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/check.h"
#include "base/hash.h"

namespace sandlot::navigation::amcl {
namespace {

constexpr double particle_bin_m = 0.5;
constexpr std::int32_t particle_bins_per_turn = 36;
constexpr double particle_lightest_bin = 1e-3;  ///< of a cluster's bins, as a part of the heaviest one

std::int32_t particle_bin_index(double x_m) {
  return static_cast<std::int32_t>(std::clamp(std::floor(x_m / particle_bin_m), -2e9, 2e9));
}

}  // namespace

double kld_particles(std::size_t bins, double error, double quantile) {
  if (bins <= 1) return 1;
  const double k = static_cast<double>(bins) - 1, a = 2 / (9 * k), b = 1 - a + std::sqrt(a) * quantile;
  return std::min(1e9, std::ceil(k / (2 * error) * b * b * b));
}

void resample_low_variance(std::span<const double> weights, double offset, std::span<std::uint32_t> out) {
  SL_CHECK(!weights.empty() && weights.size() <= 0xffffffff);
  double sum = 0;
  for (const double w : weights) sum += w;
  const double step = sum / static_cast<double>(out.size());
  std::size_t i = 0, last = 0;  // last: the last item of any weight, for the rounding at the end
  for (std::size_t k = weights.size(); k-- > 0;)
    if (weights[k] > 0) {
      last = k;
      break;
    }
  double upto = weights[0];
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double at = (offset + static_cast<double>(k)) * step;
    while (at >= upto && i < last) upto += weights[++i];
    out[k] = static_cast<std::uint32_t>(i);
  }
}

PoseBins::PoseBins(std::size_t most) : slots_(std::bit_ceil(2 * most + 2)) {
  bins_.reserve(most);
  open_.reserve(most);
}

void PoseBins::clear() {
  for (const Bin& bin : bins_) slots_[bin.slot] = 0;
  bins_.clear();
}

std::uint32_t PoseBins::slot_of(std::int32_t x, std::int32_t y, std::int32_t turn) const {
  const std::uint64_t place = static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32 |
                              static_cast<std::uint32_t>(y);
  const std::uint64_t mask = slots_.size() - 1;
  std::uint64_t slot = hash_combine(place, static_cast<std::uint64_t>(turn)) & mask;
  while (slots_[slot] != 0) {
    const Bin& bin = bins_[slots_[slot] - 1];
    if (bin.x == x && bin.y == y && bin.turn == turn) break;
    slot = (slot + 1) & mask;
  }
  return static_cast<std::uint32_t>(slot);
}

std::uint32_t PoseBins::add(const Pose2& pose, double weight) {
  const std::int32_t x = particle_bin_index(pose.x), y = particle_bin_index(pose.y);
  const double part = math::wrap_angle(pose.theta) / math::tau + 0.5;  // [0, 1]
  const std::int32_t turn = std::min(static_cast<std::int32_t>(part * particle_bins_per_turn),
                                     particle_bins_per_turn - 1);
  const std::uint32_t slot = slot_of(x, y, turn);
  if (slots_[slot] == 0) {
    SL_CHECK(bins_.size() < slots_.size() / 2);
    bins_.push_back({x, y, turn, slot});
    slots_[slot] = static_cast<std::uint32_t>(bins_.size());
  }
  const std::uint32_t index = slots_[slot] - 1;
  bins_[index].weight += weight;
  return index;
}

PoseBins::Clusters PoseBins::find_clusters() {
  double heaviest = 0;
  for (Bin& bin : bins_) {
    bin.cluster = none;
    heaviest = std::max(heaviest, bin.weight);
  }
  const double least = particle_lightest_bin * heaviest;
  Clusters out;
  double best = -1;
  for (std::uint32_t first = 0; first < bins_.size(); ++first) {
    if (bins_[first].cluster != none || bins_[first].weight < least) continue;
    const std::uint32_t cluster = out.count++;
    double weight = 0;
    bins_[first].cluster = cluster;
    open_.assign(1, first);
    while (!open_.empty()) {
      const Bin bin = bins_[open_.back()];
      open_.pop_back();
      weight += bin.weight;
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dt = -1; dt <= 1; ++dt) {
            const std::int32_t turn = (bin.turn + dt + particle_bins_per_turn) % particle_bins_per_turn;
            const std::uint32_t entry = slots_[slot_of(bin.x + dx, bin.y + dy, turn)];
            if (entry == 0 || bins_[entry - 1].cluster != none || bins_[entry - 1].weight < least) continue;
            bins_[entry - 1].cluster = cluster;
            open_.push_back(entry - 1);
          }
    }
    if (weight > best) best = weight, out.best = cluster;
  }
  return out;
}

}  // namespace sandlot::navigation::amcl
