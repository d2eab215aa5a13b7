#include "selforg/experts/experts.h"

#include "base/math.h"
#include "selforg/primitives/primitives.h"
#include "selforg/test_reference.h"

namespace sandlot::selforg::test {
namespace {

TEST(Experts, NetworksLearnAsTheLiteralOnes) {
  Stream random(1, 2, Purpose::experiment, 1);
  ExpertMemory memory;
  memory.spec.numSats = 4;
  memory.spec.numHidden = 3;
  memory.spec.eps0 = 0.05;
  memory.spec.tauE1 = 200;
  memory.init({2, 2, 1, "experts"});
  for (ExpertMemory::Expert& each : memory.state.experts) each.average1 = 0.1;  // good enough to mature
  for (int k = 0; k < 30; ++k) {
    const Matrix x = random_matrix(random, 2, 1), y = random_matrix(random, 2, 1);
    const ExpertMemory::State s = memory.state;
    memory.observe(x, true);
    if (k >= 2) {
      Ref in(6, 1), target(4, 1);
      for (std::size_t i = 0; i < 2; ++i) {
        in.at[i][0] = s.x1[i], in.at[2 + i][0] = s.x2[i], in.at[4 + i][0] = s.y2[i];
        target.at[i][0] = x[i], target.at[2 + i][0] = s.y1[i];
      }
      std::size_t companion = 0, winner = 0;
      std::vector<Real> averages;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& e = s.experts[i];
        const Ref out = Ref(e.W2) * squash(Ref(e.W1) * in + Ref(e.b1)) + Ref(e.b2);
        averages.push_back(Real(e.average1) + (norm2(target - out) - Real(e.average1)) / 200);
        EXPECT_NEAR(memory.state.experts[i].average1, static_cast<double>(averages[i]), 1e-12);
        if (e.epsMod > s.experts[companion].epsMod) companion = i;
      }
      std::vector<Real> competing = averages;
      competing[companion] *= Real(1.1);
      for (std::size_t i = 1; i < 4; ++i)
        if (competing[i] < competing[winner]) winner = i;
      ASSERT_EQ(memory.state.winner, static_cast<int>(winner));
      ASSERT_EQ(memory.state.companion, static_cast<int>(companion));
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& e = s.experts[i];
        Ref W1 = e.W1, W2 = e.W2, b1 = e.b1, b2 = e.b2;
        if (i == winner || i == companion) {
          const Ref hidden = squash(W1 * in + b1), delta = target - (W2 * hidden + b2);
          const Ref back = (W2.T() * delta) & hidden.map([](Real u) { return 1 - u * u; });
          const Real rate = Real(0.05) * Real(e.epsMod);
          W2 = W2 + rate * (delta * hidden.T());
          b2 = b2 + rate * delta;
          W1 = W1 + rate * (back * in.T());
          b1 = b1 + rate * back;
        }
        expect_near(memory.state.experts[i].W1, W1, 1e-12, "W1");
        expect_near(memory.state.experts[i].W2, W2, 1e-12, "W2");
        expect_near(memory.state.experts[i].b1, b1, 1e-12, "b1");
        expect_near(memory.state.experts[i].b2, b2, 1e-12, "b2");
        const Real mature = i == winner ? std::max<Real>(0, (Real(0.3) - averages[i]) / Real(0.3)) : 0;
        EXPECT_NEAR(memory.state.experts[i].epsMod, static_cast<double>(e.epsMod * (1 - mature / 1000)),
                    1e-12);
      }
    }
    memory.sent(x, y);
  }
}

