#pragma once
/// Type information of messages at run time: fields, their places in memory, and the types they are made of.
///
/// message_info<M>() makes it from M's field list, once; messages/dynamic.h makes one from the text of a schema, for
/// recordings of others. Codecs (cdr.h, json.h, cbor.h) and the schema (schema.h) work on it alone, so they are written
/// once and compiled once.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sandlot {

/// What a field holds on the wire.
enum class Wire : std::uint8_t {
  boolean,
  byte,
  character,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  string,
  message
};
/// Bytes of one value, which is also its alignment; 0 for strings and messages.
std::size_t size_of(Wire type);
/// "float64", "string", ...; "" for messages.
const char* name_of(Wire type);
/// What travels as a string of bytes where a format has such: byte, char and uint8.
inline bool is_octet(Wire type) {
  return type == Wire::byte || type == Wire::character || type == Wire::uint8;
}

/// How the elements of a std::vector are reached when their type is not known.
struct VectorAccess {
  std::size_t (*size)(const void* vector);
  const void* (*data)(const void* vector);
  void* (*remade)(void* vector, std::size_t size);  ///< fresh elements with their defaults; returns the first
};

struct MessageInfo;

struct MessageField {
  enum class Count : std::uint8_t { one, array, sequence };
  std::string name;
  std::string unit, help;
  Wire type = Wire::message;
  const MessageInfo* message = nullptr;  ///< of its type when `type` is message
  Count count = Count::one;
  std::size_t length = 0;  ///< of an array; the bound of a sequence, 0: none
  // In memory. A type that was read from a schema has none of it.
  std::size_t offset = 0;                ///< from the beginning of the message
  std::size_t stride = 0;                ///< from one element to the next
  const VectorAccess* vector = nullptr;  ///< of a sequence
};

/// Floating-point numbers that lie side by side in memory, those of nested messages included.
struct FloatRun {
  std::size_t offset = 0, count = 0;
  Wire type = Wire::float64;
};

struct MessageConstant {
  std::string name;
  Wire type;
  std::string value;  ///< as a schema writes it
};

struct MessageInfo {
  std::string name;  ///< "sensor_msgs/msg/LaserScan"
  std::vector<MessageField> fields;
  std::vector<MessageConstant> constants;
  std::string schema;     ///< ros2msg, with all types that it is made of
  std::size_t least = 1;  ///< bytes that a value takes on the wire, alignment aside; never 0
  bool is_time = false;   ///< two fields on the wire, one count of nanoseconds in memory
  // In memory. A type that was read from a schema has no `create`.
  std::vector<FloatRun> floats;  ///< all outside lists
  std::vector<std::size_t>
      float_lists;  ///< indices of fields with floats in lists, their own or a nested message's
  void* (*create)() = nullptr;
  void (*destroy)(void*) = nullptr;
};

/// The type of a C++ message. Instantiated for all of messages/types.def and services.def; others include messages/make_info.h.
template <class M>
const MessageInfo& message_info();

/// "sensor_msgs/LaserScan", the form in schemas and that of ROS 1.
std::string short_name(std::string_view name);
/// "sensor_msgs/msg/LaserScan" from either form.
std::string long_name(std::string_view name);

/// Works out from the fields what follows from them: `least`, `floats`, `float_lists`.
void set_derived(MessageInfo& info);

}  // namespace sandlot
