/// Forged snapshots: those of small worlds with bytes changed and the checksum made right again, so that everything behind
/// it is reached. The first byte chooses the world, the second whether the input itself is the snapshot; then come changes
/// of 5 bytes: where (24 bits), what, and with which value.
#include <cstring>
#include <limits>

#include "base/hash.h"
#include "sim/world/snapshot.h"
#include "small_worlds.h"

namespace {

using sandlot::Diagnostics;
using sandlot::Simulation;

std::vector<std::vector<std::byte>> real_snapshots() {
  std::vector<std::vector<std::byte>> out;
  for (const auto& world : sandlot::fuzz::small_worlds) out.push_back(sandlot::fuzz::small_snapshot(world));
  return out;
}

void change(std::vector<std::byte>& bytes, std::size_t at, unsigned what, std::uint8_t value) {
  static constexpr double numbers[] = {0,
                                       -1,
                                       1e-300,
                                       1e18,
                                       1e300,
                                       -1e300,
                                       std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::quiet_NaN()};
  if (what % 3 == 0) {
    bytes[at] = std::byte{value};
  } else if (what % 3 == 1 && at + 8 <= bytes.size()) {
    std::memcpy(&bytes[at], &numbers[value % 8], 8);
  } else if (at + 4 <= bytes.size()) {
    const std::uint32_t number = value < 128 ? value : ~0u >> (value % 32);
    std::memcpy(&bytes[at], &number, 4);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto bases = real_snapshots();
  if (size < 2) return 0;
  std::vector<std::byte> bytes;
  if (data[1] & 1) {
    bytes.resize(size - 2);
    if (size > 2) std::memcpy(bytes.data(), data + 2, size - 2);
  } else {
    bytes = bases[data[0] % bases.size()];
    for (std::size_t i = 2; i + 5 <= size; i += 5) {
      const std::size_t at = data[i] | std::size_t{data[i + 1]} << 8 | std::size_t{data[i + 2]} << 16;
      change(bytes, at % bytes.size(), data[i + 3], data[i + 4]);
    }
  }
  if (bytes.size() >= 8) {
    const std::uint64_t checksum = sandlot::hash64(std::span(bytes).first(bytes.size() - 8));
    std::memcpy(&bytes[bytes.size() - 8], &checksum, 8);
  }
  const auto examined = sandlot::examine_snapshot(bytes);
  // A forged setup may ask for a library of controllers, a fine mesh, or millions of sub-steps: not what is tested.
  if (examined && (!examined->setup.plugins.empty() || examined->setup.substeps > 10)) return 0;
  Diagnostics diagnostics;
  auto restored = Simulation::restore(bytes, {}, diagnostics);
  if (!restored) {
    SL_CHECK(!restored.error().text().empty());
    return 0;
  }
  SL_CHECK(examined);
  for (int i = 0; i < 3; ++i)
    if (!(*restored)->tick()) return 0;
  (*restored)->snapshot();
  return 0;
}
