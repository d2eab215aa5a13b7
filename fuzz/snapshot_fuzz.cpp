/// Forged snapshots: those of real scenarios with bytes changed and the checksum made right again, so that everything
/// behind it is reached. The first byte chooses the scenario, the second whether the input itself is the snapshot;
/// then come changes of 5 bytes: where (24 bits), what, and with which value.
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/hash.h"
#include "files/resources.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"
#include "sim/world/snapshot.h"

namespace {

using sandlot::Diagnostics;
using sandlot::Simulation;

/// Devices and chains of noise that the scenarios leave out, and what watches them.
constexpr std::string_view devices_scenario = R"(version: 1
name: devices
physics: rigid
time: {step: 10 ms}
values:
  turn: abs(cart/joints.position[0])
events:
  - {name: turned, when: turn > 0.1, for: 0.1 s}
robots:
  - name: cart
    model: ../models/cart/model.sdf
    devices:
      compass: {kind: magnetometer}
      height:
        kind: altimeter
        position:
          - drift: {std: 0.1, correlation: 10 s}
          - latency: {delay: 30 ms, jitter: 10 ms}
          - dropouts: {rate: 2 %}
      joints: {kind: joint_state, noise: {position: [{quantise: {step: 0.01}}, {walk: {density: 0.1}}]}}
      odometry:
        {kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint, wheel_radius: 0.1,
         wheel_separation: 0.4}
      touch: {kind: contact}
    controller:
      kind: sequence
      steps:
        - {at: 0.1 s, orders: {left_motor: 20, right_motor: 10}}
)";

std::vector<std::vector<std::byte>> real_snapshots() {
  std::vector<std::vector<std::byte>> out;
  const std::string folder = sandlot::own_folder("scenarios");
  for (const auto& [file, engine] :
       {std::pair{"/indoor.yaml", "planar"}, std::pair{"/indoor.yaml", "rigid"},
        std::pair{"/fig1_robot.yaml", "rigid"}, std::pair{"/mario.yaml", "rigid"},
        std::pair{"/../tests/scenarios/all_devices.yaml", "rigid"}, std::pair{"/motor_ramp.yaml", "rigid"},
        std::pair{"/devices.yaml", "rigid"}}) {
    Diagnostics diagnostics;
    const sandlot::formats::Override overrides[] = {{"physics", engine}};
    sandlot::LoadOptions options{.overrides = overrides};
    if (std::string_view(file) == "/devices.yaml") options.text = devices_scenario;
    auto setup = sandlot::load(folder + file, options, diagnostics);
    SL_CHECK_MSG(setup, setup.error().text().c_str());
    auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
    SL_CHECK(simulation);
    for (int i = 0; i < 30; ++i) SL_CHECK((*simulation)->tick());
    out.push_back((*simulation)->snapshot());
  }
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
