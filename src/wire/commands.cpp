#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "base/text.h"
#include "messages/geometry_msgs.h"
#include "messages/json.h"
#include "wire/scene.h"

namespace sandlot::wire {
namespace {

constexpr std::size_t most_words = 300;  ///< bytes of text about one request

/// A value as a file would write it on one line.
void add_node(const Node& node, std::string& out) {
  if (out.size() > most_words) return;
  if (node.is_scalar()) {
    out += node.text();
  } else if (node.is_sequence()) {
    out += '[';
    for (const Node& each : node.items()) {
      if (&each != &node.items().front()) out += ", ";
      add_node(each, out);
    }
    out += ']';
  } else if (node.is_map()) {
    out += '{';
    for (const Node::Entry& each : node.entries()) {
      if (&each != &node.entries().front()) out += ", ";
      out += each.key + ": ";
      add_node(each.value, out);
    }
    out += '}';
  } else {
    out += "nothing";
  }
}

std::string words(Vec3 v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z); }
/// As the console takes it: x y z, with yaw or all angles where it is turned.
std::string words(const Pose& X) {
  const Vec3 angles = rpy_from_quat(normalised(X.q));
  constexpr double flat = 1e-9;
  if (std::abs(angles.x) > flat || std::abs(angles.y) > flat) return words(X.p) + " " + words(angles);
  if (std::abs(angles.z) > flat) return fmt::format("{} {:.6g}", words(X.p), angles.z);
  return words(X.p);
}

struct Words {
  std::string operator()(const CommandRequest& x) const { return x.type; }
  std::string operator()(const ParameterRequest& x) const {
    std::string out = x.field + " = ";
    add_node(x.value, out);
    return out;
  }
  std::string operator()(const LevelRequest& x) const {
    std::string out = "level";
    for (const std::string& level : x.levels) out += " " + level;
    return out;
  }
  std::string operator()(const SpawnRequest& x) const {
    return "add " + (x.instance.model ? x.instance.model->name : std::string()) + " at " +
           words(x.instance.X_WM);
  }
  std::string operator()(const DeleteRequest&) const { return "remove"; }
  std::string operator()(const PoseRequest& x) const { return "pose " + words(x.X_WM); }
  std::string operator()(const SampleRequest&) const { return "sample"; }
  std::string operator()(const LoadDeviceRequest& x) const {
    return "load device " + x.device.name + " (" + x.device.kind + ")";
  }
  std::string operator()(const UnloadDeviceRequest&) const { return "unload device"; }
  std::string operator()(const PullRequest& x) const {
    if (x.hold.ns <= 0) return "pull off";
    return "pull " + (x.link.empty() ? "" : x.link + " ") + words(x.point_L) + " " + words(x.target_W);
  }
};

/// The numbers of those commands that people give by hand; the type alone of others.
std::string command_words(const LogEntry& entry) {
  const auto taken = [&]<class M>(M message) -> std::optional<M> {
    ByteReader r(entry.bytes);
    read(r, message);
    if (!r.ok() || r.remaining() != 0) return std::nullopt;
    return message;
  };
  const auto twist = [](const msg::Twist& t) {
    return "Twist linear " + words(t.linear) + " angular " + words(t.angular);
  };
  if (entry.type == msg::Twist::ros_type)
    if (const auto message = taken(msg::Twist())) return twist(*message);
  if (entry.type == msg::TwistStamped::ros_type)
    if (const auto message = taken(msg::TwistStamped())) return twist(message->twist);
  return entry.type.substr(entry.type.rfind('/') + 1);
}

const char* name_of(Source::Kind kind) {
  switch (kind) {
    case Source::Kind::robot: return "robot";
    case Source::Kind::program: return "program";
    case Source::Kind::admin: break;
  }
  return "admin";
}

void put(std::vector<std::byte>& out, const auto& value) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}
void put_float(std::vector<std::byte>& out, double x) {
  constexpr double most = std::numeric_limits<float>::max();
  put(out, static_cast<float>(std::clamp(x, -most, most)));
}

}  // namespace

std::string describe_request(const LogEntry& entry) {
  std::string out;
  if (entry.kind == LogEntry::command) {
    out = command_words(entry);
  } else {
    ByteReader r(entry.bytes);
    Request request;
    if (!read_request(r, request)) return request_kind(entry.kind);
    out = std::visit(Words(), request);
  }
  if (out.size() > most_words) {
    out.resize(most_words);
    out.append("...");
  }
  return out;
}

std::string commands_json(const Frame& frame) {
  std::string out;
  for (const LogEntry& entry : frame.log) {
    if (entry.kind == LogEntry::step || entry.source.kind == Source::Kind::program) continue;
    out += out.empty() ? "{\"commands\":[" : ",";
    out += fmt::format("{{\"tick\":{},\"time_s\":", frame.tick);
    append_json(frame.now.s(), out);
    out += fmt::format(",\"source\":\"{}\",\"id\":{},\"sequence\":{},\"kind\":\"{}\",\"target\":",
                       name_of(entry.source.kind), entry.source.id, entry.sequence, request_kind(entry.kind));
    append_json(entry.target, out);
    out += ",\"text\":";
    append_json(describe_request(entry), out);
    out += entry.refused ? ",\"refused\":true,\"why\":" : ",\"refused\":false,\"why\":";
    append_json(entry.why, out);
    out += '}';
  }
  return out.empty() ? out : out + "]}";
}

void write_contacts(const Frame& frame, std::vector<std::byte>& out) {
  out.clear();
  out.reserve(20 + 28 * frame.contacts.size());
  put(out, frame.tick);
  put(out, frame.now.ns);
  put(out, static_cast<std::uint32_t>(frame.contacts.size()));
  for (const Contact& contact : frame.contacts)
    for (const double x : {contact.point_W.x, contact.point_W.y, contact.point_W.z, contact.normal_W.x,
                           contact.normal_W.y, contact.normal_W.z, contact.depth_m})
      put_float(out, x);
}

}  // namespace sandlot::wire
