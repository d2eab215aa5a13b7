#include "selforg/simple/simple.h"

#include <fmt/format.h>

#include "base/math.h"
#include "selforg/log_file.h"

namespace sandlot::selforg {
namespace {

double fraction(double turns) { return turns - std::floor(turns); }

}  // namespace

void Sine::step(const Matrix&, Matrix& y, Mode mode) {
  if (mode != Mode::babble)
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double into = fraction(state.phase - static_cast<double>(i) * spec.phaseshift / 4);
      double value = math::sin(math::tau * into);
      if (spec.shape == Shape::saw) value = 2 * into - 1;
      if (spec.shape == Shape::impulse) value = into < spec.impulswidth ? 1 : -1;
      y[i] = spec.amplitude * value;
    }
  state.phase = fraction(state.phase + 1 / spec.period);
}

Status Babbling::Spec::check(const Node& node, const std::string& path) const {
  if (period_min <= period_max) return {};
  return node.error("period_min is above period_max", "", path + "/period_min");
}

Status Babbling::init(const Setup& setup) {
  setup_ = setup;
  state = {};
  state.phase = state.period = Matrix(setup.motors, 1);
  return {};
}

void Babbling::step(const Matrix&, Matrix& y, Mode mode) {
  const auto resample = static_cast<std::uint64_t>(spec.resample);
  if (state.t % resample == 0) {
    Stream random = setup_.random(state.t / resample, 3);
    for (double& each : state.period.data) each = random.uniform(spec.period_min, spec.period_max);
    if (state.t == 0)
      for (double& each : state.phase.data) each = random.uniform();
  }
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (mode != Mode::babble) y[i] = spec.amplitude * math::sin(math::tau * state.phase[i]);
    state.phase[i] = fraction(state.phase[i] + 1 / std::max(state.period[i], 1.0));
  }
  ++state.t;
}

Status Braitenberg::init(const Setup& setup) {
  const std::size_t n = setup.sensors, m = setup.motors;
  weights_ = Matrix(m, n);
  biases_ = Matrix(m, 1);
  if (!spec.biases.empty() && spec.biases.size() != m)
    return Error{fmt::format("'biases' has {} values for {} motors", spec.biases.size(), m),
                 "give one per motor",
                 {},
                 "/biases"};
  std::copy(spec.biases.begin(), spec.biases.end(), biases_.data.begin());
  if (spec.type == Type::custom) {
    if (spec.weights.size() != m * n)
      return Error{
          fmt::format("'weights' has {} values for {} motors and {} sensors", spec.weights.size(), m, n),
          "give motors times sensors, motor after motor",
          {},
          "/weights"};
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < n; ++j) weights_(i, j) = spec.weights[i * n + j];
    return {};
  }
  const auto left = static_cast<std::size_t>(spec.left), right = static_cast<std::size_t>(spec.right);
  if (m != 2 || left >= n || right >= n)
    return Error{
        fmt::format("a vehicle has 2 motors and the sensors {} and {}; here are {} motors and {} sensors",
                    left, right, m, n),
        "use 'type: custom' with weights"};
  const bool crossed = spec.type == Type::aggressive;
  weights_(0, crossed ? right : left) += 1;
  weights_(1, crossed ? left : right) += 1;
  return {};
}

void Braitenberg::step(const Matrix& x, Matrix& y, Mode mode) {
  if (mode == Mode::babble) return;
  multiply(weights_, x, y);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = clipped(spec.gain * y[i] + biases_[i], 1);
}

Status Replay::init(const Setup& setup) {
  SL_ASSIGN(const LogTable table, read_log(spec.file));
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < setup.motors; ++i) {
    const std::string name = fmt::format("y[{}]", i);
    const auto found = std::find(table.columns.begin(), table.columns.end(), name);
    if (found == table.columns.end())
      return Error{fmt::format("'{}' has no column {}", spec.file, name),
                   fmt::format("replay of {} motors needs y[0] to y[{}]", setup.motors, setup.motors - 1)};
    columns.push_back(static_cast<std::size_t>(found - table.columns.begin()));
  }
  if (table.rows.empty())
    return Error{fmt::format("'{}' has no line of values", spec.file), "record some steps"};
  recording_ = Matrix(setup.motors, table.rows.size());
  for (std::size_t k = 0; k < table.rows.size(); ++k)
    for (std::size_t i = 0; i < columns.size(); ++i) recording_(i, k) = clipped(table.rows[k][columns[i]], 1);
  state = {};
  return {};
}

void Replay::step(const Matrix&, Matrix& y, Mode mode) {
  const std::uint64_t lines = recording_.cols;
  const std::uint64_t at = spec.end == End::loop ? state.line % lines : std::min(state.line, lines - 1);
  if (mode != Mode::babble)
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] = state.line >= lines && spec.end == End::zero ? 0 : recording_(i, at);
  ++state.line;
}

}  // namespace sandlot::selforg
