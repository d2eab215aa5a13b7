#include "server/clients/duration_meter.h"

#include <algorithm>

namespace sandlot::server {
namespace {

/// Lower edges of the bins, and the upper edge of the last one.
const std::array<double, DurationMeter::bins + 1>& edges_s() {
  static const auto edges = [] {
    constexpr double ratio = 1.1220184543019633;  // 10^(1/20)
    std::array<double, DurationMeter::bins + 1> out{};
    double decade = DurationMeter::first_s;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const bool begins_decade = i % DurationMeter::bins_per_decade == 0;
      if (i > 0 && begins_decade) decade *= 10;
      out[i] = begins_decade ? decade : out[i - 1] * ratio;
    }
    return out;
  }();
  return edges;
}

/// Nearest rank of the 99th percentile: the smallest number of durations that are at least 99 % of all.
std::uint64_t rank_of_p99(std::uint64_t count) { return count - count / 100; }

}  // namespace

double DurationMeter::lower_edge_s(int bin) { return edges_s()[static_cast<std::size_t>(bin)]; }

void DurationMeter::add(double duration_s) {
  const auto& edges = edges_s();
  const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, duration_s);
  ++histogram_[static_cast<std::size_t>(above - edges.begin() - 1)];
  ++count_;
  sum_s_ += duration_s;
  last_s_ = duration_s;
  max_s_ = std::max(max_s_, duration_s);
  if (recent_.size() < most_recent) recent_.push_back(static_cast<float>(duration_s));
  else recent_[next_] = static_cast<float>(duration_s);
  next_ = (next_ + 1) % most_recent;
}

void DurationMeter::add(const DurationMeter& other) {
  for (std::size_t i = 0; i < histogram_.size(); ++i) histogram_[i] += other.histogram_[i];
  count_ += other.count_;
  sum_s_ += other.sum_s_;
  max_s_ = std::max(max_s_, other.max_s_);
  last_s_ = other.last_s_;
}

DurationMeter::Figures DurationMeter::recent() const {
  if (recent_.empty()) return {};
  std::vector<float> sorted = recent_;
  const auto rank = static_cast<std::ptrdiff_t>(rank_of_p99(sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + rank - 1, sorted.end());
  Figures out;
  out.count = sorted.size();
  out.last_s = last_s_;
  out.p99_s = static_cast<double>(sorted[static_cast<std::size_t>(rank - 1)]);
  for (const float each : sorted) {
    out.mean_s += static_cast<double>(each) / static_cast<double>(sorted.size());
    out.max_s = std::max(out.max_s, static_cast<double>(each));
  }
  return out;
}

DurationMeter::Figures DurationMeter::all() const {
  if (count_ == 0) return {};
  Figures out;
  out.count = count_;
  out.last_s = last_s_;
  out.mean_s = sum_s_ / static_cast<double>(count_);
  out.max_s = max_s_;
  const std::uint64_t rank = rank_of_p99(count_);
  std::uint64_t below = 0;
  for (int bin = 0; bin < bins; ++bin) {
    below += histogram_[static_cast<std::size_t>(bin)];
    if (below < rank) continue;
    out.p99_s = bin + 1 == bins ? max_s_ : std::min(max_s_, lower_edge_s(bin + 1));
    break;
  }
  return out;
}

}  // namespace sandlot::server
