#pragma once
/// State as little-endian bytes: what hashes cover and snapshots hold.
///
/// write(w, x) and read(r, x) handle numbers, enumerations, strings, vectors, optionals, plain structs
/// without padding and structs with a field list. Reading checks every length: bytes may come from a damaged
/// file.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/fields.h"
#include "base/node.h"

namespace sandlot {

/// Appends bytes to a buffer whose capacity is reused.
class ByteWriter {
 public:
  ByteWriter() = default;
  ByteWriter(const ByteWriter&) = default;
  ByteWriter(ByteWriter&& other) noexcept
      : bytes_(std::move(other.bytes_)), free_(std::exchange(other.free_, 0)) {}
  ByteWriter& operator=(ByteWriter other) noexcept {
    bytes_.swap(other.bytes_);
    std::swap(free_, other.free_);
    return *this;
  }
  ~ByteWriter() = default;

  void raw(const void* data, std::size_t size) {
    if (size == 0) return;
    if (free_ < size) make_room(size);
    std::memcpy(bytes_.data() + (bytes_.size() - free_), data, size);
    free_ -= size;
  }
  std::span<const std::byte> bytes() const { return {bytes_.data(), size()}; }
  /// To be moved from, or appended to.
  std::vector<std::byte>& buffer() {
    bytes_.resize(size());
    free_ = 0;
    return bytes_;
  }
  /// Writes over bytes that were written before, such as a size that is known only afterwards.
  template <class T>
  void patch(std::size_t at, const T& value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  std::size_t size() const { return bytes_.size() - free_; }
  void clear() { free_ = bytes_.size(); }

 private:
  /// In steps, so that a few bytes cost no more than their copy.
  void make_room(std::size_t size) {
    constexpr std::size_t least = 64, most = 65'536;
    const std::size_t used = bytes_.size() - free_;
    bytes_.resize(used + size + std::clamp(used, least, most));
    free_ = bytes_.size() - used;
  }
  std::vector<std::byte> bytes_;  ///< what was written, then `free_` bytes that were not
  std::size_t free_ = 0;
};

/// Reads what ByteWriter wrote. Once a read fails all later ones do, and ok() is false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}
  bool raw(void* data, std::size_t size) {
    if (!ok_ || rest_.size() < size) return ok_ = false;
    if (size) std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
    return true;
  }
  /// The next `size` bytes without a copy; empty and failed when there are fewer.
  std::span<const std::byte> take(std::size_t size) {
    if (!ok_ || rest_.size() < size) return ok_ = false, std::span<const std::byte>();
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  bool ok() const { return ok_; }
  void fail() { ok_ = false; }
  std::size_t remaining() const { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
};

/// Plain values whose bytes are their value: no padding, no pointers.
template <class T>
concept RawBytes = (std::is_floating_point_v<T> ||
                    (std::is_trivially_copyable_v<T> && std::has_unique_object_representations_v<T> &&
                     !std::is_pointer_v<T>)) &&
                   !Fielded<T>;

template <class T>
void write(ByteWriter& w, const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    write(w, static_cast<std::uint32_t>(value.size()));
    w.raw(value.data(), value.size());
  } else if constexpr (is_vector<T>::value) {
    write(w, static_cast<std::uint32_t>(value.size()));
    if constexpr (std::is_same_v<T, std::vector<bool>>) {
      for (const bool b : value) write(w, static_cast<std::uint8_t>(b));
    } else if constexpr (RawBytes<typename T::value_type>) {
      w.raw(value.data(), value.size() * sizeof(typename T::value_type));
    } else {
      for (const auto& element : value) write(w, element);
    }
  } else if constexpr (is_optional<T>::value) {
    write(w, static_cast<std::uint8_t>(value.has_value()));
    if (value) write(w, *value);
  } else if constexpr (is_array<T>::value) {
    if constexpr (RawBytes<typename T::value_type>) w.raw(value.data(), sizeof value);
    else
      for (const auto& element : value) write(w, element);
  } else if constexpr (RawBytes<T>) {
    w.raw(&value, sizeof value);
  } else if constexpr (FixedVector<T>) {
    std::array<std::remove_cvref_t<decltype(value[0])>, T::extent> elements;
    for (std::size_t i = 0; i < T::extent; ++i) elements[i] = value[i];
    write(w, elements);
  } else {
    static_assert(Fielded<T>, "state must be plain values or have a field list");
    T::fields(value, [&](const Field&, const auto& member) { write(w, member); });
  }
}

template <class T>
void read(ByteReader& r, T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    std::uint32_t size = 0;
    read(r, size);
    const auto bytes = r.take(size);
    value.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  } else if constexpr (is_vector<T>::value) {
    std::uint32_t size = 0;
    read(r, size);
    // Every element takes at least one byte, a raw one its size: a damaged length cannot ask for more than
    // there is.
    constexpr std::size_t least = RawBytes<typename T::value_type> ? sizeof(typename T::value_type) : 1;
    if (!r.ok() || size > r.remaining() / least) return r.fail();
    value.clear();
    value.resize(size);
    if constexpr (std::is_same_v<T, std::vector<bool>>) {
      for (std::size_t i = 0; i < size; ++i) {
        std::uint8_t b = 0;
        read(r, b);
        value[i] = b != 0;
      }
    } else if constexpr (RawBytes<typename T::value_type>) {
      r.raw(value.data(), value.size() * sizeof(typename T::value_type));
    } else {
      for (auto& element : value) read(r, element);
    }
  } else if constexpr (is_optional<T>::value) {
    std::uint8_t present = 0;
    read(r, present);
    if (present) read(r, value.emplace());
    else value.reset();
  } else if constexpr (std::is_same_v<T, bool>) {
    std::uint8_t b = 0;
    r.raw(&b, 1);
    value = b != 0;
  } else if constexpr (NamedEnum<T>) {
    T taken{};
    r.raw(&taken, sizeof taken);
    for (const auto& entry : enum_names(taken))
      if (entry.value == taken) return void(value = taken);
    r.fail();  // no enumerator has this value
  } else if constexpr (is_array<T>::value) {
    for (auto& element : value) read(r, element);
  } else if constexpr (RawBytes<T>) {
    r.raw(&value, sizeof value);
  } else if constexpr (FixedVector<T>) {
    for (std::size_t i = 0; i < T::extent; ++i) read(r, value[i]);
  } else {
    static_assert(Fielded<T>, "state must be plain values or have a field list");
    T::fields(value, [&](const Field&, auto& member) { read(r, member); });
  }
}

/// Calls visit(element) for each struct with fields in `member`: itself, what an optional holds, a list's
/// elements.
template <class Member, class Visit>
void for_each_struct(Member& member, Visit&& visit) {
  using T = std::remove_cvref_t<Member>;
  if constexpr (Fielded<T>) {
    visit(member);
  } else if constexpr (is_optional<T>::value || is_vector<T>::value) {
    if constexpr (!Fielded<typename T::value_type>) return;
    else if constexpr (is_vector<T>::value)
      for (auto& element : member) visit(element);
    else if (member) visit(*member);
  }
}

/// The tunable fields of a spec, nested ones included: the part of a spec that is State. How many there are
/// in lists and optional structs is fixed when the spec was read.
template <Fielded Spec>
void write_tunables(ByteWriter& w, const Spec& spec) {
  Spec::fields(spec, [&](const Field& f, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if (f.flags & Field::apart) return;
    if (f.flags & Field::tunable) {
      if constexpr (!std::is_same_v<Member, Node>) write(w, member);
    } else {
      for_each_struct(member, [&](const auto& part) { write_tunables(w, part); });
    }
  });
}

/// Fails on numbers outside their ranges too: code trusts a spec, and these bytes may be forged.
template <Fielded Spec>
void read_tunables(ByteReader& r, Spec& spec) {
  Spec::fields(spec, [&](const Field& f, auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if (f.flags & Field::apart) return;
    if (f.flags & Field::tunable) {
      if constexpr (!std::is_same_v<Member, Node>) read(r, member);
      if constexpr (std::is_arithmetic_v<Member> && !std::is_same_v<Member, bool>) {
        const auto number = static_cast<double>(member);
        if (!(number >= f.min && number <= f.max)) r.fail();
      }
    } else {
      for_each_struct(member, [&](auto& part) { read_tunables(r, part); });
    }
  });
}

}  // namespace sandlot
