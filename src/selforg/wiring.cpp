#include "selforg/wiring.h"

#include <fmt/format.h>

#include "base/math.h"
#include "base/text.h"

namespace sandlot::selforg {

void Noise::init(const Setup& setup, std::size_t size, std::uint64_t use) {
  setup_ = setup;
  size_ = size;
  use_ = use;
}

Noise::State Noise::fresh() const {
  State state;
  state.colour = state.value = Matrix(size_, 1);
  return state;
}

void Noise::draw(const Spec& spec, State& state, double factor) const {
  const std::uint64_t t = state.t++;
  state.value.set(0);
  if (spec.kind == NoiseKind::none || size_ == 0) return;
  Stream random = setup_.random(t, use_);
  const bool normal = spec.kind == NoiseKind::white_normal || spec.kind == NoiseKind::colour_normal;
  const bool colour = spec.kind == NoiseKind::colour_normal || spec.kind == NoiseKind::colour_uniform;
  const double strength = spec.strength * factor;
  // x += a (white - x) has a / (2 - a) of the variance of the white noise.
  const double a = 1 / spec.tau, gain = std::sqrt((2 - a) / a);
  for (std::size_t i = 0; i < size_; ++i) {
    const double white = normal ? random.normal() : random.uniform(-1, 1);
    if (colour) state.colour[i] += a * (white - state.colour[i]);
    state.value[i] = strength * (colour ? gain * state.colour[i] : white);
    if (spec.kind == NoiseKind::sine_white)
      state.value[i] += strength * math::sin(math::tau * math::fmod(static_cast<double>(t) / spec.period, 1));
  }
}

namespace {

/// A wiring from a struct with field lists, as ControllerOf makes controllers. Its author writes
///   Status init(const Setup& robot); controller_sensors, controller_motors; sensors(in, out, noise); motors(in, out, noise)
template <class T>
class WiringOf final : public ElementAdapter<Wiring, T> {
 public:
  explicit WiringOf(const char* kind) : kind_(kind) {}
  const char* kind() const override { return kind_; }
  Status init(const Node& parameters, const Setup& robot) override {
    SL_ASSIGN(this->element_.spec, read_spec<typename T::Spec>(parameters));
    this->robot_ = robot;
    return this->element_.init(robot);
  }
  std::size_t controller_sensors() const override { return this->element_.controller_sensors; }
  std::size_t controller_motors() const override { return this->element_.controller_motors; }
  void wire_sensors(std::span<const double> robot, std::span<double> controller, double noise) override {
    SL_CHECK(robot.size() == this->robot_sensors() && controller.size() == controller_sensors());
    this->element_.sensors(robot, controller, noise);
  }
  void wire_motors(std::span<const double> controller, std::span<double> robot, double noise) override {
    SL_CHECK(robot.size() == this->robot_motors() && controller.size() == controller_motors());
    this->element_.motors(controller, robot, noise);
  }
  void channels(const ChannelVisit& visit) const override { visit_channels(this->element_.state, {}, visit); }
  void load(ByteReader& r) override { load_sized(r, this->element_); }
  void save_parameters(ByteWriter& w) const override { write_tunables(w, this->element_.spec); }
  void load_parameters(ByteReader& r) override { read_tunables(r, this->element_.spec); }

