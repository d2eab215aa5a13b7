/// Claims of the thesis about models and guidance, in a loop without a body: two motors, two sensors and a world that is known.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "app/papers/lpzrobots.h"
#include "base/math.h"
#include "base/random.h"
#include "selforg/semox/semox.h"
#include "selforg/sox/sox.h"

namespace sandlot::app::lpzrobots {
namespace {

using selforg::Matrix;
using selforg::Mode;

constexpr double gain = 0.5, world_gain = 0.4, noise = 0.05, turn_rad = std::numbers::pi / 6;

double frobenius(const Matrix& m, const std::array<double, 4>& truth) {
  double sum = 0;
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < 2; ++i) {
      const double d = m(i, j) - truth[i + 2 * j];
      sum += d * d;
    }
  return std::sqrt(sum);
}

/// Mean wall time of a learning step [us], of an agent with two motors.
template <class Agent>
Result<double> step_us(std::size_t sensors) {
  Agent agent;
  SL_TRY(agent.init({.sensors = sensors, .motors = 2}));
  Stream random(1, entity_key("step"), Purpose::experiment, 0);
  Matrix x(sensors, 1), y(2, 1);
  const int warm = 20, steps = sensors > 100 ? 60 : 400;
  auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < warm + steps; ++k) {
    if (k == warm) begin = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < sensors; ++i) x[i] = 0.5 * y[i % 2] + random.uniform(-0.05, 0.05);
    agent.step(x, y, Mode::learn);
  }
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count() / steps;
}

}  // namespace

Result<LoopResult> run_loop(const LoopSpec& spec) {
  selforg::Sox agent;
  agent.spec.extended_model = spec.extended_model;
  agent.spec.gamma = 0.1;
  agent.spec.goal_weight = 1;
  SL_TRY(agent.init({.sensors = 2, .motors = 2, .seed = spec.seed}));
  Stream random(spec.seed, entity_key("loop"), Purpose::experiment, 0);
  const double c = spec.world ? world_gain * math::cos(turn_rad) : 0;
  const double s = spec.world ? world_gain * math::sin(turn_rad) : 0;
  Matrix x(2, 1), y(2, 1);
  LoopResult out;
  const int from = loop_steps * 3 / 4;
  constexpr double weights[] = {1, 1};
  for (int k = 0; k < loop_steps; ++k) {
    if (spec.taught) agent.teach_motors(taught_y);
    if (spec.goal) agent.set_goal_sensors(goal_x, weights);
    if (spec.babbling)
      for (std::size_t i = 0; i < 2; ++i) y[i] = random.uniform(-1, 1);
    agent.step(x, y, spec.babbling ? Mode::babble : Mode::learn);
    if (k >= from) {
      out.surprise += agent.state.xi[0] * agent.state.xi[0] + agent.state.xi[1] * agent.state.xi[1];
      for (std::size_t i = 0; i < 2; ++i) {
        out.off_taught += std::abs(y[i] - taught_y[i]) / 2;
        out.off_goal += std::abs(x[i] - goal_x[i]) / 2;
      }
    }
    const double x0 = x[0], x1 = x[1];
    x[0] = gain * y[0] + c * x0 - s * x1 + random.uniform(-noise, noise);
    x[1] = gain * y[1] + s * x0 + c * x1 + random.uniform(-noise, noise);
  }
  const double n = loop_steps - from;
  out.surprise = std::sqrt(out.surprise / (2 * n));
  out.off_taught /= n;
  out.off_goal /= n;
  out.model_error = frobenius(agent.state.A, {gain, 0, 0, gain});
  out.world_error = spec.extended_model ? frobenius(agent.state.S, {c, s, -s, c})
                                        : std::sqrt(2 * (c * c + s * s));
  return out;
}

