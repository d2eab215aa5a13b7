#pragma once
/// Format of snapshots. Simulation::snapshot() writes them, Simulation::restore() reads them.
///
/// Layout   magic, version u32, profile text; blocks, each after its length as u64: the Model (setup, instances in
///          creation order, their serial numbers), the run's own State, the State of each medium and rule, then of each entity,
///          its devices and its programs; a checksum u64 of everything before it. Little-endian.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "base/time.h"
#include "model/model.h"

namespace sandlot {

inline constexpr std::array<char, 8> snapshot_magic{'S', 'A', 'N', 'D', 'L', 'O', 'T', 'S'};
inline constexpr std::uint32_t snapshot_version = 10;

/// Whether the bytes begin as a snapshot does; the rest may still be damaged.
bool is_snapshot(std::span<const std::byte> bytes);

struct SnapshotInfo {
  std::uint32_t version = 0;
  std::string profile;  ///< numeric profile it was taken with
  model::Setup setup;   ///< with the instances that were there
  Time now;
  std::uint64_t tick = 0;
  std::uint64_t revision = 0;
};
/// Checks the whole of it, but builds nothing. Errors: foreign, another version, damaged.
Result<SnapshotInfo> examine_snapshot(std::span<const std::byte> bytes);

}  // namespace sandlot
