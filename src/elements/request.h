#pragma once
/// Request: any change of a running simulation from outside, as one variant.
///
/// Requests take effect at the beginning of the next tick, in an order that does not depend on who connected first
/// (Commands::take()), and are logged: the log plus the seed is the replay.
#include <cstdint>
#include <string>
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
  std::string target;
  std::string type;              ///< ROS type
  std::vector<std::byte> bytes;  ///< the message, as base/bytes.h writes it
};
/// A tunable field: "robot1/laser.noise/white" or "robot1/wander.speed".
struct ParameterRequest {
  std::string target;
  std::string field;
  Node value;
};
/// Which levels of a device are active from now on.
struct LevelRequest {
  std::string device;
  std::vector<std::string> levels;
};
struct SpawnRequest {
  model::Instance instance;
};
struct DeleteRequest {
  std::string name;
};
struct PoseRequest {
  std::string name;
  Pose X_WM;
};
/// A new device for a robot that is there. Its programs go on as they are; those that look devices up find it.
struct LoadDeviceRequest {
  std::string robot;
  model::DeviceDecl device;
};
/// Takes a device from its robot; what it held is released. Refused while a program of the robot needs it.
struct UnloadDeviceRequest {
  std::string device;
};
/// Pulls at an instance with a spring for a while (sim/world/pull.h); `hold` 0 lets go.
struct PullRequest {
  std::string name;
  std::string link;        ///< "": the first
  Vec3 point_L, target_W;  ///< [m]
  Time hold = Time::from_s(0.25);
};
/// Take a sample at the end of the next tick although none is due.
struct SampleRequest {
  std::string device;
};

/// What came from outside for a program that waits for it, or that nothing came in time.
struct AnswerRequest {
  std::string program;
  OutsideAnswer answer;
};

/// Calls a service of a device (devices/device_service.h).
struct CallRequest {
  std::string device;            ///< "rover/odometry"
  std::string service;           ///< "reset"
  std::vector<std::byte> bytes;  ///< the service's request, in CDR
};

/// Sets the velocity of an instance as a whole (Engine::set_velocity).
struct VelocityRequest {
  std::string name;
  Velocity V_WM;  ///< of the model's origin
};
/// Replaces category, description and tags of an entity.
struct InfoRequest {
  std::string name;
  model::EntityInfo info;
};

using Request = std::variant<CommandRequest, ParameterRequest, LevelRequest, SpawnRequest, DeleteRequest,
                             PoseRequest, SampleRequest, LoadDeviceRequest, UnloadDeviceRequest, PullRequest,
                             AnswerRequest, CallRequest, VelocityRequest, InfoRequest>;

/// "command", "parameter", ...: of the alternatives of Request in their order.
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
