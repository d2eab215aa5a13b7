#pragma once
/// Start poses of robot groups: given, in a grid, or drawn at random where there is room.
#include <optional>
#include <vector>

#include "formats/scenario/scenario.h"
#include "model/model.h"

namespace sandlot {

class Placer {
 public:
  /// @param world  what stands already; must outlive the placer's construction only
  Placer(const std::vector<model::Instance>& world, std::uint64_t seed);
  /// One pose per robot of the group. Random poses keep `clearance_m` from static shapes (seen from above) and
  /// from the origins of robots placed before; no room is an error.
  /// Time per robot does not grow with their number.
  Result<std::vector<Pose>> place(const formats::RobotGroup& group);
  /// Something else that stands in the world.
  void add(const model::Instance& instance);

 private:
  struct Obstacle {
    Pose X_WC;
    Vec3 half_m;  ///< half extents of the shape's box
    bool round = false;
  };
  struct Cells;
  bool free(const Cells& near, Vec3 point, double clearance_m) const;
  std::vector<Obstacle> obstacles_;
  std::vector<Vec3> placed_;
  std::uint64_t seed_;
};

/// The walls about the area of a distribution, as one static thing; null when it wants none.
std::optional<model::Instance> walls_of(const formats::RobotGroup& group);

}  // namespace sandlot
