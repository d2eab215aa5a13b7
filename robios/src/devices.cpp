#include "devices.h"

#include <algorithm>
#include <cctype>
#include <climits>
#include <cmath>

#include "tasks.h"

namespace robios {
namespace {

/// What became of the latest maneuver.
struct Way {
  bool active = false;
  std::uint64_t number = 0;  ///< that the drive will give it
  std::uint64_t turn = 0;    ///< in which it was ordered
  std::int64_t ordered_ns = 0;
  ManeuverOrder order{};
} way;

PoseOrder posed{};
std::uint64_t posed_turn = 0;

bool begun() { return machine.turns != way.turn && machine.senses().maneuvers >= way.number; }

std::string plain(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      result += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return result;
}

}  // namespace

int to_int(double value) {
  if (!(value == value)) return 0;
  const double rounded = std::nearbyint(value);
  if (rounded >= static_cast<double>(INT_MAX)) return INT_MAX;
  if (rounded <= static_cast<double>(INT_MIN)) return INT_MIN;
  return static_cast<int>(rounded);
}

double wrap(double angle_rad) {
  if (!std::isfinite(angle_rad)) return 0;
  const double a = std::remainder(angle_rad, 2 * pi);
  return a <= -pi ? pi : a;
}
int degrees(double angle_rad) { return to_int(wrap(angle_rad) / radians_per_degree); }

std::uint32_t take_key() {
  if (machine.keys.empty()) return 0;
  const std::uint32_t key = machine.keys.front();
  machine.keys.pop_front();
  return key >= 1 && key <= 32 ? 1u << (key - 1) : 0;
}

std::uint32_t await_key(std::uint32_t mask) {
  if (!machine.robot().has_keys) note_once("keys", "the program waits for a key, and the robot has none");
  for (;;) {
    if (!wait_for(
            never, wake_key, [] { return !machine.keys.empty(); }, Others::by_mode))
      return 0;
    const std::uint32_t key = take_key();
    if (key & mask) return key;
  }
}

std::optional<KeyPress> take_touch() {
  if (machine.touches.empty()) return {};
  const KeyPress touch = machine.touches.front();
  machine.touches.pop_front();
  return touch;
}

KeyPress await_touch() {
  wait_for(
      never, wake_key, [] { return !machine.touches.empty(); }, Others::by_mode);
  return take_touch().value_or(KeyPress{});
}

bool has_drive() {
  if (machine.robot().drive != Drive::none) return true;
  note_once("drive", "the program drives, and the robot has no drive");
  return false;
}

void set_speed(double v_mps, double w_radps) {
  way.active = false;
  order(OrderKind::speed, SpeedOrder{v_mps, w_radps});
}

PoseOrder odometry() {
  const Senses& s = machine.senses();
  return posed_turn == machine.turns ? posed : PoseOrder{s.x_m, s.y_m, s.phi_rad};
}

void expect_pose(double x_m, double y_m, double phi_rad) {
  posed = {x_m, y_m, phi_rad};
  posed_turn = machine.turns;
}

void begin_maneuver(const ManeuverOrder& maneuver) {
  order(OrderKind::maneuver, maneuver);
  // Of several in one turn the last one counts; one that was ordered earlier and has not begun comes before.
  const bool earlier = way.active && way.turn != machine.turns && !begun();
  way.number = (earlier ? way.number : machine.senses().maneuvers) + 1;
  way.active = true;
  way.turn = machine.turns;
  way.ordered_ns = machine.clock_ns;
  way.order = maneuver;
}

bool maneuver_done() {
  if (!way.active) return true;
  if (begun()) {
    if (machine.senses().maneuver_done) way.active = false;
  } else if (machine.turns != way.turn && machine.clock_ns - way.ordered_ns > second) {
    way.active = false;
    note_once("maneuver", "the drive has not begun a way that it was given");
  }
  return !way.active;
}

void await_maneuver() {
  while (!maneuver_done()) {
    if (tasks.current->killed) return;
    wait_for(machine.clock_ns + second, wake_drive_done, maneuver_done, Others::by_mode);
  }
}

double remaining_m() {
  if (maneuver_done()) return 0;
  if (begun()) return std::abs(machine.senses().remaining_m);
  return way.order.kind == to_point ? std::hypot(way.order.x_m, way.order.y_m)
                                    : std::abs(way.order.distance_m);
}

double remaining_rad() {
  if (maneuver_done()) return 0;
  return std::abs(begun() ? machine.senses().remaining_rad : way.order.angle_rad);
}

bool last_was_turn() { return way.order.kind == turn; }

int distance_mm(int index) {
  const Robot& robot = machine.robot();
  if (index < 0 || index >= static_cast<int>(std::min<std::size_t>(robot.distances, most_distances)))
    return out_of_range_mm;
  const double m = machine.senses().distance_m[index];
  return m >= 0 && m < out_of_range_mm * 1e-3 ? to_int(m * 1e3) : out_of_range_mm;
}

int distance_raw(int index) {
  const int mm = distance_mm(index);
  return mm == out_of_range_mm ? 0 : to_int(1023.0 * 80 / (80 + mm));
}

int distance_index(int number) {
  const Robot& robot = machine.robot();
  for (int i = 0; i < static_cast<int>(std::min<std::size_t>(robot.distances, most_distances)); i++) {
    if (robot.distance_numbers[i] == number) return i;
  }
  return -1;
}

int index_of(const char (*names)[name_size], std::size_t count, std::string_view name) {
  const std::string wanted = plain(name);
  if (wanted.empty()) return -1;
  for (std::size_t i = 0; i < count; i++) {
    std::string_view own(names[i], name_size);
    own = own.substr(0, own.find('\0'));
    if (plain(own) == wanted) return static_cast<int>(i);
  }
  return -1;
}

void drive_motor(int index, std::uint32_t mode, double value) {
  order(OrderKind::motor, MotorOrder{static_cast<std::uint32_t>(index), mode, value});
}

int stalled_motors() { return static_cast<int>(machine.senses().stalled); }
double battery_V() { return machine.robot().has_battery ? machine.senses().battery_V : 0; }
int battery_level() { return std::clamp(to_int(battery_V() / 12 * 1023), 0, 1023); }

bool take_picture() {
  if (!machine.robot().has_camera) {
    note_once("camera", "the program takes a picture, and the robot has no camera");
    return false;
  }
  // Not a picture of before the call: one that is taken after this turn.
  order(OrderKind::picture, nullptr, 0);
  const std::uint64_t before = machine.senses().image_count, asked_in = machine.turns;
  const bool came = wait_for(
      machine.clock_ns + 2 * second, wake_picture,
      [&] { return machine.turns != asked_in && machine.senses().image_count > before; }, Others::by_mode);
  if (!came) note_once("picture", "the camera took no picture within two seconds");
  return came;
}

void copy_picture(std::uint8_t* rgb, int width, int height) {
  const Senses& s = machine.senses();
  const std::size_t w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  const std::size_t sw = s.image_width, sh = s.image_height;
  if (sw == 0 || sh == 0 || sw > most_image_bytes || sh > most_image_bytes ||
      sw * sh * 3 > most_image_bytes) {
    std::fill_n(rgb, w * h * 3, std::uint8_t{0});
    return;
  }
  for (std::size_t y = 0; y < h; y++) {
    const std::size_t top = y * sh / h, bottom = std::max((y + 1) * sh / h, top + 1);
    for (std::size_t x = 0; x < w; x++) {
      const std::size_t left = x * sw / w, right = std::max((x + 1) * sw / w, left + 1);
      std::uint64_t sum[3] = {0, 0, 0};
      for (std::size_t v = top; v < bottom; v++) {
        const std::uint8_t* p = s.image + (v * sw + left) * 3;
        for (std::size_t u = left; u < right; u++, p += 3) sum[0] += p[0], sum[1] += p[1], sum[2] += p[2];
      }
      const std::uint64_t n = (bottom - top) * (right - left);
      for (std::size_t c = 0; c < 3; c++)
        rgb[(y * w + x) * 3 + c] = static_cast<std::uint8_t>((sum[c] + n / 2) / n);
    }
  }
}

namespace {
std::int64_t sound_end_ns = 0;
std::uint64_t sound_turn = 0;
}  // namespace

void play(double frequency_Hz, double duration_s, std::string_view name) {
  if (!machine.robot().has_speaker) return;
  const SoundOrder head{frequency_Hz, duration_s};
  name = name.substr(0, 200);
  order(OrderKind::sound, &head, sizeof(head), name.data(), name.size());
  sound_end_ns = machine.clock_ns + static_cast<std::int64_t>(duration_s * 1e9);
  sound_turn = machine.turns;
}

bool silent() {
  if (!machine.robot().has_speaker) return true;
  return machine.clock_ns >= sound_end_ns && (machine.turns == sound_turn || !machine.senses().speaker_busy);
}

bool send_message(std::uint32_t to, const void* bytes, std::size_t size) {
  if (!machine.robot().has_radio) {
    note_once("radio sends", "the program sends a message, and the robot has no radio");
    return false;
  }
  if (size > most_radio_bytes) return false;
  const RadioOrder head{to, static_cast<std::uint32_t>(size)};
  order(OrderKind::radio, &head, sizeof(head), bytes, size);
  return true;
}

Message await_message() {
  if (!wait_for(
          never, wake_radio, [] { return !machine.messages.empty(); }, Others::by_mode))
    return {};
  Message message = std::move(machine.messages.front());
  machine.messages.pop_front();
  return message;
}

int entities(bool robots) {
  const Senses& s = machine.senses();
  int count = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(s.entities, most_entities); i++)
    count += (s.entity[i].is_robot != 0) == robots;
  return count;
}

const EntityPose* entity(int id, bool robot) {
  const Senses& s = machine.senses();
  if (robot && id == 0) id = static_cast<int>(machine.robot().id);
  for (std::size_t i = 0; i < std::min<std::size_t>(s.entities, most_entities); i++) {
    const EntityPose& e = s.entity[i];
    if (e.id == static_cast<std::uint32_t>(id) && (e.is_robot != 0) == robot) return &e;
  }
  return nullptr;
}

}  // namespace robios
