#pragma once
/// Topic: the place of messages between the one that fills them and those that read them.
///
/// A Topic holds the latest message of one device level and its stamp; a CommandSlot holds the latest command.
/// Both are State: they are hashed and saved. Neither knows who reads it.
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

#include "base/bytes.h"
#include "base/time.h"
#include "base/values.h"
#include "messages/cdr.h"
#include "messages/info.h"

namespace sandlot {

class TopicBase {
 public:
  TopicBase(std::string name, const char* type) : name_(std::move(name)), type_(type) {}
  virtual ~TopicBase() = default;
  const std::string& name() const { return name_; }  ///< "/robot1/laser/ranges"
  const char* type() const { return type_; }         ///< "sensor_msgs/msg/LaserScan"
  Time stamp;                                        ///< of the latest message
  std::uint64_t count = 0;                           ///< messages so far; 0: none yet

  /// Stamp, count and message; of a queue the orders that wait, too.
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
  /// The message alone: the bytes of a command (messages/command.h).
  virtual void save_message(ByteWriter& w) const = 0;
  /// Takes the message alone, as a command. Errors: bytes that are not exactly one message, numbers that
  /// check_command() refuses; the old message stays.
  virtual Status assign(std::span<const std::byte> bytes) = 0;
  /// Whether assign() would take these bytes into an empty slot.
  virtual Status check(std::span<const std::byte> bytes) const = 0;
  /// Of a command slot that keeps several orders (messages/command_queue.h): the orders that wait, and how many may. 0: of
  /// several orders the last counts.
  virtual std::size_t waiting() const { return 0; }
  virtual std::size_t queue_limit() const { return 0; }
  virtual std::unique_ptr<TopicBase> clone() const = 0;
  /// A number of the message by its path, and all of them.
  virtual ValueFound value(std::span<const ValueStep> path) const = 0;
  virtual void list_values(const ValueVisit& visit) const = 0;
  /// Takes message, stamp and count from a topic of the same type; costs no heap once it has held as much.
  virtual void copy_from(const TopicBase& other) = 0;
  /// Counts the message it holds as one of `now`, once more.
  virtual void republish(Time now) = 0;
  /// Writes another time into the message; false when it holds none.
  virtual bool restamp(Time stamp) = 0;
  /// About what it holds in memory.
  virtual std::size_t memory_bytes() const = 0;

  virtual const MessageInfo& info() const = 0;
  virtual const void* data() const = 0;  ///< the message, for those that know it by info() alone
  /// The message as others read it. Allocates nothing once `out` has the room.
  void to_cdr(std::vector<std::byte>& out) const { write_cdr(info(), data(), out); }
  /// Takes the message from CDR; when that fails the old one stays.
  virtual Status from_cdr(std::span<const std::byte> bytes) = 0;

 private:
  std::string name_;
  const char* type_;
};

/// Whether a message may be a command. Floating-point numbers must be finite; elements of lists may be NaN, which leaves
/// the element's joint or wheel as it is. A velocity or a single number has no such meaning: NaN there would only stay in
/// the state and in its snapshots.
/// @param message  null: the bytes were not one
Status check_command(const MessageInfo& info, const void* message);

/// Bytes that a value holds on the heap.
template <class T>
std::size_t heap_bytes(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    return value.size();
  } else if constexpr (is_vector<T>::value) {
    std::size_t sum = value.size() * sizeof(typename T::value_type);
    if constexpr (!RawBytes<typename T::value_type> && !std::is_same_v<T, std::vector<bool>>)
      for (const auto& element : value) sum += heap_bytes(element);
    return sum;
  } else if constexpr (Fielded<T>) {
    std::size_t sum = 0;
    T::fields(value, [&](const Field&, const auto& member) { sum += heap_bytes(member); });
    return sum;
  } else {
    return 0;
  }
}

/// The latest message of type M.
template <class M>
class Topic : public TopicBase {
 public:
  explicit Topic(std::string name) : TopicBase(std::move(name), M::ros_type) {}
  M message;

  /// Marks the message as filled at `now`.
  void publish(Time now) {
    stamp = now;
    ++count;
    if constexpr (requires { message.header; }) message.header.stamp = now;
  }
  void republish(Time now) override { publish(now); }
  bool restamp([[maybe_unused]] Time other) override {
    if constexpr (requires { message.header; }) return message.header.stamp = other, true;
    else return false;
  }
  void save(ByteWriter& w) const override {
    write(w, stamp);
    write(w, count);
    write(w, message);
  }
  void save_message(ByteWriter& w) const override { write(w, message); }
  void load(ByteReader& r) override {
    read(r, stamp);
    read(r, count);
    read(r, message);
  }
  Status assign(std::span<const std::byte> bytes) override {
    M taken{};
    SL_TRY(read_command(bytes, taken));
    message = std::move(taken);
    return {};
  }
  Status check(std::span<const std::byte> bytes) const override {
    M taken{};
    return read_command(bytes, taken);
  }
  std::unique_ptr<TopicBase> clone() const override { return std::make_unique<Topic>(*this); }
  const MessageInfo& info() const override { return message_info<M>(); }
  const void* data() const override { return &message; }
  Status from_cdr(std::span<const std::byte> bytes) override {
    M taken{};
    SL_TRY(read_cdr(message_info<M>(), bytes, &taken));
    message = std::move(taken);
    return {};
  }
  ValueFound value(std::span<const ValueStep> path) const override { return value_at(message, path); }
  void list_values(const ValueVisit& visit) const override {
    sandlot::list_values(message, "", "", "", visit);
  }
  void copy_from(const TopicBase& other) override {
    const auto& from = static_cast<const Topic&>(other);
    stamp = from.stamp;
    count = from.count;
    message = from.message;
  }
  std::size_t memory_bytes() const override { return sizeof *this + heap_bytes(message); }

 protected:
  static Status read_command(std::span<const std::byte> bytes, M& taken) {
    ByteReader r(bytes);
    read(r, taken);
    return check_command(message_info<M>(), r.ok() && r.remaining() == 0 ? &taken : nullptr);
  }
};

/// M's topic behind a base pointer, or null when it carries another type.
template <class M>
Topic<M>* topic_cast(TopicBase* topic) {
  return topic && std::string_view(topic->type()) == M::ros_type ? static_cast<Topic<M>*>(topic) : nullptr;
}
template <class M>
const Topic<M>* topic_cast(const TopicBase* topic) {
  return topic && std::string_view(topic->type()) == M::ros_type ? static_cast<const Topic<M>*>(topic)
                                                                 : nullptr;
}

}  // namespace sandlot
