#pragma once
/// Primitives: a task solved by Q-learning over ready behaviours. Every `interval` steps it chooses one of several primitives by the
/// sensor values and the rewards so far, and runs it.
///
/// Primitive  y = clip(W x + bias), a Braitenberg vehicle with custom weights.
/// State      the sensors in `senses`, each in `bins` equal intervals of [-1, 1].
/// Reward     set_reward(), summed over the interval.
/// Q          Watkins' Q(lambda): delta = r + discount max_a Q(s', a) - Q(s, a); e(s, a) = 1; Q += eps delta e;
///            e *= discount elig, and 0 after an exploring choice.
/// Choice     greedy; with probability expl any, drawn for the step.
/// Source     C. Watkins (1989), R. Sutton, A. Barto: Reinforcement Learning (1998), section 7.6; the task of G. Martius, thesis,
///            section 6.2.3 (4.6 of the issue). Interval of 10 steps as of facts/lpzrobots.md section 7; the other defaults are ours.
#include "selforg/controller.h"

namespace sandlot::selforg {

/// Table of values of actions in states, learned from rewards. Numbers in, numbers out: for any set of behaviours.
struct QLearning {
  struct Spec {
    double eps = 0.1, discount = 0.9, expl = 0.05, elig = 0.5;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"eps", "1", "Learning rate.", 0, 1, tunable}, s.eps);
      visit(Field{"discount", "1", "Weight of the value one choice later.", 0, 0.999999, tunable},
            s.discount);
      visit(Field{"expl", "1", "Probability of a choice at random.", 0, 1, tunable}, s.expl);
      visit(Field{"elig", "1", "Decay of eligibility from one choice to the next: lambda.", 0, 1, tunable},
            s.elig);
    }
  };
  struct State {
    Matrix Q, trace;  ///< states x actions
    std::uint32_t state = 0, action = 0;
    bool begun = false;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"Q", "1", "Expected sum of rewards of each action in each state."}, s.Q);
      visit(Field{"trace", "1", "Eligibility of each action in each state."}, s.trace);
      visit(Field{"state", "1", "Index of the last state."}, s.state);
      visit(Field{"action", "1", "Index of the last action."}, s.action);
      visit(Field{"begun", "", "Whether there was a choice before."}, s.begun);
    }
  };
  Spec spec;
  State state;

  void init(std::size_t states, std::size_t actions);
  bool fits(const State& s) const { return s.state < s.Q.rows && s.action < s.Q.cols; }
  /// Learns from what followed the last choice, and chooses again.
  /// @param reward  since the last choice  @param learn  false: greedy choice from what was learned
  /// @return index of the action
  std::uint32_t choose(std::uint32_t now, double reward, bool learn, Stream random);
};

struct Primitives final : Rewardable {
  struct Primitive {
    std::string name;
    std::vector<double> weights, biases;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"name", "", "Name of the primitive, for messages.", 0, 0, Field::none, 100}, s.name);
      visit(Field{"weights", "1", "Weights, motor after motor; empty: zero.", -1e3, 1e3}, s.weights);
      visit(Field{"biases", "1", "Motor values without stimulus, one per motor; empty: zero.", -1, 1},
            s.biases);
    }
  };
  struct Spec {
    std::vector<Primitive> primitives;
    std::vector<int> senses;
    int bins = 3, interval = 10;
    QLearning::Spec learning;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"primitives", "", "Behaviours to choose from.", 0, 0, Field::required, 100, 1},
            s.primitives);
      visit(Field{"senses", "1", "Indices of the sensors that tell situations apart; empty: all.", 0, 10'000,
                  Field::none, 16},
            s.senses);
      visit(Field{"bins", "1", "Intervals of each of these sensors.", 1, 100}, s.bins);
      visit(Field{"interval", "1", "Steps from choice to choice.", 1, 1e6}, s.interval);
      visit(Field{"learning", "", "Parameters of the learning."}, s.learning);
    }
  };
  struct State {
    std::uint64_t t = 0;
    double reward = 0;
    QLearning::State learning;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"reward", "1", "Sum of rewards since the last choice."}, s.reward);
      visit(Field{"learning", "", "State of the learning."}, s.learning);
    }
  };
  Spec spec;
  State state;

  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);
  bool fits(const State& s) const { return learning_.fits(s.learning); }
  Rewardable* rewardable() { return this; }
  void set_reward(double reward) override { state.reward += clipped(reward, 1); }
  /// Index of the situation that sensor values are in.
  std::uint32_t situation(const Matrix& x) const;

 private:
  Setup setup_;
  QLearning learning_;
  std::vector<Matrix> weights_, biases_;
};

}  // namespace sandlot::selforg