/// Two rhythms in turn: an expert wins each, and gives it back.
TEST(Experts, DifferentBehavioursGetDifferentExpertsThatRecallThem) {
  ExpertMemory memory;
  memory.spec.numSats = 4;
  memory.spec.numHidden = 4;
  memory.spec.eps0 = 0.05;
  memory.init({2, 1, 5, "experts"});
  // Behaviour 0: the motor follows sensor 0; behaviour 1: it opposes it. The sensors turn.
  Matrix x(2, 1), y(1, 1), recalled(1, 1);
  int winners[2] = {-1, -1};
  for (int k = 0; k < 60'000; ++k) {
    const int behaviour = k / 2000 % 2;
    const double angle = 0.2 * k;
    x[0] = 0.8 * math::cos(angle), x[1] = 0.8 * math::sin(angle);
    y[0] = behaviour == 0 ? 0.8 * x[0] : -0.8 * x[0];
    memory.observe(x, k < 56'000);
    if (k % 2000 == 1999) winners[behaviour] = memory.state.winner;
    if (k >= 56'000 && k % 2000 > 1000) {
      memory.recall(static_cast<std::size_t>(winners[behaviour]), x, recalled);
      EXPECT_NEAR(recalled[0], y[0], 0.2) << k;
    }
    memory.sent(x, y);
  }
  EXPECT_NE(winners[0], winners[1]);
}

TEST(QLearning, UpdatesAreWatkins) {
  QLearning q;
  q.spec = {.eps = 0.5, .discount = 0.8, .expl = 0, .elig = 0.5};
  q.init(3, 2);
  const Stream random(1, 2, Purpose::experiment, 3);
  EXPECT_EQ(q.choose(0, 0, true, random), 0u);
  // Reward 1 for action 0 in state 0: delta = 1, Q = 0.5.
  EXPECT_EQ(q.choose(1, 1, true, random), 0u);
  EXPECT_DOUBLE_EQ(q.state.Q(0, 0), 0.5);
  // Then reward -2 from state 1: delta = -2; the trace of (0, 0) is 0.8 * 0.5 = 0.4, so Q(0, 0) loses 0.4, and Q(1, 0) 1.
  EXPECT_EQ(q.choose(1, -2, true, random), 1u) << "action 0 has proved bad";
  EXPECT_DOUBLE_EQ(q.state.Q(1, 0), -1);
  EXPECT_DOUBLE_EQ(q.state.Q(0, 0), 0.1);
}

TEST(QLearning, FindsTheOptimalValuesOfAChain) {
  // Five places in a row; right from the last gives reward 1 and leads to the first. Optimal: always right, and from place s
  // Q = 0.9^(4-s) / (1 - 0.9^5).
  QLearning q;
  q.spec = {.eps = 0.2, .discount = 0.9, .expl = 0.3, .elig = 0.3};
  q.init(5, 2);
  std::uint32_t place = 0;
  double reward = 0;
  for (std::uint64_t k = 0; k < 200'000; ++k) {
    const std::uint32_t action = q.choose(place, reward, true, Stream(1, 2, Purpose::experiment, k));
    reward = action == 1 && place == 4 ? 1 : 0;
    place = action == 1 ? (place + 1) % 5 : place > 0 ? place - 1 : 0;
  }
  for (std::uint32_t s = 0; s < 5; ++s) {
    EXPECT_NEAR(q.state.Q(s, 1), math::pow(0.9, 4.0 - s) / (1 - math::pow(0.9, 5)), 0.02) << s;
    EXPECT_GT(q.state.Q(s, 1), q.state.Q(s, 0));
  }
}

/// A corridor on a ring of two situations: primitive 0 runs into the obstacle, primitive 1 turns away and does not move.
TEST(Primitives, CombinationAvoidsObstaclesBetterThanEachAlone) {
  const auto run = [](int only) {
    Primitives p;
    p.spec.primitives.resize(2);
    p.spec.primitives[0].biases = {1, 1};
    p.spec.primitives[1].biases = {-1, 1};
    p.spec.senses = {0};
    p.spec.bins = 2;
    p.spec.interval = 5;
    if (only >= 0) p.spec.primitives = {p.spec.primitives[static_cast<std::size_t>(only)]};
    EXPECT_TRUE(static_cast<bool>(p.init({1, 2, 1, "p"})));
    Matrix x(1, 1), y(2, 1);
    double distance = 10, total = 0;  // steps to the wall ahead
    for (int k = 0; k < 20'000; ++k) {
      x[0] = distance < 5 ? 1 : -1;
      p.step(x, y, Mode::learn);
      const bool forward = y[0] > 0;
      double reward = 0;
      if (forward) reward = distance > 0 ? 0.2 : -1, distance = std::max(distance - 1, 0.0);
      else distance = std::min(distance + 3, 12.0);  // the view after a turn is freer
      p.set_reward(reward);
      if (k > 10'000) total += reward;
    }
    return total;
  };
  const double both = run(-1), ahead = run(0), turning = run(1);
  EXPECT_GT(both, ahead + 1000);
  EXPECT_GT(both, turning + 500);
}

TEST(Primitives, RefusesWhatDoesNotFit) {
  Primitives p;
  p.spec.primitives.resize(1);
  p.spec.primitives[0].weights = {1, 2, 3};
  EXPECT_FALSE(static_cast<bool>(p.init({2, 2})));
  p.spec.primitives[0].weights.clear();
  p.spec.senses = {2};
  EXPECT_FALSE(static_cast<bool>(p.init({2, 2})));
  p.spec.senses = {0, 1};
  p.spec.bins = 100;
  EXPECT_TRUE(static_cast<bool>(p.init({2, 2})));
  EXPECT_EQ(p.situation(Matrix(2, 1, 1)), 100u * 100 - 1);
  EXPECT_EQ(p.situation(Matrix(2, 1, -1)), 0u);
}

}  // namespace
}  // namespace sandlot::selforg::test
