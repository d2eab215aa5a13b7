#include "selforg/experts/experts.h"

#include "selforg/arrays.h"

namespace sandlot::selforg {

void ExpertMemory::init(const Setup& setup) {
  const std::size_t n = setup.sensors, m = setup.motors, in = 2 * n + m, out = n + m;
  const auto hidden = static_cast<std::size_t>(spec.numHidden);
  state = {};
  state.x1 = state.x2 = Matrix(n, 1);
  state.y1 = state.y2 = Matrix(m, 1);
  Expert blank;
  blank.W1 = Matrix(hidden, in);
  blank.b1 = Matrix(hidden, 1);
  blank.W2 = Matrix(out, hidden);
  blank.b2 = Matrix(out, 1);
  state.experts.assign(static_cast<std::size_t>(spec.numSats), blank);
  Stream random = setup.random(0, 4);
  for (Expert& expert : state.experts)
    for (Matrix* each : {&expert.W1, &expert.W2})
      for (double& weight : each->data) weight = random.uniform(-0.1, 0.1);
  in_ = Matrix(in, 1);
  hidden_ = back_ = Matrix(hidden, 1);
  out_ = target_ = delta_ = Matrix(out, 1);
}

bool ExpertMemory::fits(const State& s) const {
  const auto count = static_cast<int>(s.experts.size());
  return s.winner >= 0 && s.winner < count && s.companion >= 0 && s.companion < count;
}

void ExpertMemory::predict(const Expert& expert, const Matrix& x1, const Matrix& x2, const Matrix& y2) {
  auto to = std::copy(x1.data.begin(), x1.data.end(), in_.data.begin());
  to = std::copy(x2.data.begin(), x2.data.end(), to);
  std::copy(y2.data.begin(), y2.data.end(), to);
  multiply(expert.W1, in_, hidden_);
  array(hidden_) += array(expert.b1);
  tanh_of(hidden_, hidden_);
  multiply(expert.W2, hidden_, out_);
  array(out_) += array(expert.b2);
}

/// One step of gradient descent on 1/2 |target - out|^2, with delta_ = target - out of the last predict().
void ExpertMemory::descend(Expert& expert, double rate) {
  multiply_transposed(expert.W2, delta_, back_);
  array(back_) *= 1 - array(hidden_) * array(hidden_);
  for (double& each : back_.data) each = clipped(each, 10);
  for (double& each : delta_.data) each = clipped(each, 10);
  for (std::size_t j = 0; j < expert.W2.cols; ++j)
    column(expert.W2, j) += array(delta_) * (rate * hidden_[j]);
  array(expert.b2) += array(delta_) * rate;
  for (std::size_t j = 0; j < expert.W1.cols; ++j)
    column(expert.W1, j) += array(back_) * (rate * clipped(in_[j], 10));
  array(expert.b1) += array(back_) * rate;
  for (Matrix* each : {&expert.W1, &expert.b1, &expert.W2, &expert.b2})
    for (double& weight : each->data) weight = clipped(weight, 1e3);
}

void ExpertMemory::observe(const Matrix& x, bool learn) {
  State& s = state;
  if (s.t < 2) return;  // the first inputs are not complete
  std::copy(s.y1.data.begin(), s.y1.data.end(),
            std::copy(x.data.begin(), x.data.end(), target_.data.begin()));
  s.companion = 0;
  for (std::size_t i = 0; i < s.experts.size(); ++i) {
    Expert& expert = s.experts[i];
    predict(expert, s.x1, s.x2, s.y2);
    array(delta_) = array(target_) - array(out_);
    expert.error = clipped(squared_norm(delta_), 1e12);
    expert.average1 += (expert.error - expert.average1) / spec.tauE1;
    expert.average2 += (expert.error - expert.average2) / spec.tauE2;
    if (expert.epsMod > s.experts[static_cast<std::size_t>(s.companion)].epsMod)
      s.companion = static_cast<int>(i);
  }
  double best = 0;
  for (std::size_t i = 0; i < s.experts.size(); ++i) {
    const bool is_companion = static_cast<int>(i) == s.companion;
    const double average = s.experts[i].average1 * (is_companion ? 1 + spec.lambda_w : 1);
    if (i > 0 && !(average < best)) continue;
    best = average;
    s.winner = static_cast<int>(i);
  }
  if (!learn) return;
  for (const int which : {s.winner, s.companion}) {
    Expert& expert = s.experts[static_cast<std::size_t>(which)];
    predict(expert, s.x1, s.x2, s.y2);
    array(delta_) = array(target_) - array(out_);
    descend(expert, spec.eps0 * expert.epsMod);
    if (s.winner == s.companion) break;
  }
  Expert& winner = s.experts[static_cast<std::size_t>(s.winner)];
  winner.epsMod *= 1 - std::max(0.0, (0.3 - winner.average1) / 0.3) / spec.tauW;
}

void ExpertMemory::recall(std::size_t expert, const Matrix& x, Matrix& y) {
  predict(state.experts[expert], x, state.x1, state.y1);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = clipped(out_[x.size() + i], 1);
}

void ExpertMemory::sent(const Matrix& x, const Matrix& y) {
  std::copy(state.x1.data.begin(), state.x1.data.end(), state.x2.data.begin());
  std::copy(state.y1.data.begin(), state.y1.data.end(), state.y2.data.begin());
  std::copy(x.data.begin(), x.data.end(), state.x1.data.begin());
  std::copy(y.data.begin(), y.data.end(), state.y1.data.begin());
  ++state.t;
}

Status Experts::init(const Setup& setup) {
  main_.spec = spec.main;
  memory_.spec = spec.memory;
  SL_TRY(main_.init(setup));
  memory_.init(setup);
  state.main = main_.state;
  state.memory = memory_.state;
  state.y = recalled_ = Matrix(setup.motors, 1);
  return {};
}

void Experts::exchange() {
  main_.spec = spec.main;
  memory_.spec = spec.memory;
  std::swap(main_.state, state.main);
  std::swap(memory_.state, state.memory);
}

void Experts::step(const Matrix& x, Matrix& y, Mode mode) {
  exchange();
  memory_.observe(x, mode != Mode::act);
  main_.step(x, y, mode);
  const auto count = static_cast<int>(memory_.state.experts.size());
  const bool alone = spec.recall >= 0 && spec.recall < count;
  if (mode != Mode::babble && (alone || spec.expert_share > 0)) {
    memory_.recall(static_cast<std::size_t>(alone ? spec.recall : memory_.state.winner), x, recalled_);
    const double share = alone ? 1 : spec.expert_share;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (1 - share) * y[i] + share * recalled_[i];
    main_.correct_last_motors(y);
  }
  memory_.sent(x, y);
  std::copy(y.data.begin(), y.data.end(), state.y.data.begin());
  exchange();
}

void Experts::teach_motors(std::span<const double> y) {
  exchange();
  main_.teach_motors(y);
  exchange();
}

void Experts::teach_sensors(std::span<const double> x) {
  exchange();
  main_.teach_sensors(x);
  exchange();
}

void Experts::set_reward(double reward) {
  exchange();
  main_.set_reward(reward);
  exchange();
}

}  // namespace sandlot::selforg
