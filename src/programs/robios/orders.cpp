#include "programs/robios/orders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <initializer_list>

namespace sandlot::programs::robios {
namespace {

using namespace sandlot::robios;

/// Beyond these no robot drives and no world reaches.
constexpr double most_m = 1e6, most_rad = 1e6, most_speed = 1e6, most_s = 1e6, most_Hz = 1e6;
constexpr std::uint32_t most_pixels = 4096;  ///< of a screen's side
constexpr std::size_t most_text_bytes = 400, most_text_lines = 200, menu_labels = 4;
constexpr std::size_t most_orders = 1000, most_notes = 100;

bool all_within(double most, std::initializer_list<double> numbers) {
  for (const double each : numbers)
    if (!(std::abs(each) <= most)) return false;
  return true;
}

std::string text_of(std::span<const std::byte> bytes, std::size_t most) {
  std::string out;
  for (const std::byte each : bytes.first(std::min(bytes.size(), most))) {
    const auto c = static_cast<unsigned char>(each);
    if (c >= 0x20 && c < 0x7f) out += static_cast<char>(c);
    else if (c >= 0xa0) out += {static_cast<char>(0xc0 | c >> 6), static_cast<char>(0x80 | (c & 0x3f))};
    else out += ' ';
  }
  return out;
}

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  Orders read() {
    std::size_t at = 0;
    while (bytes_.size() - at >= sizeof(OrderHead) && !out_.finished) {
      OrderHead head;
      std::memcpy(&head, bytes_.data() + at, sizeof head);
      at += sizeof head;
      if (head.size > bytes_.size() - at) {
        refuse("an order is longer than the orders");
        return std::move(out_);
      }
      if (++count_ > most_orders) {
        refuse("a turn has more than 1000 orders");
        return std::move(out_);
      }
      take(head.kind, bytes_.subspan(at, head.size));
      const std::size_t whole = (std::size_t{head.size} + 7) / 8 * 8;
      at += std::min(whole, bytes_.size() - at);
    }
    if (at < bytes_.size() && !out_.finished) refuse("bytes are left behind the last order");
    return std::move(out_);
  }

 private:
  void refuse(const char* why) {
    ++out_.refused;
    if (out_.why.empty()) out_.why = why;
  }
  bool too_many(OrderKind kind, std::uint32_t most) {
    const bool many = ++counts_[static_cast<std::size_t>(kind)] > most;
    if (many) refuse("a turn has too many orders of one kind");
    return many;
  }
  /// Exactly one T, or at its front.
  template <class T>
  std::optional<T> front(std::span<const std::byte> payload, bool exactly = true) {
    if (exactly ? payload.size() != sizeof(T) : payload.size() < sizeof(T)) {
      refuse("an order has another size than its kind");
      return std::nullopt;
    }
    T value;
    std::memcpy(&value, payload.data(), sizeof(T));
    return value;
  }
  void add_if(bool sound, Order order) {
    if (sound) out_.orders.push_back(std::move(order));
    else refuse("an order holds a number that is not finite or too large");
  }

