#include "messages/cdr.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>

#include "base/time.h"

namespace sandlot {
namespace {

using Count = MessageField::Count;
constexpr std::size_t header_size = 4;

struct RosTime {
  std::int32_t sec;
  std::uint32_t nanosec;
};
RosTime to_ros(Time time) {
  std::int64_t sec = time.ns / Time::per_s;
  std::int64_t rest = time.ns % Time::per_s;
  if (rest < 0) sec -= 1, rest += Time::per_s;
  using Limits = std::numeric_limits<std::int32_t>;
  if (sec > Limits::max()) return {Limits::max(), 999'999'999};
  if (sec < Limits::min()) return {Limits::min(), 0};
  return {static_cast<std::int32_t>(sec), static_cast<std::uint32_t>(rest)};
}
// |sec| < 2^31 and nanosec < 2^32: no overflow, even of a nanosec that is more than a second.
Time from_ros(RosTime t) { return {t.sec * Time::per_s + t.nanosec}; }

class CdrWriter {
 public:
  explicit CdrWriter(std::vector<std::byte>& out) : out_(out) {
    out_.clear();
    constexpr std::array<std::byte, header_size> little_endian{std::byte{0}, std::byte{1}};
    raw(little_endian.data(), header_size);
  }
  void message(const MessageInfo& info, const void* object) {
    if (info.is_time) {
      const RosTime time = to_ros(*static_cast<const Time*>(object));
      number(&time.sec, 4);
      return number(&time.nanosec, 4);
    }
    if (info.fields.empty()) return out_.push_back({});
    for (const MessageField& field : info.fields) {
      const auto* place = static_cast<const std::byte*>(object) + field.offset;
      switch (field.count) {
        case Count::one: values(field, place, 1); break;
        case Count::array: values(field, place, field.length); break;
        case Count::sequence: {
          const auto size = static_cast<std::uint32_t>(field.vector->size(place));
          number(&size, 4);
          values(field, static_cast<const std::byte*>(field.vector->data(place)), size);
        }
      }
    }
  }

 private:
  void raw(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    out_.insert(out_.end(), bytes, bytes + size);
  }
  void align(std::size_t size) {
    const std::size_t over = (out_.size() - header_size) % size;
    if (over) out_.resize(out_.size() + size - over);
  }
  void number(const void* data, std::size_t size) {
    align(size);
    raw(data, size);
  }
  void values(const MessageField& field, const std::byte* first, std::size_t count) {
    if (count == 0) return;
    if (const std::size_t size = size_of(field.type)) {  // numbers lie in memory as they do on the wire
      align(size);
      return raw(first, count * size);
    }
    for (std::size_t i = 0; i < count; ++i, first += field.stride) {
      if (field.type == Wire::message) {
        message(*field.message, first);
      } else {
        const auto& text = *reinterpret_cast<const std::string*>(first);
        const auto size = static_cast<std::uint32_t>(text.size() + 1);
        number(&size, 4);
        raw(text.c_str(), size);
      }
    }
  }
  std::vector<std::byte>& out_;
};

/// The bytes of a message, checked as they are taken.
class Source {
 public:
  explicit Source(std::span<const std::byte> bytes) : bytes_(bytes) {}

