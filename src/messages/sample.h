#pragma once
/// For tests and fuzzers: any message filled so that no two of its values are alike.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/time.h"
#include "messages/info.h"

namespace sandlot {

template <class T>
void put_number(std::byte* to, double value) {
  const T number = static_cast<T>(value);
  std::memcpy(to, &number, sizeof number);
}

/// `count` goes up by one with every value, so that a swap of two of them shows. Sequences have two or three elements.
inline void fill_sample(const MessageInfo& info, void* message, int& count) {
  if (info.is_time) {
    ++count;
    *static_cast<Time*>(message) = {(count % 2 ? 1 : -1) * (count * Time::per_s + 123'456'789)};
    return;
  }
  for (const MessageField& field : info.fields) {
    auto* place = static_cast<std::byte*>(message) + field.offset;
    std::size_t size = field.count == MessageField::Count::array ? field.length : 1;
    if (field.count == MessageField::Count::sequence) {
      size = 2 + static_cast<std::size_t>(count % 2);
      place = static_cast<std::byte*>(field.vector->remade(place, size));
    }
    for (std::size_t i = 0; i < size; ++i, place += field.stride) {
      if (field.type == Wire::message) {
        fill_sample(*field.message, place, count);
        continue;
      }
      ++count;
      const double sign = count % 2 ? 1 : -1;
      switch (field.type) {
        case Wire::boolean: *place = std::byte{count % 3 == 0}; break;
        case Wire::byte:
        case Wire::character:
        case Wire::uint8: put_number<std::uint8_t>(place, (200 + count) % 256); break;
        case Wire::int8: put_number<std::int8_t>(place, sign * (count % 128)); break;
        case Wire::int16: put_number<std::int16_t>(place, sign * (300 + count)); break;
        case Wire::uint16: put_number<std::uint16_t>(place, 40'000 + count); break;
        case Wire::int32: put_number<std::int32_t>(place, sign * (70'000 + count)); break;
        case Wire::uint32: put_number<std::uint32_t>(place, 3'000'000'000.0 + count); break;
        case Wire::int64: put_number<std::int64_t>(place, sign * (5'000'000'000'000.0 + count)); break;
        case Wire::uint64:
          put_number<std::uint64_t>(place, 18'000'000'000'000'000'000.0 + 4096.0 * count);
          break;
        case Wire::float32: put_number<float>(place, sign * count / 7); break;
        case Wire::float64: put_number<double>(place, sign * count / 7); break;
        case Wire::string:
          *reinterpret_cast<std::string*>(place) = (count == 1 ? "\xC3\xA4 " : "\"text\"\n") +
                                                   std::to_string(count);
          break;
        case Wire::message: break;
      }
    }
  }
}

}  // namespace sandlot
