#pragma once
/// Competing experts: a long-term memory of behaviours. Small networks compete to predict what the main controller does; each
/// becomes expert of one behaviour, matures, and can produce that behaviour again.
///
/// Network     (x(t-1), x(t-2), y(t-2)) to (x(t), y(t-1)): one hidden layer of tanh units, linear output, gradient descent.
/// Error       of expert i: e_i = |target - net_i|^2, averaged over tauE1 and tauE2 steps.
/// Winner      argmin of the average over tauE1; that of the companion, the most immature expert, counts 1 + lambda_w times.
///             Winner and companion learn with eps0 * epsMod. The winner matures: epsMod *= 1 - m / tauW, where
///             m = max(0, (0.3 - average) / 0.3).
/// Motors      those of the main controller (Sox); with expert_share s: (1 - s) main + s winner; with recall >= 0: that expert alone.
/// Source      G. Martius, thesis, sections 6.1.4 and 6.1.5; equations and defaults as of facts/lpzrobots.md section 7. The facts
///             leave lambda_w and the size of first weights open: 0.1 and +-0.1 here.
#include "selforg/sox/sox.h"

namespace sandlot::selforg {

struct ExpertMemory {
  struct Spec {
    int numSats = 20, numHidden = 2;
    double eps0 = 0.005, tauW = 1000, tauE1 = 20, tauE2 = 200, lambda_w = 0.1;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"numSats", "1", "Number of experts.", 1, 1000}, s.numSats);
      visit(Field{"numHidden", "1", "Hidden units of each expert.", 1, 1000}, s.numHidden);
      visit(Field{"eps0", "1", "Learning rate of an immature expert.", 0, 1, tunable}, s.eps0);
      visit(Field{"tauW", "1", "Steps in which a winner without error matures.", 1, 1e9, tunable}, s.tauW);
      visit(Field{"tauE1", "1", "Steps of the short average of the error.", 1, 1e6, tunable}, s.tauE1);
      visit(Field{"tauE2", "1", "Steps of the long average of the error.", 1, 1e6, tunable}, s.tauE2);
      visit(Field{"lambda_w", "1", "Handicap of the companion in the competition.", 0, 100, tunable},
            s.lambda_w);
    }
  };
  struct Expert {
    Matrix W1, b1, W2, b2;
    double error = 1, average1 = 1, average2 = 1, epsMod = 1;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"W1", "1", "Weights of the hidden layer."}, s.W1);
      visit(Field{"b1", "1", "Biases of the hidden layer."}, s.b1);
      visit(Field{"W2", "1", "Weights of the output layer."}, s.W2);
      visit(Field{"b2", "1", "Biases of the output layer."}, s.b2);
      visit(Field{"error", "1", "Squared error of the last prediction."}, s.error);
      visit(Field{"average1", "1", "Short average of the error."}, s.average1);
      visit(Field{"average2", "1", "Long average of the error."}, s.average2);
      visit(Field{"epsMod", "1", "Immaturity: factor on the learning rate."}, s.epsMod);
    }
  };
  struct State {
    std::uint64_t t = 0;
    int winner = 0, companion = 0;
    Matrix x1, x2, y1, y2;  ///< sensors and motors of one step and of two steps ago
    std::vector<Expert> experts;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"winner", "1", "Index of the winner."}, s.winner);
      visit(Field{"companion", "1", "Index of the most immature expert."}, s.companion);
      visit(Field{"x1", "1", "Sensor values one step ago."}, s.x1);
      visit(Field{"x2", "1", "Sensor values two steps ago."}, s.x2);
      visit(Field{"y1", "1", "Motor values one step ago."}, s.y1);
      visit(Field{"y2", "1", "Motor values two steps ago."}, s.y2);
      visit(Field{"experts", "1", "Networks."}, s.experts);
    }
  };
  Spec spec;
  State state;

  void init(const Setup& setup);
  bool fits(const State& s) const;
  /// The experts see the sensor values of this step; those learn that won.
  void observe(const Matrix& x, bool learn);
  /// Motor values of an expert in this step, clipped to [-1, 1]. Call between observe() and sent().
  void recall(std::size_t expert, const Matrix& x, Matrix& y);
  /// The motor values that went out in this step.
  void sent(const Matrix& x, const Matrix& y);

 private:
  void predict(const Expert& expert, const Matrix& x1, const Matrix& x2, const Matrix& y2);
  void descend(Expert& expert, double rate);
  Matrix in_, hidden_, out_, target_, delta_, back_;
};

struct Experts final : Teachable, Rewardable {
  struct Spec {
    Sox::Spec main;
    ExpertMemory::Spec memory;
    double expert_share = 0;
    int recall = -1;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"main", "", "Parameters of the main controller, a Sox."}, s.main);
      visit(Field{"memory", "", "Parameters of the experts."}, s.memory);
      visit(Field{"expert_share", "1", "Share of the winner in the motor values.", 0, 1, Field::tunable},
            s.expert_share);
      visit(Field{"recall", "1", "Index of the expert that drives alone; -1: none.", -1, 999, Field::tunable},
            s.recall);
    }
  };
  struct State {
    Sox::State main;
    ExpertMemory::State memory;
    Matrix y;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"main", "", "State of the main controller."}, s.main);
      visit(Field{"memory", "", "State of the experts."}, s.memory);
      visit(Field{"y", "1", "Motor values."}, s.y);
    }
  };
  Spec spec;
  State state;

  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);
  bool fits(const State& s) const { return main_.fits(s.main) && memory_.fits(s.memory); }
  Teachable* teachable() { return this; }
  Rewardable* rewardable() { return this; }
  void teach_motors(std::span<const double> y) override;
  void teach_sensors(std::span<const double> x) override;
  void set_reward(double reward) override;
  std::span<const double> last_motors() const override { return state.y.data; }

 private:
  /// Hands State to the parts, and at the second call back again.
  void exchange();
  Sox main_;
  ExpertMemory memory_;
  Matrix recalled_;
};

}  // namespace sandlot::selforg
