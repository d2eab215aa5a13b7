#include "selforg/agent.h"

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/text.h"
#include "selforg/store.h"

namespace sandlot::selforg {
namespace {

constexpr StoredForm form{"SELFAGT\n", 1, "agent"};

}  // namespace

Result<std::unique_ptr<WiredController>> WiredController::make(std::size_t sensors, std::size_t motors,
                                                               const AgentSpec& spec) {
  std::unique_ptr<WiredController> made(new WiredController);
  Setup robot{sensors, motors, spec.seed, spec.name};
  if (spec.wiring.empty()) {
    SL_ASSIGN(made->wiring_, make_wiring("one_to_one", robot));
  } else {
    std::vector<std::unique_ptr<Wiring>> parts;
    for (std::size_t i = 0; i < spec.wiring.size(); ++i) {
      Setup between = robot;
      between.name = i == 0 ? spec.name : fmt::format("{}/wiring{}", spec.name, i);
      auto part = make_wiring(spec.wiring[i].kind, between, spec.wiring[i].parameters);
      if (!part) {
        part.error().path = fmt::format("/wiring/{}{}", i, part.error().path);
        return std::move(part).error();
      }
      robot.sensors = part.value()->controller_sensors();
      robot.motors = part.value()->controller_motors();
      parts.push_back(std::move(part).value());
    }
    if (parts.size() == 1) {
      made->wiring_ = std::move(parts.front());
    } else {
      SL_ASSIGN(made->wiring_, make_sequence(std::move(parts)));
    }
  }
  Setup inner{made->wiring_->controller_sensors(), made->wiring_->controller_motors(), spec.seed, spec.name};
  SL_ASSIGN(made->controller_, make_controller(spec.controller, inner, spec.parameters));
  inner.name += "/babbling";
  SL_ASSIGN(made->babbler_, make_controller("babbling", inner));
  made->x_.resize(inner.sensors);
  made->y_.resize(inner.motors);
  made->robot_x_.resize(sensors);
  made->robot_y_.resize(motors);
  made->set_noise(spec.noise);
  return made;
}

void WiredController::step(std::span<const double> x, std::span<double> y, Mode mode) {
  wiring_->wire_sensors(x, x_, noise_);
  if (babbling_left_ > 0) {
    --babbling_left_;
    babbler_->step(x_, y_);
    controller_->step(x_, y_, Mode::babble);
  } else {
    controller_->step(x_, y_, mode);
  }
  wiring_->wire_motors(y_, y, noise_);
  std::copy(x.begin(), x.end(), robot_x_.begin());
  std::copy(y.begin(), y.end(), robot_y_.begin());
  ++steps_;
}

void WiredController::channels(const ChannelVisit& visit) const {
  controller_->channels(visit);
  visit({"x_R", robot_x_.size(), 1, robot_x_});
  visit({"y_R", robot_y_.size(), 1, robot_y_});
}

void WiredController::save(ByteWriter& w) const {
  write(w, noise_);
  write(w, steps_);
  write(w, babbling_left_);
  controller_->save(w);
  babbler_->save(w);
  wiring_->save(w);
}

void WiredController::load(ByteReader& r) {
  ByteWriter before;
  save(before);
  const auto take = [&](ByteReader& from) {
    read(from, noise_);
    read(from, steps_);
    read(from, babbling_left_);
    if (!(std::abs(noise_) <= 1e3)) from.fail();
    controller_->load(from);
    babbler_->load(from);
    wiring_->load(from);
  };
  take(r);
  if (r.ok()) return;
  ByteReader back(before.bytes());
  take(back);
  SL_CHECK(back.ok());
}

std::string WiredController::kinds() const {
  return fmt::format("{} behind {}", controller_->kind(), wiring_->kind());
}

std::vector<std::byte> WiredController::stored() const {
  ByteWriter body, w;
  write(body, kinds());
  write(body, static_cast<std::uint64_t>(wiring_->robot_sensors()));
  write(body, static_cast<std::uint64_t>(wiring_->robot_motors()));
  write(body, controller_->fixed_key());
  save(body);
  write_stored(w, form, body.bytes());
  return {w.bytes().begin(), w.bytes().end()};
}

Status WiredController::take_stored(std::span<const std::byte> bytes, const std::string& from) {
  SL_ASSIGN(const auto body, stored_body(bytes, form, from));
  ByteReader r(body);
  std::uint64_t sensors = 0, motors = 0, key = 0;
  std::string found;
  read(r, found);
  read(r, sensors);
  read(r, motors);
  read(r, key);
  if (!r.ok()) return damaged_file(from);
  if (found != kinds())
    return Error{fmt::format("'{}' holds {}; this agent is {}", from, found.substr(0, 100), kinds()),
                 "load it into one of its kind"};
  if (sensors != wiring_->robot_sensors() || motors != wiring_->robot_motors())
    return Error{fmt::format("'{}' holds an agent of {} sensors and {} motors; this one has {} and {}", from,
                             sensors, motors, wiring_->robot_sensors(), wiring_->robot_motors()),
                 "load it into one of its size"};
  if (key != controller_->fixed_key())
    return Error{fmt::format("'{}' was stored by a controller with other fixed parameters", from),
                 "make the agent with the parameters that it was stored with"};
  if (!load_whole(r, *this)) return damaged_file(from);
  return {};
}

Status WiredController::store(const std::string& path) const {
  const std::vector<std::byte> bytes = stored();
  return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Status WiredController::load(const std::string& path) {
  SL_ASSIGN(const std::string text, read_stored_file(path));
  return take_stored(std::as_bytes(std::span(text)), path);
}

Result<std::unique_ptr<Agent>> Agent::make(Robot& robot, const AgentSpec& spec) {
  std::unique_ptr<Agent> made(new Agent);
  made->robot_ = &robot;
  SL_ASSIGN(made->wired_, WiredController::make(robot.sensors(), robot.motors(), spec));
  made->x_.resize(robot.sensors());
  made->y_.resize(robot.motors());
  return made;
}

void Agent::step(double dt_s, Mode mode) {
  robot_->read_sensors(x_);
  wired_->step(x_, y_, mode);
  robot_->set_motors(y_);
  if (log_.is_open()) log_.step(time_s_, *wired_);
  time_s_ += dt_s;
}

Status Agent::set(std::string_view parameter, std::string_view value) {
  // "wiring[0].noise.strength" and "noise.strength" with slashes, as elements know them.
  std::string path;
  for (const char c : parameter) {
    if (c == '.' || (c == '[' && !path.empty() && path.back() != '/')) path += '/';
    else if (c != ']' && c != '[') path += c;
  }
  constexpr std::string_view of_wiring = "wiring/";
  if (path == "noise") {
    double number = 0;
    if (!parse_number(value, number) || !(number >= 0 && number <= 1e3))
      return Error{fmt::format("'{}' is not in [0, 1000]", value.substr(0, 40)), "", {}, "/noise"};
    wired_->set_noise(number);
  } else if (starts_with(path, of_wiring)) {
    SL_TRY(wired_->wiring().set_parameter(path.substr(of_wiring.size()), Node::scalar(std::string(value))));
  } else {
    SL_TRY(controller().set_parameter(path, Node::scalar(std::string(value))));
  }
  if (log_.is_open()) log_.comment(fmt::format("{}={}", parameter, value));
  return {};
}

}  // namespace sandlot::selforg
