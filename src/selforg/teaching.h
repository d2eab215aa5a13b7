#pragma once
/// Cross-motor teaching: motors teach each other, so that a robot moves in a coordinated way with one bit of knowledge per motor.
///
/// Each step, motor i with sources is taught the mean of its sources' last values, if that mean is at least `threshold` in size;
/// motors without sources, or below it, keep their own values.
///
/// Source   G. Martius, thesis, section 5.2; facts/lpzrobots.md section 7. The original divides by the number of sources twice;
///          here it is the mean. For single sources both are the same.
#include <cmath>
#include <span>
#include <vector>

#include "selforg/controller.h"

namespace sandlot::selforg {

class CrossMotorTeaching {
 public:
  /// @param sources  of each motor: indices of the motors that teach it
  static Result<CrossMotorTeaching> make(std::vector<std::vector<std::size_t>> sources,
                                         double threshold = 0.4);
  /// Connection by a permutation: motor i is taught by motor permutation[i].
  static Result<CrossMotorTeaching> permutation(std::span<const std::size_t> permutation,
                                                double threshold = 0.4);
  /// Call before the controller's step. No heap.
  void teach(Teachable& controller);

 private:
  std::vector<std::vector<std::size_t>> sources_;
  std::vector<double> taught_;
  double threshold_ = 0.4;
};

}  // namespace sandlot::selforg
