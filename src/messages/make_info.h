#pragma once
/// message_info<M>() for message types of one's own: made from the field list, and from `constants` where M has them.
#include <string>
#include <type_traits>

#include "base/fields.h"
#include "base/time.h"
#include "geometry/pose.h"
#include "messages/info.h"
#include "messages/schema.h"
#include "messages/std_msgs.h"

namespace sandlot {

template <class T>
consteval Wire wire_of() {
  if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, msg::Boolean>) return Wire::boolean;
  else if constexpr (std::is_same_v<T, std::byte>) return Wire::byte;
  else if constexpr (std::is_same_v<T, char>) return Wire::character;
  else if constexpr (std::is_same_v<T, std::int8_t>) return Wire::int8;
  else if constexpr (std::is_same_v<T, std::uint8_t>) return Wire::uint8;
  else if constexpr (std::is_same_v<T, std::int16_t>) return Wire::int16;
  else if constexpr (std::is_same_v<T, std::uint16_t>) return Wire::uint16;
  else if constexpr (std::is_same_v<T, std::int32_t>) return Wire::int32;
  else if constexpr (std::is_same_v<T, std::uint32_t>) return Wire::uint32;
  else if constexpr (std::is_same_v<T, std::int64_t>) return Wire::int64;
  else if constexpr (std::is_same_v<T, std::uint64_t>) return Wire::uint64;
  else if constexpr (std::is_same_v<T, float>) return Wire::float32;
  else if constexpr (std::is_same_v<T, double>) return Wire::float64;
  else if constexpr (std::is_same_v<T, std::string>) return Wire::string;
  else return Wire::message;
}

template <class T>
inline constexpr VectorAccess vector_access{
    [](const void* vector) { return static_cast<const std::vector<T>*>(vector)->size(); },
    [](const void* vector) -> const void* { return static_cast<const std::vector<T>*>(vector)->data(); },
    [](void* vector, std::size_t size) -> void* {
      auto& all = *static_cast<std::vector<T>*>(vector);
      all.clear();
      all.resize(size);
      return all.data();
    }};

// Types whose C++ form differs from their field list; in info.cpp.
template <>
const MessageInfo& message_info<Time>();
template <>
const MessageInfo& message_info<msg::Duration>();
template <>
const MessageInfo& message_info<Vec3>();
template <>
const MessageInfo& message_info<msg::Point>();
template <>
const MessageInfo& message_info<Quat>();
template <>
const MessageInfo& message_info<Pose>();

/// The field that a member of type T is, without name and offset.
template <class T>
MessageField field_of_type() {
  MessageField field;
  if constexpr (is_vector<T>::value) {
    field = field_of_type<typename T::value_type>();
    field.count = MessageField::Count::sequence;
    field.vector = &vector_access<typename T::value_type>;
  } else if constexpr (is_array<T>::value) {
    field = field_of_type<typename T::value_type>();
    field.count = MessageField::Count::array;
    field.length = std::tuple_size_v<T>;
  } else {
    field.type = wire_of<T>();
    field.stride = sizeof(T);
    if constexpr (wire_of<T>() == Wire::message) field.message = &message_info<T>();
  }
  return field;
}

template <class T>
MessageConstant constant_of(const char* name, T value) {
  if constexpr (std::is_convertible_v<T, std::string>) return {name, Wire::string, value};
  else if constexpr (std::is_same_v<T, std::byte>)
    return {name, Wire::byte, std::to_string(std::to_integer<unsigned>(value))};
  else return {name, wire_of<T>(), std::to_string(value)};
}

template <class M>
const MessageInfo& message_info() {
  static const MessageInfo info = [] {
    MessageInfo made;
    made.name = M::ros_type;
    const M message{};
    M::fields(message, [&](const Field& f, const auto& member) {
      MessageField field = field_of_type<std::remove_cvref_t<decltype(member)>>();
      field.name = f.key;
      field.unit = f.unit;
      field.help = f.help;
      field.offset = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&member) -
                                              reinterpret_cast<const std::byte*>(&message));
      made.fields.push_back(std::move(field));
    });
    const auto add = [&](const char* name, auto value) {
      made.constants.push_back(constant_of(name, value));
    };
    if constexpr (requires { M::constants(add); }) M::constants(add);
    made.create = []() -> void* { return new M(); };
    made.destroy = [](void* object) { delete static_cast<M*>(object); };
    set_derived(made);
    made.schema = schema_text(made);
    return made;
  }();
  return info;
}

}  // namespace sandlot
