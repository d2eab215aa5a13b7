/// Forged logs: a run of two robots is replayed with entries as the input says. A target is one of the real ones or what
/// stands in the input, the bytes are those of a real request or the input's.
#include "base/check.h"
#include "files/resources.h"
#include "record/replay.h"
#include "sim/load/load.h"

namespace {

using namespace sandlot;

std::vector<std::byte> real_snapshot() {
  Diagnostics diagnostics;
  const formats::Override overrides[] = {{"physics", "planar"}};
  auto setup = load(own_folder("scenarios") + "/indoor.yaml", {.overrides = overrides}, diagnostics);
  SL_CHECK_MSG(setup, setup.error().text().c_str());
  auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  SL_CHECK(simulation);
  return (*simulation)->snapshot();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::byte> snapshot = real_snapshot();
  static const char* const targets[] = {"robot",       "robot/drive",  "robot/drive/ideal",
                                        "robot/laser", "robot/wander", ""};
  static const char* const types[] = {"geometry_msgs/msg/Twist", "std_msgs/msg/Float64", ""};
  Diagnostics diagnostics;
  const auto programs = size && data[0] & 1 ? record::Programs::logged : record::Programs::recompute;
  auto replay = record::Replay::begin(snapshot, {.programs = programs}, diagnostics);
  SL_CHECK(replay);
  ByteReader in(std::as_bytes(std::span(data, size)));
  std::uint8_t first = 0;
  read(in, first);
  for (std::uint64_t tick = 1; tick <= 20 && in.ok() && in.remaining() > 0; ++tick) {
    record::RecordedTick recorded;
    recorded.tick = tick;
    std::uint8_t entries = 0;
    read(in, entries);
    for (int i = 0; i < entries % 4 && in.ok(); ++i) {
      LogEntry entry;
      std::uint8_t target = 0, type = 0, length = 0;
      read(in, entry.kind);
      read(in, entry.source.kind);
      read(in, target);
      read(in, type);
      read(in, length);
      entry.target = targets[target % std::size(targets)];
      entry.type = types[type % std::size(types)];
      const auto bytes = in.take(std::min<std::size_t>(length, in.remaining()));
      entry.bytes.assign(bytes.begin(), bytes.end());
      recorded.log.push_back(std::move(entry));
    }
    const auto difference = replay->tick(recorded);
    if (!difference) {
      SL_CHECK(!difference.error().text().empty());
      return 0;
    }
    if (*difference) SL_CHECK(!(*difference)->text().empty());
  }
  return 0;
}
