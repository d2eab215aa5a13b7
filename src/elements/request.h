#pragma once
/// Request: any change of a running simulation from outside, as one variant.
///
/// Requests take effect at the beginning of the next tick, in an order that does not depend on who connected first
/// (Commands::take()), and are logged: the log plus the seed is the replay.
///
/// An alternative is a struct with
///   kind       its name for people
///   members()  what a log holds of it, in the order of the bytes; the first one is its target, unless it has target()
///   fits()     only where a log may hold what must not be: false refuses it
#include <cstdint>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "base/bytes.h"
#include "base/node.h"
#include "control/program.h"
#include "geometry/pose.h"
#include "model/model.h"

namespace sandlot {

/// Sender of a request.
struct Source {
  enum class Kind : std::uint8_t {
    admin,
    robot,    ///< a client that drives a robot
    program,  ///< a controller in this process; its orders act after all others
    rule,  ///< a rule of the world; its requests act after those from outside, before the orders of programs
  } kind = Kind::admin;
  /// A client's own number. Of a program, and in the log of a client that drives a robot: the robot's creation order. Of a
  /// rule: its place in the list.
  std::uint64_t id = 0;
  static constexpr Kind last_kind = Kind::rule;
  /// Whether the world itself brings it forth again when the same input is repeated.
  bool is_inside() const { return kind == Kind::program || kind == Kind::rule; }
};

/// A message for a device: `target` is "robot1/drive" (its active level) or "robot1/drive/ideal".
struct CommandRequest {
  static constexpr const char* kind = "command";
  std::string target;
  std::string type;              ///< ROS type
  std::vector<std::byte> bytes;  ///< the message, as base/bytes.h writes it
  static auto members(auto& x) { return std::tie(x.target, x.type, x.bytes); }
};
/// A tunable field: "robot1/laser.noise/white" or "robot1/wander.speed".
struct ParameterRequest {
  static constexpr const char* kind = "parameter";
  std::string target;
  std::string field;
  Node value;
  static auto members(auto& x) { return std::tie(x.target, x.field, x.value); }
};
/// Which levels of a device are active from now on.
struct LevelRequest {
  static constexpr const char* kind = "level";
  std::string device;
  std::vector<std::string> levels;
  static auto members(auto& x) { return std::tie(x.device, x.levels); }
};
struct SpawnRequest {
  static constexpr const char* kind = "spawn";
  model::Instance instance;
  static auto members(auto& x) { return std::tie(x.instance); }
  const std::string& target() const { return instance.name; }
};
struct DeleteRequest {
  static constexpr const char* kind = "delete";
  std::string name;
  static auto members(auto& x) { return std::tie(x.name); }
};
struct PoseRequest {
  static constexpr const char* kind = "pose";
  std::string name;
  Pose X_WM;
  static auto members(auto& x) { return std::tie(x.name, x.X_WM); }
};
/// A new device for a robot that is there. Its programs go on as they are; those that look devices up find it.
struct LoadDeviceRequest {
  static constexpr const char* kind = "load device";
  std::string robot;
  model::DeviceDecl device;
  static auto members(auto& x) { return std::tie(x.robot, x.device); }
};
/// Takes a device from its robot; what it held is released. Refused while a program of the robot needs it.
struct UnloadDeviceRequest {
  static constexpr const char* kind = "unload device";
  std::string device;
  static auto members(auto& x) { return std::tie(x.device); }
};
/// Pulls at an instance with a spring for a while (sim/world/pull.h); `hold` 0 lets go.
struct PullRequest {
  static constexpr const char* kind = "pull";
  std::string name;
  std::string link;        ///< "": the first
  Vec3 point_L, target_W;  ///< [m]
  Time hold = Time::from_s(0.25);
  static auto members(auto& x) { return std::tie(x.name, x.link, x.point_L, x.target_W, x.hold); }
};
/// Take a sample at the end of the next tick although none is due.
struct SampleRequest {
  static constexpr const char* kind = "sample";
  std::string device;
  static auto members(auto& x) { return std::tie(x.device); }
};

/// What came from outside for a program that waits for it, or that nothing came in time.
struct AnswerRequest {
  static constexpr const char* kind = "answer";
  std::string program;
  OutsideAnswer answer;
  static auto members(auto& x) { return std::tie(x.program, x.answer.kind, x.answer.bytes); }
  bool fits() const { return answer.kind <= OutsideAnswer::Kind::late; }
};

/// Calls a service of a device (devices/device_service.h).
struct CallRequest {
  static constexpr const char* kind = "call";
  std::string device;            ///< "rover/odometry"
  std::string service;           ///< "reset"
  std::vector<std::byte> bytes;  ///< the service's request, in CDR
  static auto members(auto& x) { return std::tie(x.device, x.service, x.bytes); }
};

/// Sets the velocity of an instance as a whole (Engine::set_velocity).
struct VelocityRequest {
  static constexpr const char* kind = "velocity";
  std::string name;
  Velocity V_WM;  ///< of the model's origin
  static auto members(auto& x) { return std::tie(x.name, x.V_WM); }
};
/// Replaces category, description and tags of an entity.
struct InfoRequest {
  static constexpr const char* kind = "info";
  std::string name;
  model::EntityInfo info;
  static auto members(auto& x) { return std::tie(x.name, x.info.category, x.info.description, x.info.tags); }
  bool fits() const { return info.category <= model::Category::static_object; }
};

using Request = std::variant<CommandRequest, ParameterRequest, LevelRequest, SpawnRequest, DeleteRequest,
                             PoseRequest, SampleRequest, LoadDeviceRequest, UnloadDeviceRequest, PullRequest,
                             AnswerRequest, CallRequest, VelocityRequest, InfoRequest>;

/// Name of an alternative of Request, by its place in the list: "command", "parameter", ...
const char* request_kind(std::size_t index);
/// The target of a request: "rover/drive".
const std::string& request_target(const Request& request);

/// A request as bytes, for the log. Places (file:line) are not kept.
void write_request(ByteWriter& w, const Request& request);
/// Reads what write_request wrote; false when the bytes are not that.
bool read_request(ByteReader& r, Request& request);

/// Outcome of a request, in the order of execution.
struct Outcome {
  Source source;
  std::uint64_t sequence = 0;
  Status status;
  std::vector<std::byte> response = {};  ///< of a CallRequest, in CDR
};

}  // namespace sandlot
