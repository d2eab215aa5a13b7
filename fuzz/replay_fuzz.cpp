/// Forged logs: the run of a robot and a ball is replayed with entries as the input says. A target is one of the real ones
/// or none; the bytes are the input's, or those of a real request of each kind with some of them changed.
#include "messages/messages.h"
#include "record/replay.h"
#include "small_worlds.h"

namespace {

using namespace sandlot;

constexpr fuzz::SmallWorld world{"replay", "planar", R"(
things: [{name: ball, model: msl_ball, pose: [0.3, 0, 0.11]}]
robots:
  - name: robot
    model: scout
    controller: {kind: diffusion}
    devices:
      odometry: {kind: wheel_odometry, left_joint: left_joint, right_joint: right_joint, wheel_radius: 0.03,
                 wheel_separation: 0.108}
)"};

struct RealRequest {
  std::uint8_t kind = 0;
  std::string target, type;
  std::vector<std::byte> bytes;
};

std::vector<RealRequest> real_requests() {
  model::Instance ball = fuzz::small_setup(world).instances.back();
  for (const model::Instance& each : fuzz::small_setup(world).instances)
    if (each.name == "ball") ball = each;
  ball.name = "other";
  msg::Twist twist;
  twist.linear.x = 0.1;
  ByteWriter command;
  write(command, twist);
  const Request all[] = {CommandRequest{"robot/drive", msg::Twist::ros_type, command.buffer()},
                         ParameterRequest{"robot/ring", "errors", Node::scalar("2")},
                         ParameterRequest{"robot/drive", "failure", Node::scalar("dead")},
                         LevelRequest{"robot/drive", {"contact"}},
                         SpawnRequest{ball},
                         DeleteRequest{"ball"},
                         PoseRequest{"ball", {{1, 0, 0.11}, {}}},
                         SampleRequest{"robot/ring"},
                         LoadDeviceRequest{"robot", {.name = "truth", .kind = "ground_truth"}},
                         UnloadDeviceRequest{"robot/drive"},
                         PullRequest{"ball", "", {}, {0, 0, 1}, Time::from_s(1)},
                         CallRequest{"robot/odometry", "reset", {}},
                         VelocityRequest{"ball", {{1, 0, 0}, {0, 0, 2}}},
                         InfoRequest{"ball", {model::Category::object, "a ball", {"red"}}}};
  std::vector<RealRequest> out;
  for (const Request& request : all) {
    RealRequest real{static_cast<std::uint8_t>(request.index()), request_target(request), "", {}};
    ByteWriter w;
    write_request(w, request);
    real.bytes = std::move(w.buffer());
    if (const auto* given = std::get_if<CommandRequest>(&request))
      real.type = given->type, real.bytes = given->bytes;
    out.push_back(std::move(real));
  }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t most_ticks = 6;
  constexpr std::uint8_t of_real =
      0x40;  ///< in place of a kind: a real request, with changes of two bytes each
  static const std::vector<std::byte> snapshot = fuzz::small_snapshot(world);
  static const std::vector<RealRequest> real = real_requests();
  static const char* const targets[] = {
      "robot", "robot/drive", "robot/drive/ideal", "robot/ring", "robot/odometry", "robot/controller", "ball",
      ""};
  static const char* const types[] = {"geometry_msgs/msg/Twist", "std_msgs/msg/Float64", ""};
  Diagnostics diagnostics;
  const auto programs = size && data[0] & 1 ? record::Programs::logged : record::Programs::recompute;
  auto replay = record::Replay::begin(snapshot, {.programs = programs}, diagnostics);
  SL_CHECK(replay);
  const std::uint64_t begin = replay->simulation().tick_index();
  ByteReader in(std::as_bytes(std::span(data, size)));
  std::uint8_t first = 0;
  read(in, first);
  for (std::uint64_t tick = 1; tick <= most_ticks && in.ok() && in.remaining() > 0; ++tick) {
    record::RecordedTick recorded;
    recorded.tick = begin + tick;
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
      const auto bytes = in.take(std::min<std::size_t>(length, in.remaining()));
      if (entry.kind >= of_real && entry.kind < 2 * of_real) {
        const RealRequest& base = real[entry.kind % real.size()];
        entry.kind = base.kind;
        entry.target = base.target;
        entry.type = base.type;
        entry.bytes = base.bytes;
        for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
          // Near the end lie the numbers of most; a spawned model is longer than a byte can tell.
          const std::size_t from_end = std::to_integer<std::size_t>(bytes[k]) % entry.bytes.size();
          entry.bytes[entry.bytes.size() - 1 - from_end] = bytes[k + 1];
        }
      } else {
        entry.target = targets[target % std::size(targets)];
        entry.type = types[type % std::size(types)];
        entry.bytes.assign(bytes.begin(), bytes.end());
      }
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
