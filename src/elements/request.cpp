#include "elements/request.h"

#include <array>

#include "model/model_bytes.h"

namespace sandlot {
namespace {

/// The alternative with this index, empty.
template <std::size_t... I>
bool make(Request& request, std::size_t index, std::index_sequence<I...>) {
  return ((I == index ? (request.emplace<I>(), true) : false) || ...);
}

struct Save {
  ByteWriter& w;
  bool operator()(const CommandRequest& x) {
    return write(w, x.target), write(w, x.type), write(w, x.bytes), true;
  }
  bool operator()(const ParameterRequest& x) {
    return write(w, x.target), write(w, x.field), write_node(w, x.value), true;
  }
  bool operator()(const LevelRequest& x) { return write(w, x.device), write(w, x.levels), true; }
  bool operator()(const SpawnRequest& x) { return write_instance(w, x.instance), true; }
  bool operator()(const DeleteRequest& x) { return write(w, x.name), true; }
  bool operator()(const PoseRequest& x) { return write(w, x.name), write(w, x.X_WM), true; }
  bool operator()(const SampleRequest& x) { return write(w, x.device), true; }
  bool operator()(const LoadDeviceRequest& x) { return write(w, x.robot), write_device(w, x.device), true; }
  bool operator()(const UnloadDeviceRequest& x) { return write(w, x.device), true; }
  bool operator()(const PullRequest& x) {
    write(w, x.name), write(w, x.link);
    return write(w, x.point_L), write(w, x.target_W), write(w, x.hold), true;
  }
  bool operator()(const AnswerRequest& x) {
    return write(w, x.program), write(w, x.answer.kind), write(w, x.answer.bytes), true;
  }
  bool operator()(const CallRequest& x) {
    return write(w, x.device), write(w, x.service), write(w, x.bytes), true;
  }
  bool operator()(const VelocityRequest& x) { return write(w, x.name), write(w, x.V_WM), true; }
  bool operator()(const InfoRequest& x) {
    write(w, x.name), write(w, x.info.category), write(w, x.info.description), write(w, x.info.tags);
    return true;
  }
};

struct Load {
  ByteReader& r;
  bool operator()(CommandRequest& x) { return read(r, x.target), read(r, x.type), read(r, x.bytes), r.ok(); }
  bool operator()(ParameterRequest& x) { return read(r, x.target), read(r, x.field), read_node(r, x.value); }
  bool operator()(LevelRequest& x) { return read(r, x.device), read(r, x.levels), r.ok(); }
  bool operator()(SpawnRequest& x) { return read_instance(r, x.instance); }
  bool operator()(DeleteRequest& x) { return read(r, x.name), r.ok(); }
  bool operator()(PoseRequest& x) { return read(r, x.name), read(r, x.X_WM), r.ok(); }
  bool operator()(SampleRequest& x) { return read(r, x.device), r.ok(); }
  bool operator()(LoadDeviceRequest& x) { return read(r, x.robot), read_device(r, x.device); }
  bool operator()(UnloadDeviceRequest& x) { return read(r, x.device), r.ok(); }
  bool operator()(PullRequest& x) {
    read(r, x.name), read(r, x.link);
    return read(r, x.point_L), read(r, x.target_W), read(r, x.hold), r.ok();
  }
  bool operator()(AnswerRequest& x) {
    read(r, x.program), read(r, x.answer.kind), read(r, x.answer.bytes);
    return r.ok() && x.answer.kind <= OutsideAnswer::Kind::gone;
  }
  bool operator()(CallRequest& x) { return read(r, x.device), read(r, x.service), read(r, x.bytes), r.ok(); }
  bool operator()(VelocityRequest& x) { return read(r, x.name), read(r, x.V_WM), r.ok(); }
  bool operator()(InfoRequest& x) {
    read(r, x.name), read(r, x.info.category), read(r, x.info.description), read(r, x.info.tags);
    return r.ok() && x.info.category <= model::Category::static_object;
  }
};

struct Target {
  const std::string& operator()(const CommandRequest& x) const { return x.target; }
  const std::string& operator()(const ParameterRequest& x) const { return x.target; }
  const std::string& operator()(const LevelRequest& x) const { return x.device; }
  const std::string& operator()(const SpawnRequest& x) const { return x.instance.name; }
  const std::string& operator()(const DeleteRequest& x) const { return x.name; }
  const std::string& operator()(const PoseRequest& x) const { return x.name; }
  const std::string& operator()(const SampleRequest& x) const { return x.device; }
  const std::string& operator()(const LoadDeviceRequest& x) const { return x.robot; }
  const std::string& operator()(const UnloadDeviceRequest& x) const { return x.device; }
  const std::string& operator()(const PullRequest& x) const { return x.name; }
  const std::string& operator()(const AnswerRequest& x) const { return x.program; }
  const std::string& operator()(const CallRequest& x) const { return x.device; }
  const std::string& operator()(const VelocityRequest& x) const { return x.name; }
  const std::string& operator()(const InfoRequest& x) const { return x.name; }
};

}  // namespace

static_assert(std::is_same_v<std::variant_alternative_t<0, Request>, CommandRequest>, "LogEntry::command");

const char* request_kind(std::size_t index) {
  static constexpr std::array<const char*, std::variant_size_v<Request>> names{
      "command",     "parameter",     "level", "spawn",  "delete", "pose",     "sample",
      "load device", "unload device", "pull",  "answer", "call",   "velocity", "info"};
  return index < names.size() ? names[index] : "unknown";
}

const std::string& request_target(const Request& request) { return std::visit(Target{}, request); }

void write_request(ByteWriter& w, const Request& request) {
  write(w, static_cast<std::uint8_t>(request.index()));
  std::visit(Save{w}, request);
}

bool read_request(ByteReader& r, Request& request) {
  std::uint8_t index = 0;
  read(r, index);
  if (!r.ok() || !make(request, index, std::make_index_sequence<std::variant_size_v<Request>>()))
    return false;
  return std::visit(Load{r}, request) && r.remaining() == 0;
}

}  // namespace sandlot
