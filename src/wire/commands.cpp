#include <fmt/format.h>

#include "base/json_writer.h"
#include "base/text.h"
#include "messages/geometry_msgs.h"
#include "wire/scene.h"

namespace sandlot::wire {
namespace {

constexpr std::size_t most_description_bytes = 300;  ///< bytes of text about one request

/// A value as a file would write it on one line.
void add_node(const Node& node, std::string& out) {
  if (out.size() > most_description_bytes) return;
  if (node.is_scalar()) {
    out += node.text().substr(0, most_description_bytes);
    if (node.text().size() > most_description_bytes) out += "...";
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

std::string text_of(Vec3 v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z); }
/// As the console takes it: x y z, with yaw or all angles where it is turned.
std::string text_of(const Pose& X) {
  const Vec3 angles = rpy_from_quat(normalised(X.q));
  constexpr double flat = 1e-9;
  if (std::abs(angles.x) > flat || std::abs(angles.y) > flat) return text_of(X.p) + " " + text_of(angles);
  if (std::abs(angles.z) > flat) return fmt::format("{} {:.6g}", text_of(X.p), angles.z);
  return text_of(X.p);
}

struct RequestText {
  std::string operator()(const CallRequest& x) const { return "call " + x.service; }
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
           text_of(x.instance.X_WM);
  }
  std::string operator()(const DeleteRequest&) const { return "remove"; }
  std::string operator()(const PoseRequest& x) const { return "pose " + text_of(x.X_WM); }
  std::string operator()(const VelocityRequest& x) const {
    return "velocity " + text_of(x.V_WM.linear) + " angular " + text_of(x.V_WM.angular);
  }
  std::string operator()(const InfoRequest&) const { return "info"; }
  std::string operator()(const SampleRequest&) const { return "sample"; }
  std::string operator()(const LoadDeviceRequest& x) const {
    return "load device " + x.device.name + " (" + x.device.kind + ")";
  }
  std::string operator()(const UnloadDeviceRequest&) const { return "unload device"; }
  std::string operator()(const PullRequest& x) const {
    if (x.hold.ns <= 0) return "pull off";
    return "pull " + (x.link.empty() ? "" : x.link + " ") + text_of(x.point_L) + " " + text_of(x.target_W);
  }
  std::string operator()(const AnswerRequest& x) const {
    if (x.answer.kind == OutsideAnswer::Kind::missed) return "no answer in time";
    const std::string text(x.answer.text());
    if (x.answer.kind == OutsideAnswer::Kind::late) return "late answer " + text;
    return (x.answer.kind == OutsideAnswer::Kind::gone ? "gone: " : "answer ") + text;
  }
};

/// The numbers of those commands that people give by hand; the type alone of others.
std::string command_text(const LogEntry& entry) {
  const auto taken = [&]<class M>(M message) -> std::optional<M> {
    ByteReader r(entry.bytes);
    read(r, message);
    if (!r.ok() || r.remaining() != 0) return std::nullopt;
    return message;
  };
  const auto twist = [](const msg::Twist& t) {
    return "Twist linear " + text_of(t.linear) + " angular " + text_of(t.angular);
  };
  if (entry.type == msg::Twist::ros_type)
    if (const auto message = taken(msg::Twist())) return twist(*message);
  if (entry.type == msg::TwistStamped::ros_type)
    if (const auto message = taken(msg::TwistStamped())) return twist(message->twist);
  return entry.type.substr(entry.type.rfind('/') + 1);
}

const char* source_name(Source::Kind kind) {
  switch (kind) {
    case Source::Kind::robot: return "robot";
    case Source::Kind::program: return "program";
    case Source::Kind::rule: return "rule";
    case Source::Kind::admin: break;
  }
  return "admin";
}

}  // namespace

std::string describe_request(const LogEntry& entry) {
  std::string out;
  if (entry.kind == LogEntry::command) {
    out = command_text(entry);
  } else {
    ByteReader r(entry.bytes);
    Request request;
    if (!read_request(r, request)) return request_kind(entry.kind);
    out = std::visit(RequestText(), request);
  }
  if (out.size() > most_description_bytes) {
    out.resize(most_description_bytes);
    out.append("...");
  }
  return out;
}

std::string commands_json(const Frame& frame) {
  std::string out;
  JsonWriter w(out);
  bool any = false;
  for (const LogEntry& entry : frame.log) {
    if (entry.kind == LogEntry::step || entry.source.kind == Source::Kind::program) continue;
    if (!std::exchange(any, true)) {
      w.begin_object();
      w.key("commands").begin_list();
    }
    w.object([&] {
      w.key("tick").integer(frame.tick);
      w.key("time_s").number(frame.now.s());
      w.key("source").text(source_name(entry.source.kind));
      w.key("id").integer(entry.source.id);
      w.key("sequence").integer(entry.sequence);
      w.key("kind").text(request_kind(entry.kind));
      w.key("target").text(entry.target);
      w.key("text").text(describe_request(entry));
      w.key("refused").flag(entry.refused);
      w.key("why").text(entry.why);
    });
  }
  if (any) {
    w.end_list();
    w.end_object();
  }
  return out;
}

}  // namespace sandlot::wire
