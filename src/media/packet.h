#pragma once
/// Packet: payload of the emissions and deliveries of media that carry data from device to device (radio, infrared).
///
/// Bytes    the head as it lies in memory, the names, the data.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/vec3.h"

namespace sandlot {

inline constexpr std::size_t most_packet_data = 65'535;  ///< [B] of one packet
inline constexpr std::size_t most_packet_name = 255;     ///< [B] of the sender's and the receiver's name

struct PacketHead {
  std::uint64_t number = 0;  ///< packets of this emitter before it: key of its random numbers
  double x_m = 0, y_m = 0,
         z_m = 0;                ///< where it was emitted, in W; for devices that measure range and bearing
  double lambertian_order = 0;   ///< focus of a beam about the emission's direction; 0: the same all round
  std::uint32_t wrong_bits = 0;  ///< of the data, as delivered
  std::uint16_t from_size = 0, to_size = 0;
  friend constexpr bool operator==(const PacketHead&, const PacketHead&) = default;
};
static_assert(sizeof(PacketHead) == 48, "no padding: its bytes are State");

/// Points into the bytes of a packet, so that a reader takes from its head what he needs.
struct PacketView {
  const std::uint8_t* bytes = nullptr;
  std::string_view from, to;
  std::span<const std::uint8_t> data;

  PacketHead head() const {
    PacketHead out;
    std::memcpy(&out, bytes, sizeof out);
    return out;
  }
  std::uint64_t number() const { return at<std::uint64_t>(offsetof(PacketHead, number)); }
  std::uint32_t wrong_bits() const { return at<std::uint32_t>(offsetof(PacketHead, wrong_bits)); }
  /// Where it was emitted.
  Vec3 point() const {
    return {at<double>(offsetof(PacketHead, x_m)), at<double>(offsetof(PacketHead, y_m)),
            at<double>(offsetof(PacketHead, z_m))};
  }

 private:
  template <class T>
  T at(std::size_t offset) const {
    T out;
    std::memcpy(&out, bytes + offset, sizeof out);
    return out;
  }
  friend std::optional<PacketView> read_packet(std::span<const std::uint8_t> bytes);
};

/// Replaces `out` by the bytes of a packet. @pre names and data within the limits above
inline void write_packet(PacketHead head, std::string_view from, std::string_view to,
                         std::span<const std::uint8_t> data, std::vector<std::byte>& out) {
  head.from_size = static_cast<std::uint16_t>(from.size());
  head.to_size = static_cast<std::uint16_t>(to.size());
  out.resize(sizeof head + from.size() + to.size() + data.size());
  std::byte* at = out.data();
  const auto put = [&](const void* bytes, std::size_t size) {
    if (size > 0) std::memcpy(at, bytes, size);
    at += size;
  };
  put(&head, sizeof head);
  put(from.data(), from.size());
  put(to.data(), to.size());
  put(data.data(), data.size());
}

/// Nothing: the bytes are not a packet. The view points into them.
inline std::optional<PacketView> read_packet(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < sizeof(PacketHead)) return std::nullopt;
  PacketView packet;
  packet.bytes = bytes.data();
  const std::size_t from = packet.at<std::uint16_t>(offsetof(PacketHead, from_size)),
                    to = packet.at<std::uint16_t>(offsetof(PacketHead, to_size));
  if (from > most_packet_name || to > most_packet_name) return std::nullopt;
  if (bytes.size() < sizeof(PacketHead) + from + to) return std::nullopt;
  const auto names = bytes.subspan(sizeof(PacketHead));
  packet.from = {reinterpret_cast<const char*>(names.data()), from};
  packet.to = {reinterpret_cast<const char*>(names.data()) + from, to};
  packet.data = names.subspan(from + to);
  if (packet.data.size() > most_packet_data) return std::nullopt;
  return packet;
}

/// Writes another head into the bytes of a packet. @pre read_packet() takes them
inline void write_head(const PacketHead& head, std::span<std::uint8_t> bytes) {
  std::memcpy(bytes.data(), &head, sizeof head);
}

}  // namespace sandlot
