#pragma once
/// Claims: the actuators that a controller looks up while it begins (Description::actuator). What it claims it may order; two
/// active controllers of a robot that claim the same device would take turns in one tick, so a switch refuses them.
///
/// Limits   a program that looks nothing up, and takes its orders from elsewhere, claims nothing here.
#include <cstdint>
#include <vector>

namespace sandlot {

/// Notes during its life the indices, ascending, of the actuators that descriptions give out on this thread. One at a time.
class ClaimNotes {
 public:
  explicit ClaimNotes(std::vector<std::uint32_t>& out);
  ~ClaimNotes();
  ClaimNotes(const ClaimNotes&) = delete;
  ClaimNotes& operator=(const ClaimNotes&) = delete;
};

}  // namespace sandlot
