#include "fake_simulator.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace fake {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

void name(char* to, const std::string& text) { text.copy(to, name_size - 1); }

}  // namespace

std::vector<Order> Result::of(OrderKind kind) const {
  std::vector<Order> result;
  for (const Order& o : orders) {
    if (o.kind == kind) result.push_back(o);
  }
  return result;
}

Simulator::Simulator() {
  descriptor_ = memfd_create("robios", 0);
  if (descriptor_ < 0 || ftruncate(descriptor_, sizeof(Memory)) != 0) abort();
  void* at = mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
  if (at == MAP_FAILED) abort();
  memory_ = static_cast<Memory*>(at);
  memory_->protocol = protocol;
  memory_->size = sizeof(Memory);
  Robot& r = robot();
  name(r.name, "Eve");
  name(r.type, "S4");
  r.id = 3;
  r.drive = Drive::differential;
  r.motors = 2;
  r.servos = 2;
  r.distances = 4;
  r.bumpers = 2;
  r.ticks_per_turn = 540;
  r.has_camera = r.has_lidar = r.has_radio = r.has_keys = r.has_screen = r.has_speaker = 1;
  r.has_compass = r.has_battery = r.delays = 1;
  r.wheel_diameter_m = 0.05;
  r.track_m = 0.1;
  r.max_speed_mps = 1;
  r.slot_s = 0.05;
  const char* psd[] = {"PSD_FRONT", "PSD_LEFT", "PSD_RIGHT", "PSD_BACK"};
  for (int i = 0; i < 4; i++) {
    name(r.distance_names[i], psd[i]);
    r.distance_numbers[i] = i + 1;
    senses().distance_m[i] = 0.1 * (i + 1) + 0.0004;
  }
  name(r.motor_names[0], "left");
  name(r.motor_names[1], "right");
  name(r.servo_names[0], "SERVO1");
  name(r.servo_names[1], "SERVO11");
  name(r.bumper_names[0], "BUMP_LEFT");
  name(r.bumper_names[1], "BUMP_RIGHT");
  senses().maneuver_done = 1;
  senses().battery_V = 8;
}

Simulator::~Simulator() {
  munmap(memory_, sizeof(Memory));
  close(descriptor_);
}

void Simulator::paint(std::uint32_t width, std::uint32_t height,
                      const std::function<std::array<int, 3>(int, int)>& color) {
  senses().image_width = width;
  senses().image_height = height;
  std::uint8_t* to = senses().image;
  for (int y = 0; y < static_cast<int>(height); y++) {
    for (int x = 0; x < static_cast<int>(width); x++) {
      for (const int c : color(x, y)) *to++ = static_cast<std::uint8_t>(c);
    }
  }
}

int Simulator::pixel(int x, int y) const {
  const auto at = pixels.find({x, y});
  return at == pixels.end() ? -1 : at->second;
}

void Simulator::step(std::int64_t ns) {
  Senses& s = senses();
  const double slot = static_cast<double>(ns) * 1e-9;
  double left = slot, v = v_, w = w_;
  if (way_) {
    left = std::min(slot, left_s_);
    v = maneuver_.kind == 1 ? 0 : (maneuver_.kind == 3 ? maneuver_.x_m : maneuver_.distance_m) / whole_s_;
    w = maneuver_.kind == 0 || maneuver_.kind == 3 ? 0 : maneuver_.angle_rad / whole_s_;
  }
  const double turned = w * left;
  const double chord = std::abs(turned) < 1e-12 ? v * left : v / w * 2 * std::sin(turned / 2);
  s.x_m += chord * std::cos(s.phi_rad + turned / 2);
  s.y_m += chord * std::sin(s.phi_rad + turned / 2);
  s.phi_rad = std::remainder(s.phi_rad + turned, 2 * 3.14159265358979323846);
  s.v_mps = v;
  s.w_radps = w;
  if (way_) {
    left_s_ -= slot;
    const double share = std::max(left_s_, 0.0) / whole_s_;
    s.remaining_m = maneuver_.distance_m * share;
    s.remaining_rad = maneuver_.angle_rad * share;
    if (left_s_ <= 1e-9) {
      way_ = false;
      s.maneuver_done = 1;
      v_ = w_ = s.v_mps = s.w_radps = 0;
    }
  }
  for (std::size_t i = 0; i < 2; i++) s.encoder_ticks[i] += std::llround(motor_[i] * slot * 1000);
}