  void take(OrderKind kind, std::span<const std::byte> payload) {
    switch (kind) {
      case OrderKind::speed:
        if (const auto o = front<SpeedOrder>(payload))
          add_if(all_within(most_speed, {o->v_mps, o->w_radps}), *o);
        return;
      case OrderKind::maneuver:
        if (const auto o = front<ManeuverOrder>(payload))
          add_if(o->kind <= 4 && all_within(most_m, {o->distance_m, o->x_m, o->y_m}) &&
                     all_within(most_rad, {o->angle_rad}) &&
                     all_within(most_speed, {o->speed_mps, o->turning_rate_radps}) && o->speed_mps >= 0 &&
                     o->turning_rate_radps >= 0,
                 *o);
        return;
      case OrderKind::set_pose:
        if (const auto o = front<PoseOrder>(payload))
          add_if(all_within(most_m, {o->x_m, o->y_m}) && all_within(most_rad, {o->phi_rad}), *o);
        return;
      case OrderKind::control:
        if (const auto o = front<ControlOrder>(payload))
          add_if(o->on <= 1 && all_within(most_speed, {o->vv, o->tv, o->vw, o->tw}), *o);
        return;
      case OrderKind::motor:
        if (const auto o = front<MotorOrder>(payload))
          add_if(o->number < most_motors && o->mode <= 1 && all_within(most_speed, {o->value}), *o);
        return;
      case OrderKind::servo:
        if (const auto o = front<MotorOrder>(payload))
          add_if(o->number < most_servos && o->value >= 0 && o->value <= 1, ServoOrder{o->number, o->value});
        return;
      case OrderKind::screen: return take_pixels(payload);
      case OrderKind::text: return take_lines(payload);
      case OrderKind::sound: {
        const auto o = front<SoundOrder>(payload, false);
        if (!o || too_many(kind, 64)) return;
        add_if(o->frequency_Hz >= 0 && o->frequency_Hz <= most_Hz && o->duration_s >= 0 &&
                   o->duration_s <= most_s,
               SoundNamed{*o, text_of(payload.subspan(sizeof(SoundOrder)), most_text_bytes)});
        return;
      }
      case OrderKind::radio: {
        const auto o = front<RadioOrder>(payload, false);
        if (!o || too_many(kind, 256)) return;
        const auto bytes = payload.subspan(sizeof(RadioOrder));
        if (o->size != bytes.size() || bytes.size() > most_radio_bytes)
          return refuse("a radio message is too long, or not as long as it says");
        out_.orders.emplace_back(Packet{o->to, bytes});
        return;
      }
      case OrderKind::set_entity: {
        const auto o = front<EntityPose>(payload);
        if (!o || too_many(kind, 256)) return;
        add_if(all_within(most_m, {o->x_m, o->y_m, o->z_m}) && all_within(most_rad, {o->phi_rad}), *o);
        return;
      }
      case OrderKind::picture:
        if (!payload.empty()) return refuse("an order has another size than its kind");
        if (!too_many(kind, 64)) out_.orders.emplace_back(PictureOrder{});
        return;
      case OrderKind::wait:
        if (const auto o = front<WaitOrder>(payload)) out_.wait = *o;
        return;
      case OrderKind::note:
        if (!too_many(kind, most_notes)) out_.orders.emplace_back(Note{text_of(payload, 1000)});
        return;
      case OrderKind::finished:
        if (const auto o = front<std::int32_t>(payload)) out_.finished = *o;
        return;
    }
    refuse("there is no order of that kind");
  }

  void take_pixels(std::span<const std::byte> payload) {
    const auto o = front<ScreenOrder>(payload, false);
    if (!o || too_many(OrderKind::screen, 64)) return;
    const auto rgb = payload.subspan(sizeof(ScreenOrder));
    if (o->width == 0 || o->height == 0 || o->width > most_pixels || o->height > most_pixels ||
        o->x > most_pixels - o->width || o->y > most_pixels - o->height ||
        rgb.size() != std::size_t{o->width} * o->height * 3)
      return refuse("a rectangle of the screen is none");
    out_.orders.emplace_back(ScreenPixels{*o, rgb});
  }

  void take_lines(std::span<const std::byte> payload) {
    if (too_many(OrderKind::text, 64)) return;
    ScreenLines lines;
    std::size_t count = 0;
    while (!payload.empty() && count < menu_labels + most_text_lines) {
      std::size_t length = 0;
      while (length < payload.size() && payload[length] != std::byte{0}) ++length;
      if (length == payload.size()) return refuse("a text has no end");
      (count < menu_labels ? lines.menu : lines.lines)
          .push_back(text_of(payload.first(length), most_text_bytes));
      payload = payload.subspan(length + 1);
      ++count;
    }
    if (!payload.empty()) return refuse("a screen has more than 200 lines");
    out_.orders.emplace_back(std::move(lines));
  }

  std::span<const std::byte> bytes_;
  Orders out_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, 16> counts_{};
};

}  // namespace

Orders read_orders(std::span<const std::byte> bytes) { return Reader(bytes).read(); }

}  // namespace sandlot::programs::robios
