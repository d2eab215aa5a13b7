#include "controllers/soccer_player/packet.h"

#include <algorithm>

namespace sandlot::controllers::soccer_player {
namespace {

constexpr std::uint8_t packet_version = 1;
constexpr std::size_t packet_size = 6 + 10 * 2 + 3 * 2;

void put16(std::vector<std::uint8_t>& out, std::uint16_t v) {
  out.push_back(static_cast<std::uint8_t>(v & 0xff));
  out.push_back(static_cast<std::uint8_t>(v >> 8));
}
/// In units of 2 mm, so that 65 m fit.
void put_m(std::vector<std::uint8_t>& out, double m) {
  const double units = std::clamp(m * 500, -32767.0, 32767.0);
  put16(out, static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lrint(units))));
}
void put_xy(std::vector<std::uint8_t>& out, Vec3 v) {
  put_m(out, v.x);
  put_m(out, v.y);
}
void put_ticks(std::vector<std::uint8_t>& out, double hundredths) {
  put16(out, static_cast<std::uint16_t>(std::lrint(std::clamp(hundredths, 0.0, 65535.0))));
}

struct Reader {
  std::span<const std::uint8_t> bytes;
  std::size_t at = 0;
  std::uint8_t byte() { return bytes[at++]; }
  std::uint16_t u16() {
    const auto low = byte(), high = byte();
    return static_cast<std::uint16_t>(low | high << 8);
  }
  double metres() { return static_cast<std::int16_t>(u16()) / 500.0; }
  Vec3 xy() {
    const double x = metres();
    return {x, metres(), 0};
  }
};

}  // namespace

void write_packet(std::vector<std::uint8_t>& out, const Mate& self, double now_s) {
  out.clear();
  out.push_back('S');
  out.push_back('P');
  out.push_back(packet_version);
  out.push_back(static_cast<std::uint8_t>(self.number));
  out.push_back(static_cast<std::uint8_t>(self.role));
  out.push_back(static_cast<std::uint8_t>((self.holds ? 1u : 0u) | (self.ball_known ? 2u : 0u)));
  for (const Vec3 each : {self.at, self.velocity, self.target, self.ball, self.ball_velocity})
    put_xy(out, each);
  put_ticks(out, 100 * self.ball_std_m);
  put_ticks(out, 100 * (now_s - self.ball_seen_s));
  put_ticks(out, 100 * self.cost_s);
}

std::optional<Mate> read_packet(std::span<const std::uint8_t> bytes, double now_s) {
  if (bytes.size() != packet_size || bytes[0] != 'S' || bytes[1] != 'P' || bytes[2] != packet_version)
    return {};
  Reader in{bytes, 3};
  Mate mate;
  mate.number = in.byte();
  const std::uint8_t role = in.byte(), flags = in.byte();
  if (mate.number < 1 || mate.number > 99 || role > static_cast<std::uint8_t>(Role::none)) return {};
  mate.role = static_cast<Role>(role);
  mate.holds = (flags & 1u) != 0;
  mate.ball_known = (flags & 2u) != 0;
  for (Vec3* const each : {&mate.at, &mate.velocity, &mate.target, &mate.ball, &mate.ball_velocity})
    *each = in.xy();
  mate.ball_std_m = 0.01 * in.u16();
  mate.ball_seen_s = now_s - 0.01 * in.u16();
  mate.cost_s = 0.01 * in.u16();
  mate.heard_s = now_s;
  return mate;
}

}  // namespace sandlot::controllers::soccer_player