 private:
  const char* kind_;
};

/// The same sizes on both sides, with noise on the sensors or on the motors, which are clipped to [-1, 1] then.
template <bool on_motors>
struct NoisyWiring {
  struct Spec {
    Noise::Spec noise;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"noise", "", on_motors ? "Noise on the motors." : "Noise on the sensors."}, s.noise);
    }
  };
  struct State {
    Noise::State noise;
    static void fields(auto& s, auto&& visit) { visit(Field{"noise", "", "State of the noise."}, s.noise); }
  };
  Spec spec;
  State state;
  std::size_t controller_sensors = 0, controller_motors = 0;
  Noise noise;

  Status init(const Setup& robot) {
    controller_sensors = robot.sensors;
    controller_motors = robot.motors;
    noise.init(robot, on_motors ? robot.motors : robot.sensors, on_motors ? 11 : 10);
    state.noise = noise.fresh();
    return {};
  }
  void sensors(std::span<const double> in, std::span<double> out, double factor) {
    std::copy(in.begin(), in.end(), out.begin());
    if constexpr (!on_motors) add_noise(out, factor);
  }
  void motors(std::span<const double> in, std::span<double> out, double factor) {
    std::copy(in.begin(), in.end(), out.begin());
    if constexpr (on_motors) {
      add_noise(out, factor);
      for (double& each : out) each = clipped(each, 1);
    }
  }

 private:
  void add_noise(std::span<double> values, double factor) {
    noise.draw(spec.noise, state.noise, factor);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += state.noise.value[i];
  }
};
using OneToOne = NoisyWiring<false>;
using MotorNoise = NoisyWiring<true>;

struct Selective {
  struct Spec {
    std::vector<int> sensors, motors;
    static void fields(auto& s, auto&& visit) {
      visit(
          Field{"sensors", "1", "Indices of the sensors, in the controller's order; empty: all.", 0, 10'000},
          s.sensors);
      visit(Field{"motors", "1", "Indices of the motors, in the controller's order; empty: all.", 0, 10'000},
            s.motors);
    }
  };
  using State = NoFields;
  Spec spec;
  State state;
  std::size_t controller_sensors = 0, controller_motors = 0;

  static Status fill(std::vector<int>& list, std::size_t size, const char* what) {
    if (list.empty())
      for (std::size_t i = 0; i < size; ++i) list.push_back(static_cast<int>(i));
    for (const int index : list)
      if (static_cast<std::size_t>(index) >= size)
        return Error{fmt::format("no index {} in {} {}", index, size, what),
                     "count from 0",
                     {},
                     fmt::format("/{}", what)};
    return {};
  }
  Status init(const Setup& robot) {
    SL_TRY(fill(spec.sensors, robot.sensors, "sensors"));
    SL_TRY(fill(spec.motors, robot.motors, "motors"));
    controller_sensors = spec.sensors.size();
    controller_motors = spec.motors.size();
    return {};
  }
  void sensors(std::span<const double> in, std::span<double> out, double) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = in[static_cast<std::size_t>(spec.sensors[i])];
  }
  void motors(std::span<const double> in, std::span<double> out, double) {
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t i = 0; i < in.size(); ++i) out[static_cast<std::size_t>(spec.motors[i])] = in[i];
  }
};

struct Derivative {
  struct Spec {
    bool identity = true, first = true, second = false;
    double smoothing = 1, factor = 5;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"identity", "", "Sensor values themselves."}, s.identity);
      visit(Field{"first", "", "Change of the smoothed sensor values per step."}, s.first);
      visit(Field{"second", "", "Change of that change per step."}, s.second);
      visit(Field{"smoothing", "1", "Rate at which smoothed values follow; 1: at once.", 1e-6, 1,
                  Field::tunable},
            s.smoothing);
      visit(Field{"factor", "1", "Factor on the first derivative; squared on the second.", -1e3, 1e3,
                  Field::tunable},
            s.factor);
    }
  };
  struct State {
    std::uint64_t t = 0;
    Matrix x0, x1, x2;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"x0", "1", "Smoothed sensor values."}, s.x0);
      visit(Field{"x1", "1", "Smoothed sensor values one step ago."}, s.x1);
      visit(Field{"x2", "1", "Smoothed sensor values two steps ago."}, s.x2);
    }
  };
  Spec spec;
  State state;
  std::size_t controller_sensors = 0, controller_motors = 0;

  Status init(const Setup& robot) {
    state = {};
    state.x0 = state.x1 = state.x2 = Matrix(robot.sensors, 1);
    controller_sensors = robot.sensors *
                         (std::size_t{spec.identity} + std::size_t{spec.first} + std::size_t{spec.second});
    controller_motors = robot.motors;
    if (controller_sensors == 0 && robot.sensors > 0)
      return Error{"a derivative wiring without identity, first and second has no sensors", "choose one"};
    return {};
  }
  void sensors(std::span<const double> in, std::span<double> out, double) {
    const std::size_t n = in.size();
    std::swap(state.x2, state.x1);
    std::swap(state.x1, state.x0);  // x0 is now the oldest
    for (std::size_t i = 0; i < n; ++i) {
      const double value = std::isfinite(in[i]) ? clipped(in[i], 1000) : state.x1[i];
      state.x0[i] = state.t == 0 ? value : state.x1[i] + spec.smoothing * (value - state.x1[i]);
      if (state.t == 0) state.x1[i] = value;
      if (state.t <= 1) state.x2[i] = state.x1[i];
    }
    std::size_t at = 0;
    if (spec.identity)
      for (std::size_t i = 0; i < n; ++i) out[at++] = in[i];
    if (spec.first)
      for (std::size_t i = 0; i < n; ++i) out[at++] = spec.factor * (state.x0[i] - state.x1[i]);
    if (spec.second)
      for (std::size_t i = 0; i < n; ++i)
        out[at++] = spec.factor * spec.factor * (state.x0[i] - 2 * state.x1[i] + state.x2[i]);
    ++state.t;
  }
  void motors(std::span<const double> in, std::span<double> out, double) {
    std::copy(in.begin(), in.end(), out.begin());
  }
};

