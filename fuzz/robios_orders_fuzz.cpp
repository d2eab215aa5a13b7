/// Any bytes as the orders of a RoBIOS program: what is read lies within its limits, and commands of it can be carried out by no
/// robot but one that has the devices.
#include <cmath>

#include "base/check.h"
#include "programs/robios/orders.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  using namespace sandlot::programs::robios;
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  const Orders read = read_orders(bytes);
  SL_CHECK(read.orders.size() <= 1000);
  SL_CHECK((read.refused == 0) == read.why.empty());
  const auto within = [&](std::span<const std::byte> part) {
    return part.empty() ||
           (part.data() >= bytes.data() && part.data() + part.size() <= bytes.data() + bytes.size());
  };
  for (const Order& order : read.orders) {
    if (const auto* speed = std::get_if<sandlot::robios::SpeedOrder>(&order))
      SL_CHECK(std::isfinite(speed->v_mps) && std::isfinite(speed->w_radps));
    if (const auto* motor = std::get_if<sandlot::robios::MotorOrder>(&order))
      SL_CHECK(motor->number < sandlot::robios::most_motors && std::isfinite(motor->value));
    if (const auto* servo = std::get_if<ServoOrder>(&order)) SL_CHECK(servo->value >= 0 && servo->value <= 1);
    if (const auto* pixels = std::get_if<ScreenPixels>(&order)) {
      SL_CHECK(within(pixels->rgb));
      SL_CHECK(pixels->rgb.size() == std::size_t{pixels->at.width} * pixels->at.height * 3);
    }
    if (const auto* packet = std::get_if<Packet>(&order))
      SL_CHECK(within(packet->bytes) && packet->bytes.size() <= sandlot::robios::most_radio_bytes);
    if (const auto* lines = std::get_if<ScreenLines>(&order))
      SL_CHECK(lines->menu.size() <= 4 && lines->lines.size() <= 200);
  }
  return 0;
}
