#pragma once
/// The bytes of a fuzzer as orders, numbers and times; 0 when they have run out.
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>

namespace sandlot::fuzz {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return at_ >= size_; }
  std::uint8_t byte() { return empty() ? std::uint8_t{0} : data_[at_++]; }
  std::int64_t whole() {
    std::uint64_t out = 0;
    for (int i = 0; i < 8; ++i) out = out << 8 | byte();
    return static_cast<std::int64_t>(out);
  }
  /// Mostly numbers as they are measured, within 8; some that break things, and any bits.
  double number() {
    static constexpr double odd[] = {0.0,
                                     -0.0,
                                     1e-300,
                                     1e6,
                                     1e9,
                                     -1e9,
                                     1e10,
                                     1e300,
                                     -1e300,
                                     1.5707963267948966,
                                     3.2,
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::denorm_min()};
    const std::uint8_t which = byte();
    if (which < std::size(odd)) return odd[which];
    if (which < std::size(odd) + 2) {
      const std::int64_t bits = whole();
      double out = 0;
      std::memcpy(&out, &bits, sizeof out);
      return out;
    }
    return (which - 128) / 16.0;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

}  // namespace sandlot::fuzz