struct Feedback {
  struct Spec {
    double factor = 1;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"factor", "1", "Factor on the motor values that are fed back.", -100, 100, Field::tunable},
            s.factor);
    }
  };
  struct State {
    Matrix y;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"y", "1", "Last motor values of the controller."}, s.y);
    }
  };
  Spec spec;
  State state;
  std::size_t controller_sensors = 0, controller_motors = 0;

  Status init(const Setup& robot) {
    state.y = Matrix(robot.motors, 1);
    controller_sensors = robot.sensors + robot.motors;
    controller_motors = robot.motors;
    return {};
  }
  void sensors(std::span<const double> in, std::span<double> out, double) {
    auto to = std::copy(in.begin(), in.end(), out.begin());
    for (const double each : state.y.data) *to++ = spec.factor * each;
  }
  void motors(std::span<const double> in, std::span<double> out, double) {
    std::copy(in.begin(), in.end(), out.begin());
    for (std::size_t i = 0; i < in.size(); ++i) state.y[i] = clipped(in[i], 1);
  }
};

/// Parts by pointer: parameters and values go by the part's index, "0/noise/strength".
class Sequence final : public Wiring {
 public:
  explicit Sequence(std::vector<std::unique_ptr<Wiring>> parts) : parts_(std::move(parts)) {
    robot_.sensors = parts_.front()->robot_sensors();
    robot_.motors = parts_.front()->robot_motors();
    for (const auto& part : parts_) {
      sensor_values_.emplace_back(part->controller_sensors(), 1);
      motor_values_.emplace_back(part->controller_motors(), 1);
    }
  }
  const char* kind() const override { return "sequence"; }
  Status init(const Node&, const Setup&) override {
    return Error{"a sequence is made of wirings", "use make_sequence"};
  }
  std::size_t controller_sensors() const override { return parts_.back()->controller_sensors(); }
  std::size_t controller_motors() const override { return parts_.back()->controller_motors(); }
  void wire_sensors(std::span<const double> robot, std::span<double> controller, double noise) override {
    SL_CHECK(controller.size() == controller_sensors());
    for (std::size_t i = 0; i < parts_.size(); ++i)
      parts_[i]->wire_sensors(i == 0 ? robot : std::span<const double>(sensor_values_[i - 1].data),
                              sensor_values_[i].data, noise);
    std::copy(sensor_values_.back().data.begin(), sensor_values_.back().data.end(), controller.begin());
  }
  void wire_motors(std::span<const double> controller, std::span<double> robot, double noise) override {
    for (std::size_t i = parts_.size(); i-- > 0;)
      parts_[i]->wire_motors(
          i + 1 == parts_.size() ? controller : std::span<const double>(motor_values_[i].data),
          i == 0 ? robot : std::span<double>(motor_values_[i - 1].data), noise);
  }
  void channels(const ChannelVisit& visit) const override {
    for (const auto& part : parts_) part->channels(visit);
  }
  Status set_parameter(std::string_view path, const Node& value) override {
    const std::string_view first = first_part(path);
    double index = 0;
    if (!parse_number(first, index) || !(index >= 0) || index >= static_cast<double>(parts_.size()) ||
        first.size() == path.size())
      return Error{fmt::format("no parameter '{}' in a sequence of {} wirings", path, parts_.size()),
                   "begin with the index of the wiring: 0/noise/strength"};
    return parts_[static_cast<std::size_t>(index)]->set_parameter(path.substr(first.size() + 1), value);
  }
  ValueFound value(ValuePart part, std::span<const ValueStep> path) const override {
    if (path.empty() || !path[0].key.empty() || path[0].index >= parts_.size()) return {};
    return parts_[path[0].index]->value(part, path.subspan(1));
  }
  void list_values(ValuePart part, const ValueVisit& visit) const override {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      parts_[i]->list_values(part, [&](ValueEntry entry) {
        entry.path = fmt::format("[{}].{}", i, entry.path);
        visit(std::move(entry));
      });
  }
  void save(ByteWriter& w) const override {
    for (const auto& part : parts_) part->save(w);
  }
  void load(ByteReader& r) override {
    for (const auto& part : parts_) part->load(r);
  }
  void save_parameters(ByteWriter& w) const override {
    for (const auto& part : parts_) part->save_parameters(w);
  }
  void load_parameters(ByteReader& r) override {
    for (const auto& part : parts_) part->load_parameters(r);
  }