  Status begin() {
    if (bytes_.size() < header_size) return Error{"CDR ends within its first 4 bytes"};
    const auto kind = std::to_integer<unsigned>(bytes_[0]) << 8 | std::to_integer<unsigned>(bytes_[1]);
    if (kind > 1)
      return Error{"CDR of encapsulation " + std::to_string(kind),
                   "0 (big-endian) and 1 (little-endian) are known"};
    swapped_ = kind == 0;
    at_ = header_size;
    return {};
  }
  bool swapped() const { return swapped_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  /// `count` numbers of `size` bytes as they lie there; null when there are fewer.
  const std::byte* take(std::size_t size, std::size_t count) {
    if (count == 0) return bytes_.data() + at_;
    const std::size_t over = (at_ - header_size) % size;
    const std::size_t gap = over ? size - over : 0;
    if (gap > remaining() || count > (remaining() - gap) / size) return nullptr;
    const std::byte* const first = bytes_.data() + at_ + gap;
    at_ += gap + count * size;
    return first;
  }
  template <class T>
  bool number(T& value) {
    const std::byte* const first = take(sizeof(T), 1);
    if (!first) return false;
    copy(first, sizeof(T), 1, reinterpret_cast<std::byte*>(&value));
    return true;
  }
  /// Numbers in this machine's order.
  void copy(const std::byte* from, std::size_t size, std::size_t count, std::byte* to) const {
    if (!swapped_ || size == 1) return void(count && std::memcpy(to, from, size * count));
    for (std::size_t i = 0; i < count; ++i, from += size, to += size)
      std::reverse_copy(from, from + size, to);
  }
  bool text(std::string_view& out) {
    std::uint32_t size = 0;
    if (!number(size)) return false;
    if (size == 0) return out = {}, true;  // some writers leave out the NUL of an empty string
    const std::byte* const first = take(1, size);
    if (!first || first[size - 1] != std::byte{0}) return false;
    out = {reinterpret_cast<const char*>(first), size - 1};
    return true;
  }
  /// The count of a field's values. False: there are not as many bytes, or more values than the field may have.
  bool count(const MessageField& field, std::size_t& out) {
    out = field.count == Count::array ? field.length : 1;
    if (field.count == Count::sequence) {
      std::uint32_t size = 0;
      if (!number(size) || (field.length && size > field.length)) return false;
      out = size;
    }
    const std::size_t least = field.type == Wire::message  ? field.message->least
                              : field.type == Wire::string ? 4
                                                           : size_of(field.type);
    return out <= remaining() / least;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool swapped_ = false;
};

Error broken(const MessageField& field) {
  return {"CDR ends within '" + field.name + "', or its length is wrong"};
}

Status read_in(const MessageInfo& info, Source& source, void* object) {
  if (info.is_time) {
    RosTime time{};
    if (!source.number(time.sec) || !source.number(time.nanosec)) return broken(info.fields[0]);
    *static_cast<Time*>(object) = from_ros(time);
    return {};
  }
  if (info.fields.empty())
    return source.take(1, 1) ? Status() : Status(Error{"CDR ends within " + info.name});
  for (const MessageField& field : info.fields) {
    auto* place = static_cast<std::byte*>(object) + field.offset;
    std::size_t count = 0;
    if (!source.count(field, count)) return broken(field);
    if (field.count == Count::sequence) place = static_cast<std::byte*>(field.vector->remade(place, count));
    if (const std::size_t size = size_of(field.type)) {
      const std::byte* const first = source.take(size, count);
      if (!first) return broken(field);
      source.copy(first, size, count, place);
      if (field.type == Wire::boolean)  // any bit makes it true, and the byte a bool
        for (std::size_t i = 0; i < count; ++i) place[i] = std::byte{place[i] != std::byte{0}};
      continue;
    }
    for (std::size_t i = 0; i < count; ++i, place += field.stride) {
      if (field.type == Wire::message) {
        SL_TRY(read_in(*field.message, source, place));
      } else {
        std::string_view text;
        if (!source.text(text)) return broken(field);
        reinterpret_cast<std::string*>(place)->assign(text);
      }
    }
  }
  return {};
}

Status walk(const MessageInfo& info, Source& source, CdrVisitor& visitor, std::vector<std::byte>& scratch) {
  visitor.open(info);
  if (info.fields.empty() && !source.take(1, 1)) return Error{"CDR ends within " + info.name};
  for (const MessageField& field : info.fields) {
    std::size_t count = 0;
    if (!source.count(field, count)) return broken(field);
    visitor.field(field);
    if (const std::size_t size = size_of(field.type)) {
      const std::byte* first = source.take(size, count);
      if (!first) return broken(field);
      if (source.swapped()) {
        scratch.resize(size * count);
        source.copy(first, size, count, scratch.data());
        first = scratch.data();
      }
      if (field.count == Count::one) visitor.number(field.type, first);
      else visitor.numbers(field.type, {first, size * count});
      continue;
    }
    if (field.count != Count::one) visitor.open_list(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (field.type == Wire::message) {
        SL_TRY(walk(*field.message, source, visitor, scratch));
      } else {
        std::string_view text;
        if (!source.text(text)) return broken(field);
        visitor.text(text);
      }
    }
    if (field.count != Count::one) visitor.close_list();
  }
  visitor.close();
  return {};
}

template <class T>
double as_double(const std::byte* value) {
  T number;
  std::memcpy(&number, value, sizeof number);
  return static_cast<double>(number);
}

}  // namespace

void write_cdr(const MessageInfo& info, const void* message, std::vector<std::byte>& out) {
  CdrWriter(out).message(info, message);
}

Status read_cdr(const MessageInfo& info, std::span<const std::byte> bytes, void* message) {
  Source source(bytes);
  SL_TRY(source.begin());
  return read_in(info, source, message);
}

Status walk_cdr(const MessageInfo& info, std::span<const std::byte> bytes, CdrVisitor& visitor) {
  Source source(bytes);
  SL_TRY(source.begin());
  std::vector<std::byte> scratch;
  return walk(info, source, visitor, scratch);
}

double number_at(Wire type, const std::byte* value) {
  switch (type) {
    case Wire::boolean: return *value != std::byte{0} ? 1 : 0;
    case Wire::byte:
    case Wire::character:
    case Wire::uint8: return as_double<std::uint8_t>(value);
    case Wire::int8: return as_double<std::int8_t>(value);
    case Wire::int16: return as_double<std::int16_t>(value);
    case Wire::uint16: return as_double<std::uint16_t>(value);
    case Wire::int32: return as_double<std::int32_t>(value);
    case Wire::uint32: return as_double<std::uint32_t>(value);
    case Wire::int64: return as_double<std::int64_t>(value);
    case Wire::uint64: return as_double<std::uint64_t>(value);
    case Wire::float32: return as_double<float>(value);
    case Wire::float64: return as_double<double>(value);
    case Wire::string:
    case Wire::message: break;
  }
  SL_CHECK_MSG(false, "a string or a message is not a number");
  return 0;
}

}  // namespace sandlot
