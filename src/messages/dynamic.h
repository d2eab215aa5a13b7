#pragma once
/// Message types read from the text of a schema, for recordings of others.
///
/// Input    ros2msg as in MCAP files: lines of `type name`, `type name default` or `type NAME=constant`, `#` begins a
///          comment; behind lines of '=' and `MSG: pkg/Type` the types that the first one is made of. `time` and
///          `duration` are those of builtin_interfaces. A type that the text leaves out is looked for among ours.
/// Errors   with the line of the schema: no such type, types that contain themselves, wide strings, names used twice,
///          more than the limits.
/// Limits   a schema may have 1 MB, 1000 types, 10'000 fields in all, and nest 32 deep. Bounds of strings are ignored.
///          Defaults are passed over: they mean nothing to a reader.
#include <cstddef>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/result.h"
#include "messages/info.h"

namespace sandlot {

/// The types of one schema. They point at each other, so it is moved, never copied.
class DynamicSchema {
 public:
  /// @param type  name of the first message of the text, such as "sensor_msgs/msg/LaserScan"
  static Result<DynamicSchema> parse(std::string_view type, std::string_view text);

  DynamicSchema(DynamicSchema&&) = default;
  DynamicSchema& operator=(DynamicSchema&&) = default;
  DynamicSchema(const DynamicSchema&) = delete;
  DynamicSchema& operator=(const DynamicSchema&) = delete;

  /// For walk_cdr(), cdr_to_json(), cdr_to_cbor() and visit_values(); it has no C++ form.
  const MessageInfo& info() const { return types_.front(); }

 private:
  DynamicSchema() = default;
  std::deque<MessageInfo> types_;  // a deque keeps its elements where they are when it is moved
};

/// A number or a text in a message.
using MessageValue = std::variant<bool, std::int64_t, std::uint64_t, double, std::string_view>;

/// The numbers and texts of a message in the order of the wire, each with its path: "header.stamp.sec", "ranges[3]".
/// `path` and texts are valid during the call only.
Status visit_values(const MessageInfo& info, std::span<const std::byte> cdr,
                    const std::function<void(std::string_view path, const MessageValue& value)>& visit);

}  // namespace sandlot
