#pragma once
/// Commands as bytes: the form in which a CommandRequest carries a message and TopicBase::assign() takes it. The fields as
/// base/bytes.h writes them, without stamp or count.
///
/// Errors   bytes that are not a message of the slot's type, named with the field. Numbers are judged where the command
///          is delivered: check_command() of messages/topic.h.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "messages/topic.h"

namespace sandlot {

template <class M>
std::vector<std::byte> command_bytes(const M& message) {
  ByteWriter w;
  write(w, message);
  return std::move(w.buffer());
}

/// For messages whose type is known by the slot alone. @param slot  gives the type; what it holds does not matter
Result<std::vector<std::byte>> command_from_cdr(const TopicBase& slot, std::span<const std::byte> cdr);
Result<std::vector<std::byte>> command_from_json(const TopicBase& slot, std::string_view json);
Result<std::vector<std::byte>> command_from_document(const TopicBase& slot, const nlohmann::json& document);

/// The order to stand still, for a slot of that type; nothing: messages of that type are not velocities of a drive. The one place
/// that knows by which types drives are driven: watchdogs stop these, and clients address them as /ROBOT/cmd_vel.
std::optional<std::vector<std::byte>> standstill(std::string_view type);

}  // namespace sandlot