std::uint32_t Simulator::inputs(std::int64_t now_ns) {
  Senses& s = senses();
  std::uint32_t events = 0;
  while (!presses_.empty() && presses_.begin()->first <= now_ns) {
    if (s.keys == most_key_presses) {
      std::copy(s.key + 1, s.key + most_key_presses, s.key);
      s.keys--;
    }
    s.key[s.keys++] = presses_.begin()->second;
    s.key_presses++;
    presses_.erase(presses_.begin());
    events |= wake_key;
  }
  while (!messages_.empty() && messages_.begin()->first <= now_ns) {
    const auto& [from, text] = messages_.begin()->second;
    RadioMessage& m = s.radio[s.radio_messages++];
    m.from = from;
    m.size = static_cast<std::uint32_t>(text.size());
    text.copy(reinterpret_cast<char*>(m.bytes), sizeof(m.bytes));
    messages_.erase(messages_.begin());
    events |= wake_radio;
  }
  if (s.radio_messages > 0) events |= wake_radio;
  if (s.maneuver_done) events |= wake_drive_done;
  if (picture_ && listens) {
    picture_ = false;
    s.image_count++;
    s.image_time_ns = now_ns;
    events |= wake_picture;
  }
  return events;
}

void Simulator::apply(const Order& order) {
  Senses& s = senses();
  switch (order.kind) {
    case OrderKind::speed: {
      const auto o = order.as<SpeedOrder>();
      v_ = o.v_mps, w_ = o.w_radps;
      way_ = false;
      s.maneuver_done = 1;
      break;
    }
    case OrderKind::maneuver: {
      if (!listens) break;
      maneuver_ = order.as<ManeuverOrder>();
      const double speed = maneuver_.speed_mps > 0 ? maneuver_.speed_mps : 1;
      const double rate = maneuver_.turning_rate_radps > 0 ? maneuver_.turning_rate_radps : 1;
      whole_s_ = maneuver_.kind == 1   ? std::abs(maneuver_.angle_rad) / rate
                 : maneuver_.kind == 3 ? std::hypot(maneuver_.x_m, maneuver_.y_m) / speed
                                       : std::abs(maneuver_.distance_m) / speed;
      left_s_ = whole_s_ = std::max(whole_s_, 1e-9);
      way_ = true;
      s.maneuvers++;
      s.maneuver_done = 0;
      s.remaining_m = maneuver_.distance_m;
      s.remaining_rad = maneuver_.angle_rad;
      break;
    }
    case OrderKind::set_pose: {
      const auto o = order.as<PoseOrder>();
      s.x_m = o.x_m, s.y_m = o.y_m, s.phi_rad = o.phi_rad;
      break;
    }
    case OrderKind::motor: {
      const auto o = order.as<MotorOrder>();
      if (o.number < most_motors) motor_[o.number] = o.value;
      break;
    }
    case OrderKind::screen: {
      const auto o = order.as<ScreenOrder>();
      const auto* p = reinterpret_cast<const std::uint8_t*>(order.payload.data()) + sizeof(o);
      for (std::uint32_t y = 0; y < o.height; y++) {
        for (std::uint32_t x = 0; x < o.width; x++, p += 3)
          pixels[{static_cast<int>(o.x + x), static_cast<int>(o.y + y)}] = p[0] << 16 | p[1] << 8 | p[2];
      }
      break;
    }
    case OrderKind::text: {
      std::vector<std::string> all;
      for (std::size_t i = 0; i < order.payload.size(); i += all.back().size() + 1)
        all.push_back(order.payload.c_str() + i);
      menu.assign(all.begin(), all.begin() + 4);
      lines.assign(all.begin() + 4, all.end());
      break;
    }
    case OrderKind::picture: picture_ = true; break;
    case OrderKind::wait: {
      const auto o = order.as<WaitOrder>();
      until_ns_ = o.until_ns;
      events_ = o.events;
      break;
    }
    default: break;
  }
}

