#include "messages/info.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "messages/make_info.h"

namespace sandlot {
namespace {

struct WireFacts {
  const char* name;
  std::size_t size;
};
constexpr std::array<WireFacts, 15> wires{{{"bool", 1},
                                           {"byte", 1},
                                           {"char", 1},
                                           {"int8", 1},
                                           {"uint8", 1},
                                           {"int16", 2},
                                           {"uint16", 2},
                                           {"int32", 4},
                                           {"uint32", 4},
                                           {"int64", 8},
                                           {"uint64", 8},
                                           {"float32", 4},
                                           {"float64", 8},
                                           {"string", 0},
                                           {"", 0}}};

MessageInfo time_info(const char* name) {
  MessageInfo info;
  info.name = name;
  info.is_time = true;
  info.fields.push_back(
      {.name = "sec", .unit = "s", .help = "Whole seconds, rounded down.", .type = Wire::int32});
  info.fields.push_back({.name = "nanosec",
                         .unit = "ns",
                         .help = "Nanoseconds in addition to the whole seconds.",
                         .type = Wire::uint32});
  set_derived(info);
  return info;
}

/// Fills `floats` and `float_lists`. Types that were read from a schema have no place in memory (stride 0), and none of either.
void set_floats(MessageInfo& info) {
  const auto add = [&](std::size_t offset, std::size_t count, Wire type) {
    if (!info.floats.empty()) {
      FloatRun& last = info.floats.back();
      if (last.type == type && last.offset + last.count * size_of(type) == offset) {
        last.count += count;
        return;
      }
    }
    info.floats.push_back({offset, count, type});
  };
  for (std::size_t i = 0; i < info.fields.size(); ++i) {
    const MessageField& field = info.fields[i];
    const bool is_float = field.type == Wire::float32 || field.type == Wire::float64;
    const bool in_message = field.message &&
                            !(field.message->floats.empty() && field.message->float_lists.empty());
    if (field.stride == 0 || (!is_float && !in_message)) continue;
    const bool nested_lists = in_message && !field.message->float_lists.empty();
    if (field.count == MessageField::Count::sequence || nested_lists) info.float_lists.push_back(i);
    if (field.count == MessageField::Count::sequence) continue;
    const std::size_t length = field.count == MessageField::Count::array ? field.length : 1;
    if (is_float) {
      add(field.offset, length, field.type);
      continue;
    }
    for (std::size_t k = 0; k < length; ++k)
      for (const FloatRun& run : field.message->floats)
        add(field.offset + k * field.stride + run.offset, run.count, run.type);
  }
}

/// A message of doubles that C++ keeps in another order or under other names.
MessageInfo doubles_info(const char* name, const std::string& noun,
                         std::initializer_list<std::pair<const char*, std::size_t>> members) {
  MessageInfo info;
  info.name = name;
  for (const auto& [member, offset] : members)
    info.fields.push_back({.name = member,
                           .help = "Component " + std::string(member) + " of the " + noun + ".",
                           .type = Wire::float64,
                           .offset = offset,
                           .stride = sizeof(double)});
  set_derived(info);
  return info;
}

template <class M>
MessageInfo with_memory(MessageInfo info) {
  info.create = []() -> void* { return new M(); };
  info.destroy = [](void* message) { delete static_cast<M*>(message); };
  info.schema = schema_text(info);
  return info;
}

}  // namespace

std::size_t size_of(Wire type) { return wires[static_cast<std::size_t>(type)].size; }
const char* name_of(Wire type) { return wires[static_cast<std::size_t>(type)].name; }

std::string short_name(std::string_view name) {
  const auto middle = name.find("/msg/");
  if (middle == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, middle)) + "/" + std::string(name.substr(middle + 5));
}
std::string long_name(std::string_view name) {
  const auto slash = name.find('/');
  if (slash == std::string_view::npos || name.find('/', slash + 1) != std::string_view::npos)
    return std::string(name);
  return std::string(name.substr(0, slash)) + "/msg/" + std::string(name.substr(slash + 1));
}

void set_derived(MessageInfo& info) {
  constexpr std::size_t enough = std::size_t{1}
                                 << 40;  // more than any message has; keeps products within 64 bits
  std::size_t sum = 0;
  for (const MessageField& field : info.fields) {
    const std::size_t one = field.type == Wire::message  ? field.message->least
                            : field.type == Wire::string ? 4
                                                         : size_of(field.type);
    const std::size_t all = field.count == MessageField::Count::one ? one
                            : field.count == MessageField::Count::array
                                ? std::min(field.length, enough) * std::min(one, enough)
                                : 4;
    sum = std::min(enough, sum + std::min(all, enough));
  }
  info.least = std::max<std::size_t>(sum, 1);  // an empty message is one byte
  set_floats(info);
}

template <>
const MessageInfo& message_info<Time>() {
  static const MessageInfo info = with_memory<Time>(time_info("builtin_interfaces/msg/Time"));
  return info;
}
template <>
const MessageInfo& message_info<msg::Duration>() {
  static const MessageInfo info = with_memory<msg::Duration>(time_info("builtin_interfaces/msg/Duration"));
  return info;
}
template <>
const MessageInfo& message_info<Vec3>() {
  static const MessageInfo info = with_memory<Vec3>(
      doubles_info("geometry_msgs/msg/Vector3", "vector",
                   {{"x", offsetof(Vec3, x)}, {"y", offsetof(Vec3, y)}, {"z", offsetof(Vec3, z)}}));
  return info;
}
template <>
const MessageInfo& message_info<msg::Point>() {
  static const MessageInfo info = with_memory<msg::Point>(
      doubles_info("geometry_msgs/msg/Point", "point",
                   {{"x", offsetof(Vec3, x)}, {"y", offsetof(Vec3, y)}, {"z", offsetof(Vec3, z)}}));
  return info;
}
template <>
const MessageInfo& message_info<Quat>() {
  static const MessageInfo info = with_memory<Quat>(doubles_info("geometry_msgs/msg/Quaternion", "quaternion",
                                                                 {{"x", offsetof(Quat, x)},
                                                                  {"y", offsetof(Quat, y)},
                                                                  {"z", offsetof(Quat, z)},
                                                                  {"w", offsetof(Quat, w)}}));
  return info;
}
template <>
const MessageInfo& message_info<Pose>() {
  static const MessageInfo info = [] {
    MessageInfo made;
    made.name = "geometry_msgs/msg/Pose";
    made.fields.push_back({.name = "position",
                           .unit = "m",
                           .help = "Position of the origin.",
                           .message = &message_info<msg::Point>(),
                           .offset = offsetof(Pose, p),
                           .stride = sizeof(Vec3)});
    made.fields.push_back({.name = "orientation",
                           .unit = "1",
                           .help = "Orientation as a quaternion.",
                           .message = &message_info<Quat>(),
                           .offset = offsetof(Pose, q),
                           .stride = sizeof(Quat)});
    set_derived(made);
    return with_memory<Pose>(std::move(made));
  }();
  return info;
}

}  // namespace sandlot
