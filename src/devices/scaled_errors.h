#pragma once
/// Factors on the errors of the devices of a pool that come from outside: the world's and the robot's
/// sliders.
///
/// A device keeps its own factor (`errors` in its spec, tunable); while a phase runs, the product of all
/// stands in its place. Specs that devices share are exchanged for a scaled copy meanwhile, never written.
///
/// Cost     nothing while all factors are 1.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "devices/shared_spec.h"

namespace sandlot {

inline constexpr double max_errors = 1000;  ///< most that all factors together are

template <class Device>
class ScaledErrors {
 public:
  using Spec = typename Device::Spec;
  static constexpr bool exist = requires(Spec s) { s.errors; };  ///< the kind has errors
  static constexpr bool shared = shares_spec<Device>;
  using Held = std::conditional_t<shared, SharedSpec<Spec>, Spec>;
  using Own = std::conditional_t<shared, SharedSpec<Spec>, double>;

  void add(double factor) {
    if constexpr (exist) factors_.push_back(1), set(factors_.size() - 1, factor);
  }
  void remove(std::size_t index) {
    if constexpr (exist) set(index, 1), factors_.erase(factors_.begin() + static_cast<std::ptrdiff_t>(index));
  }
  void set(std::size_t index, double factor) {
    if constexpr (!exist) return;
    scaled_ += (factor != 1 ? 1 : 0) - (factors_[index] != 1 ? 1 : 0);
    factors_[index] = factor;
  }

  /// Runs `work` with the product of all factors in the place of each due device's own.
  template <class Work>
  void run(std::vector<Device>& devices, std::span<const std::uint32_t> due, const Work& work) {
    if constexpr (exist) {
      if (scaled_ > 0) {
        own_.clear();
        for (const std::uint32_t i : due) own_.push_back(take(devices[i].spec, factors_[i]));
        work();
        for (std::size_t i = 0; i < own_.size(); ++i) give_back(devices[due[i]].spec, own_[i]);
        own_.clear();
        return;
      }
    }
    work();
  }

  /// Multiplies the spec's value and returns the original one.
  Own take(Held& held, double factor) {
    if constexpr (shared) {
      Own own = held;
      if (factor == 1) return own;
      if (!source_ || !source_->is_same(own) || by_ != factor) {
        Spec spec = *own;
        spec.errors = std::min(max_errors, spec.errors * factor);
        scaled_copy_.emplace(std::move(spec));
        source_ = own;
        by_ = factor;
      }
      held = *scaled_copy_;
      return own;
    } else {
      return std::exchange(held.errors, std::min(max_errors, held.errors * factor));
    }
  }
  static void give_back(Held& held, const Own& own) {
    if constexpr (shared) held = own;
    else held.errors = own;
  }

 private:
  std::vector<double> factors_;  ///< per device
  std::vector<Own> own_;
  std::size_t scaled_ = 0;  ///< how many factors are not 1
  // The latest scaled copy of a shared spec: most devices of a pool are declared alike and have one factor.
  std::optional<SharedSpec<Spec>> source_, scaled_copy_;
  double by_ = 1;
};

}  // namespace sandlot