Status loop_of_numbers(const ReproduceContext& context, ReportPage& page) {
  struct Condition {
    const char* name;
    LoopSpec spec;
  };
  const auto measure = [&](const Condition& condition, double LoopResult::*figure) -> Result<Estimate> {
    statistics::Sample sample;
    for (int i = 0; i < context.repeat; ++i) {
      LoopSpec spec = condition.spec;
      spec.seed = 101 + static_cast<std::uint64_t>(i);
      SL_ASSIGN(const LoopResult result, run_loop(spec));
      sample.add(result.*figure);
    }
    return estimate_of(sample);
  };
  const Condition plain{"Sox, model without S", {.world = true}},
      extended{"Sox, extended model", {.world = true, .extended_model = true}},
      babbling{"extended model, babbling drives", {.world = true, .extended_model = true, .babbling = true}},
      alone{"Sox alone", {}}, taught{"taught", {.taught = true}}, goal{"with the goal", {.goal = true}};
  page.heading("Sections 4.1.2, 4.7.1, 4.8 and 5.1.1: in a loop of numbers");
  page.paragraph(fmt::format(
      "Claims of the thesis about the learning itself, where the truth is known: x' = 0.5 y + S x + noise "
      "within "
      "{:g}, two motors and two sensors, {} steps, without a simulator. S is 0.4 times a turn by 30 degrees "
      "in 4.8, "
      "and 0 else; an agent that knew nothing, with A = I and no S, would be off by 0.71 and 0.57.",
      noise, loop_steps));
  std::vector<std::vector<std::string>> rows;
  for (const Condition& condition : {plain, extended, babbling}) {
    SL_ASSIGN(const Estimate own, measure(condition, &LoopResult::model_error));
    SL_ASSIGN(const Estimate world, measure(condition, &LoopResult::world_error));
    SL_ASSIGN(const Estimate surprise, measure(condition, &LoopResult::surprise));
    rows.push_back({condition.name, text_of(own), text_of(world), text_of(surprise)});
  }
  page.table({"agent", "error of A", "error of S", "error of the prediction (root mean square)"}, rows);
  page.paragraph(fmt::format("The noise alone makes {:.4f} of the last column.", noise / std::sqrt(3.0)));
  SL_ASSIGN(const Estimate without_teaching, measure(alone, &LoopResult::off_taught));
  SL_ASSIGN(const Estimate with_teaching, measure(taught, &LoopResult::off_taught));
  SL_ASSIGN(const Estimate without_goal, measure(alone, &LoopResult::off_goal));
  SL_ASSIGN(const Estimate with_goal, measure(goal, &LoopResult::off_goal));
  std::vector<std::vector<std::string>> times;
  for (const std::size_t sensors : {2u, 10u, 50u, 200u}) {
    SL_ASSIGN(const double sox, step_us<selforg::Sox>(sensors));
    SL_ASSIGN(const double semox, step_us<selforg::Semox>(sensors));
    times.push_back(
        {fmt::format("{}", sensors), fmt::format("{:.3g} us", sox), fmt::format("{:.3g} us", semox)});
  }
  page.table({"sensors, for two motors", "a step of Sox", "of SeMoX, in motor space"}, times);
  page.paragraph("Wall times of this machine, which differ from run to run.");
  page.table({"the thesis", "here"},
             {{"4.1.2: many sensors are used efficiently by a sensorimotor dynamics in motor space.",
               "Sox inverts a matrix of the size of the sensors, SeMoX one of the size of the motors: see "
               "the times."},
              {"4.7.1: goals enter the dynamics as additional error functions.",
               fmt::format("Mean distance of a sensor from its goal {} with the goal, {} without.",
                           text_of(with_goal), text_of(without_goal))},
              {"4.8: the enhanced world model tells what the motors cause from what the environment causes.",
               "With motors that are moved independently of the sensors A and S come near the truth. While "
               "the agent drives, "
               "motors follow the sensors, and what each causes stays ambiguous: S takes some of the error "
               "from A, not all."},
              {"5.1.1: direct teaching leads to specific behaviours.",
               fmt::format("Mean distance of a motor from what is taught {} with teaching, {} without.",
                           text_of(with_teaching), text_of(without_teaching))}});
  return {};
}

}  // namespace sandlot::app::lpzrobots
