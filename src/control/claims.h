#pragma once
/// Claims and reads: the actuators and readings that a controller looks up while it begins (Description::actuator, reading).
/// What it claims it may order; two active controllers of a robot that claim the same device would take turns in one tick, so a
/// switch refuses them. What it reads makes the topic graph (sim/watch/topic_graph.h).
///
/// Limits   a program that looks nothing up, and takes its orders from elsewhere, claims and reads nothing here.
#include <cstdint>
#include <vector>

namespace sandlot {

/// Notes during its life the indices, ascending, of the actuators and readings that descriptions give out on this thread. One
/// at a time.
class ClaimNotes {
 public:
  ClaimNotes(std::vector<std::uint32_t>& claimed, std::vector<std::uint32_t>& read);
  ~ClaimNotes();
  ClaimNotes(const ClaimNotes&) = delete;
  ClaimNotes& operator=(const ClaimNotes&) = delete;
};

}  // namespace sandlot
