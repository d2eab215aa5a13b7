#pragma once
/// Orders of a RoBIOS program as it wrote them into the shared memory: the decoder, which believes nothing.
///
/// Refused   what is no order of slot.h, has another size than its kind, holds a number that is not finite or lies beyond what a
///           robot can mean, or comes too often in one turn. It is left out and counted; the orders behind it are read if
///           their beginning can be found.
/// Limits    per turn: 1000 orders, of them 64 rectangles of the screen, 64 sounds, 256 messages, 256 moves, 100 notes.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "programs/robios/slot.h"

namespace sandlot::programs::robios {

struct ScreenPixels {
  sandlot::robios::ScreenOrder at;
  std::span<const std::byte> rgb;  ///< into the bytes that were read
};
struct ScreenLines {
  std::vector<std::string> menu, lines;
};
struct SoundNamed {
  sandlot::robios::SoundOrder tone;
  std::string name;
};
struct Packet {
  std::uint32_t to = 0;
  std::span<const std::byte> bytes;  ///< into the bytes that were read
};
struct ServoOrder {
  std::uint32_t number = 0;
  double value = 0;
};
struct PictureOrder {};
struct Note {
  std::string text;
};
using Order =
    std::variant<sandlot::robios::SpeedOrder, sandlot::robios::ManeuverOrder, sandlot::robios::PoseOrder,
                 sandlot::robios::ControlOrder, sandlot::robios::MotorOrder, ServoOrder, ScreenPixels,
                 ScreenLines, SoundNamed, Packet, sandlot::robios::EntityPose, PictureOrder, Note>;

struct Orders {
  std::vector<Order> orders;                            ///< in their order
  std::optional<sandlot::robios::WaitOrder> wait = {};  ///< the last one
  std::optional<std::int32_t> finished = {};
  std::uint32_t refused = 0;
  std::string why = {};  ///< the first was refused
};

/// `bytes` must outlive what is returned.
Orders read_orders(std::span<const std::byte> bytes);

}  // namespace sandlot::programs::robios