 private:
  std::vector<std::unique_ptr<Wiring>> parts_;
  std::vector<Matrix> sensor_values_, motor_values_;
};

}  // namespace

std::span<const WiringKind> wiring_kinds() {
#define SL_ENTRY(name, type, help)                                                                     \
  WiringKind {                                                                                         \
#name, help, []() -> std::unique_ptr < Wiring> { return std::make_unique<WiringOf<type>>(#name); } \
  }
  static const WiringKind table[] = {
      SL_ENTRY(derivative, Derivative, "Sensors, their change per step and the change of that."),
      SL_ENTRY(feedback, Feedback, "Last motor values as further sensors."),
      SL_ENTRY(motor_noise, MotorNoise, "Noise on the motors."),
      SL_ENTRY(one_to_one, OneToOne, "The same values, with noise on the sensors."),
      SL_ENTRY(selective, Selective, "Some of the sensors and motors."),
  };
#undef SL_ENTRY
  return table;
}

Result<std::unique_ptr<Wiring>> make_wiring(std::string_view kind, const Setup& robot,
                                            const Node& parameters) {
  std::vector<std::string> names;
  for (const WiringKind& each : wiring_kinds()) {
    if (each.name == kind) {
      auto made = each.create();
      SL_TRY(made->init(parameters, robot));
      return made;
    }
    names.emplace_back(each.name);
  }
  return Error{fmt::format("no wiring kind '{}'", kind), suggestion(kind, names)};
}

Result<std::unique_ptr<Wiring>> make_sequence(std::vector<std::unique_ptr<Wiring>> parts) {
  if (parts.empty()) return Error{"a sequence without wirings", "give one at least"};
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (parts[i]->robot_sensors() != parts[i - 1]->controller_sensors() ||
        parts[i]->robot_motors() != parts[i - 1]->controller_motors())
      return Error{fmt::format("wiring {} takes {} sensors and {} motors, the one before it gives {} and {}",
                               i, parts[i]->robot_sensors(), parts[i]->robot_motors(),
                               parts[i - 1]->controller_sensors(), parts[i - 1]->controller_motors()),
                   "make each with the sizes of the one before it"};
  return std::unique_ptr<Wiring>(std::make_unique<Sequence>(std::move(parts)));
}

}  // namespace sandlot::selforg
