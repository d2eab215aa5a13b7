#include "selforg/primitives/primitives.h"

#include <fmt/format.h>

#include "selforg/arrays.h"

namespace sandlot::selforg {

void QLearning::init(std::size_t states, std::size_t actions) {
  state = {};
  state.Q = state.trace = Matrix(states, actions);
}

std::uint32_t QLearning::choose(std::uint32_t now, double reward, bool learn, Stream random) {
  State& s = state;
  std::uint32_t best = 0;
  for (std::uint32_t a = 1; a < s.Q.cols; ++a)
    if (s.Q(now, a) > s.Q(now, best)) best = a;
  if (learn && s.begun) {
    const double delta = reward + spec.discount * s.Q(now, best) - s.Q(s.state, s.action);
    s.trace(s.state, s.action) = 1;
    array(s.Q) += array(s.trace) * (spec.eps * delta);
    array(s.trace) *= spec.discount * spec.elig;
  }
  // The values have changed: choose by what they are now.
  best = 0;
  for (std::uint32_t a = 1; a < s.Q.cols; ++a)
    if (s.Q(now, a) > s.Q(now, best)) best = a;
  std::uint32_t action = best;
  if (learn && random.uniform() < spec.expl) action = random.below(s.Q.cols);
  if (action != best) s.trace.set(0);
  s.state = now;
  s.action = action;
  s.begun = true;
  return action;
}

Status Primitives::init(const Setup& setup) {
  setup_ = setup;
  const std::size_t n = setup.sensors, m = setup.motors;
  if (spec.senses.empty())
    for (std::size_t i = 0; i < n; ++i) spec.senses.push_back(static_cast<int>(i));
  double states = 1;
  for (const int sense : spec.senses) {
    if (static_cast<std::size_t>(sense) >= n)
      return Error{fmt::format("no sensor {}: there are {}", sense, n), "count from 0", {}, "/senses"};
    states *= spec.bins;
  }
  if (states * static_cast<double>(spec.primitives.size()) > 1e6)
    return Error{fmt::format("{:.0f} situations are too many", states),
                 "take fewer senses or bins: at most 1e6 values",
                 {},
                 "/bins"};
  weights_.clear();
  biases_.clear();
  for (std::size_t k = 0; k < spec.primitives.size(); ++k) {
    const Primitive& each = spec.primitives[k];
    const std::string path = fmt::format("/primitives/{}", k);
    if (!each.weights.empty() && each.weights.size() != n * m)
      return Error{fmt::format("primitive '{}' has {} weights for {} motors and {} sensors", each.name,
                               each.weights.size(), m, n),
                   "give motors times sensors",
                   {},
                   path + "/weights"};
    if (!each.biases.empty() && each.biases.size() != m)
      return Error{
          fmt::format("primitive '{}' has {} biases for {} motors", each.name, each.biases.size(), m),
          "give one per motor",
          {},
          path + "/biases"};
    Matrix& weights = weights_.emplace_back(m, n);
    if (!each.weights.empty())
      for (std::size_t i = 0; i < m; ++i)
        for (std::size_t j = 0; j < n; ++j) weights(i, j) = each.weights[i * n + j];
    Matrix& biases = biases_.emplace_back(m, 1);
    std::copy(each.biases.begin(), each.biases.end(), biases.data.begin());
  }
  learning_.init(static_cast<std::size_t>(states), spec.primitives.size());
  state = {};
  state.learning = learning_.state;
  return {};
}

std::uint32_t Primitives::situation(const Matrix& x) const {
  std::uint32_t index = 0;
  for (const int sense : spec.senses) {
    const double share = (clipped(x[static_cast<std::size_t>(sense)], 1) + 1) / 2;
    const auto bin = std::min(static_cast<int>(share * spec.bins), spec.bins - 1);
    index = index * static_cast<std::uint32_t>(spec.bins) + static_cast<std::uint32_t>(bin);
  }
  return index;
}

void Primitives::step(const Matrix& x, Matrix& y, Mode mode) {
  if (state.t % static_cast<std::uint64_t>(spec.interval) == 0) {
    learning_.spec = spec.learning;
    std::swap(learning_.state, state.learning);
    learning_.choose(situation(x), state.reward, mode == Mode::learn, setup_.random(state.t, 5));
    std::swap(learning_.state, state.learning);
    state.reward = 0;
  }
  ++state.t;
  if (mode == Mode::babble) return;
  multiply(weights_[state.learning.action], x, y);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = clipped(y[i] + biases_[state.learning.action][i], 1);
}

}  // namespace sandlot::selforg