bool Simulator::take_orders(Result& result) {
  bool ended = false;
  for (std::size_t at = 0; at + sizeof(OrderHead) <= memory_->order_bytes;) {
    OrderHead head;
    std::memcpy(&head, memory_->orders + at, sizeof(head));
    const char* payload = reinterpret_cast<const char*>(memory_->orders) + at + sizeof(head);
    result.orders.push_back({head.kind, senses().now_ns, std::string(payload, head.size)});
    apply(result.orders.back());
    if (head.kind == OrderKind::finished) {
      result.finished = result.orders.back().as<std::int32_t>();
      ended = true;
    }
    at += sizeof(head) + (head.size + 7) / 8 * 8;
  }
  return ended;
}

Result Simulator::run(const std::string& program, const std::vector<std::string>& arguments, double most_s) {
  Result result;
  const std::string out = scratch() + "/out", err = scratch() + "/err";
  const std::string path = std::filesystem::absolute(program);
  std::vector<char*> words{const_cast<char*>(path.c_str())};
  for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    dup2(open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), 1);
    dup2(open(err.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), 2);
    setenv(descriptor_variable, std::to_string(dup(descriptor_)).c_str(), 1);
    if (chdir(scratch().c_str()) == 0) execv(path.c_str(), words.data());
    _exit(127);
  }
  Senses& s = senses();
  const auto limit = static_cast<std::int64_t>(most_s * 1e9);
  std::int64_t now = 0;
  if (on_slot) on_slot(now);
  inputs(now);
  int status = 0;
  bool gone = false;
  while (!gone) {
    s.now_ns = now;
    s.slot_end_ns = now + slot_ns;
    s.wall_ns = now * 2;
    memory_->order_bytes = 0;
    memory_->turn.store(static_cast<std::uint32_t>(Turn::program));
    auto* word = reinterpret_cast<std::uint32_t*>(&memory_->turn);
    syscall(SYS_futex, word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
    for (int tries = 0; memory_->turn.load() == static_cast<std::uint32_t>(Turn::program); tries++) {
      const timespec pause{0, 20'000'000};
      syscall(SYS_futex, word, FUTEX_WAIT, static_cast<std::uint32_t>(Turn::program), &pause, nullptr, 0);
      if (waitpid(child, &status, WNOHANG) == child) {
        gone = true;
        break;
      }
      if (tries > 500) kill(child, SIGKILL);
    }
    result.turns++;
    const bool handed_over = memory_->turn.load() == static_cast<std::uint32_t>(Turn::simulator);
    if (handed_over && take_orders(result)) break;
    if (gone) break;
    s.radio_messages = 0;
    // The world goes on until the program wants its turn.
    std::uint32_t events = 0;
    do {
      step(slot_ns);
      now += slot_ns;
      if (on_slot) on_slot(now);
      events = inputs(now);
    } while (until_ns_ >= now + slot_ns && !(events & events_) && now < limit);
    if (now >= limit) {
      memory_->turn.store(static_cast<std::uint32_t>(Turn::ended));
      syscall(SYS_futex, word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
      break;
    }
  }
  if (!gone) waitpid(child, &status, 0);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.end_ns = now;
  result.output = contents(out);
  result.errors = contents(err);
  return result;
}

std::string scratch() {
  struct Folder {
    std::string path = std::filesystem::temp_directory_path() / "robios_XXXXXX";
    Folder() {
      if (!mkdtemp(path.data())) abort();
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

bool compiles(const std::string& command, std::string* errors) {
  const std::string log = scratch() + "/compiler";
  const bool good = std::system((command + " >" + log + " 2>&1").c_str()) == 0;
  if (errors) *errors = contents(log);
  return good;
}

std::string compile(const std::string& source, int generation, const std::string& flags) {
  static std::map<std::string, std::string> done;
  const std::string g = std::to_string(generation);
  std::string& program = done[source + g + flags];
  if (!program.empty()) return program;
  const std::string to = scratch() + "/program" + std::to_string(done.size());
  std::string errors;
  const std::string libraries = std::filesystem::absolute(SANDLOT_ROBIOS_LIBRARIES);
  if (!compiles("cc " + flags + " -Irobios/include/robios" + g + " robios/tests/programs/" + source + " -o " +
                    to + " -L" + libraries + " -Wl,-rpath," + libraries + " -Wl,--no-as-needed -lrobios" + g +
                    " -lm",
                &errors))
    return program = errors;
  return program = to;
}

}  // namespace fake
