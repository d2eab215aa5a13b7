#include "messages/command.h"

#include <cmath>
#include <cstring>

#include "messages/geometry_msgs.h"
#include "messages/json.h"
#include "messages/registry.h"

namespace sandlot {
namespace {

/// Whether `fits` is true of `count` numbers that lie side by side.
template <class T, class F>
bool all_of(const std::byte* at, std::size_t count, F fits) {
  for (std::size_t i = 0; i < count; ++i) {
    T x;
    std::memcpy(&x, at + i * sizeof x, sizeof x);
    if (!fits(x)) return false;
  }
  return true;
}

template <class F>
bool all_of(Wire type, const std::byte* at, std::size_t count, F fits) {
  return type == Wire::float32 ? all_of<float>(at, count, fits) : all_of<double>(at, count, fits);
}

bool is_deliverable(const MessageInfo& info, const std::byte* message) {
  for (const FloatRun& run : info.floats)
    if (!all_of(run.type, message + run.offset, run.count, [](auto x) { return std::isfinite(x); }))
      return false;
  for (const std::size_t i : info.float_lists) {
    const MessageField& field = info.fields[i];
    const std::byte* at = message + field.offset;
    std::size_t count = field.count == MessageField::Count::array ? field.length : 1;
    if (field.count == MessageField::Count::sequence) {
      count = field.vector->size(at);
      at = static_cast<const std::byte*>(field.vector->data(at));
    }
    if (!field.message) {
      if (!all_of(field.type, at, count, [](auto x) { return !std::isinf(x); })) return false;
      continue;
    }
    for (std::size_t k = 0; k < count; ++k, at += field.stride)
      if (!is_deliverable(*field.message, at)) return false;
  }
  return true;
}

Result<std::vector<std::byte>> command_of(const TopicBase& slot, const AnyMessage& message) {
  std::vector<std::byte> cdr;
  message.to_cdr(cdr);
  return command_from_cdr(slot, cdr);
}

}  // namespace

Status check_command(const MessageInfo& info, const void* message) {
  if (!message) return Error{"the bytes are no " + info.name};
  if (!is_deliverable(info, static_cast<const std::byte*>(message)))
    return Error{"the command is not finite", "numbers; what is to stay as it is needs no command"};
  return {};
}

Result<std::vector<std::byte>> command_from_cdr(const TopicBase& slot, std::span<const std::byte> cdr) {
  const std::unique_ptr<TopicBase> message = slot.clone();
  SL_TRY(message->from_cdr(cdr));
  ByteWriter w;
  message->save_message(w);
  return std::move(w.buffer());
}

Result<std::vector<std::byte>> command_from_json(const TopicBase& slot, std::string_view json) {
  SL_ASSIGN(const AnyMessage message, message_from_json(slot.info(), json));
  return command_of(slot, message);
}

Result<std::vector<std::byte>> command_from_document(const TopicBase& slot, const nlohmann::json& document) {
  AnyMessage message(slot.info());
  SL_TRY(read_json(slot.info(), document, message.data()));
  return command_of(slot, message);
}

std::optional<std::vector<std::byte>> standstill(std::string_view type) {
  if (type == msg::Twist::ros_type) return command_bytes(msg::Twist());
  if (type == msg::TwistStamped::ros_type) return command_bytes(msg::TwistStamped());
  return std::nullopt;
}

}  // namespace sandlot
