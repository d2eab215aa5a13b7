/// Forged files of agents: those of small agents with bytes changed and the check sum made right again, or the input as it is. What is
/// refused leaves the agent as it was; what is taken goes on with finite motor values. The first byte chooses the agent, the second
/// whether the input itself is the file; then come changes of 4 bytes: where (16 bits), what, and with which value.
#include <cstring>
#include <limits>

#include "base/check.h"
#include "selforg/agent.h"

namespace {

using namespace sandlot;
using selforg::AgentSpec;
using selforg::WiredController;

constexpr std::size_t sensors = 3, motors = 2;
constexpr std::size_t head = 8 + 4 + 8;  // magic, version, check sum

AgentSpec spec_of(std::size_t which) {
  AgentSpec spec;
  static constexpr const char* kinds[] = {"sox",  "semox",    "dep",         "experts",
                                          "sine", "babbling", "braitenberg", "primitives"};
  spec.controller = kinds[which % 8];
  if (spec.controller == "primitives") {
    Node list = Node::sequence();
    for (const char* name : {"a", "b"}) {
      Node each = Node::map();
      each.set("name", Node::scalar(name));
      list.push(each);
    }
    spec.parameters = Node::map();
    spec.parameters.set("primitives", list);
    spec.parameters.set("bins", Node::scalar("2"));
  }
  if (which & 8)
    spec.wiring = {{"derivative", {}}, {"feedback", {}}, {"motor_noise", {}}, {"one_to_one", {}}};
  if ((which & 24) == 16) spec.wiring = {{"motor_noise", {}}};
  return spec;
}

std::unique_ptr<WiredController> agent_of(std::size_t which) {
  auto made = WiredController::make(sensors, motors, spec_of(which));
  SL_CHECK(made);
  return std::move(*made);
}

void step(WiredController& agent, int steps) {
  std::vector<double> x(sensors), y(motors);
  for (int k = 0; k < steps; ++k) {
    for (std::size_t i = 0; i < sensors; ++i)
      x[i] = 0.1 * static_cast<double>((k * 7 + static_cast<int>(i) * 3) % 11) - 0.5;
    agent.step(x, y);
    for (const double each : y) SL_CHECK(each >= -1 && each <= 1);
  }
}

void change(std::vector<std::byte>& bytes, std::size_t at, unsigned what, std::uint8_t value) {
  static constexpr double numbers[] = {0,
                                       -1,
                                       1e-300,
                                       1e50,
                                       1e300,
                                       -1e300,
                                       std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::quiet_NaN()};
  if (what % 3 == 0) bytes[at] = std::byte{value};
  else if (what % 3 == 1 && at + 8 <= bytes.size()) std::memcpy(&bytes[at], &numbers[value % 8], 8);
  else if (at + 8 <= bytes.size()) {
    const std::uint64_t number = value < 128 ? value : ~std::uint64_t{0} >> (value % 64);
    std::memcpy(&bytes[at], &number, 8);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t which = data[0] % 32;
  auto agent = agent_of(which);
  step(*agent, 15);
  std::vector<std::byte> bytes;
  if (data[1] & 1) {
    bytes.resize(size - 2);
    if (size > 2) std::memcpy(bytes.data(), data + 2, size - 2);
  } else {
    bytes = agent->stored();
    for (std::size_t i = 2; i + 4 <= size; i += 4)
      change(bytes, (data[i] | std::size_t{data[i + 1]} << 8) % bytes.size(), data[i + 2], data[i + 3]);
  }
  if (bytes.size() >= head) {
    const std::uint64_t sum = hash64(std::span(bytes).subspan(head));
    std::memcpy(&bytes[12], &sum, 8);
  }
  const auto before = agent->stored();
  if (const Status taken = agent->take_stored(bytes, "fuzz"); !taken) {
    SL_CHECK(!taken.error().what.empty());
    SL_CHECK(agent->stored() == before);
  }
  step(*agent, 5);
  return 0;
}
