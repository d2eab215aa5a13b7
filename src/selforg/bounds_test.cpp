/// Long runs at the bounds of the parameters, and hashes that every compiler must give.
#include "selforg/agent.h"
#include "selforg/test_reference.h"

namespace sandlot::selforg::test {
namespace {

/// Sets each tunable number of a controller to one end of its range: bit i of `corner` chooses that of parameter i.
void to_corner(Controller& controller, std::uint64_t corner) {
  std::size_t i = 0;
  for (const FieldInfo& field : controller.describe()) {
    if (!field.tunable) continue;
    if (field.type == "number" || field.type == "integer") {
      const double bound = (corner >> (i++ % 64)) & 1 ? field.max : field.min;
      const Status set = controller.set(field.path, bound);
      EXPECT_TRUE(static_cast<bool>(set)) << field.path;
    } else if (field.type == "choice") {
      const auto& choice = field.choices[(corner >> 5) % field.choices.size()];
      EXPECT_TRUE(static_cast<bool>(controller.set(field.path, choice.c_str()))) << field.path;
    }
  }
}

/// @return whether everything stayed finite and motors within +-1
bool survives(Controller& controller, std::uint64_t steps, std::uint64_t seed) {
  std::vector<double> x(controller.sensors()), y(controller.motors());
  for (std::uint64_t k = 0; k < steps; ++k) {
    Stream random(seed, 1, Purpose::experiment, k);
    const std::uint32_t weather = random.below(16);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = random.uniform(-1, 1);
      if (weather == 0) x[i] *= 1e300;
      if (weather == 1) x[i] = 0;
      if (weather == 2 && i == 0) x[i] = std::nan("");
      if (weather > 8 && !y.empty()) x[i] = y[i % y.size()];  // a closed loop
    }
    if (weather == 3 && controller.teachable()) controller.teachable()->teach_sensors(x);
    if (weather == 4 && controller.teachable()) controller.teachable()->teach_motors(y);
    if (weather == 5 && controller.rewardable()) controller.rewardable()->set_reward(x.empty() ? 1 : x[0]);
    controller.step(x, y, weather == 6 ? Mode::babble : Mode::learn);
    for (const double each : y)
      if (!(std::abs(each) <= 1)) return false;
  }
  bool finite = true;
  controller.channels([&](const Channel& channel) { finite = finite && all_finite(channel.values); });
  return finite;
}

constexpr const char* learners[] = {"sox", "semox", "dep", "experts"};

TEST(Bounds, EveryCornerOfTheParametersStaysFinite) {
  for (const char* kind : learners)
    for (std::uint64_t corner = 0; corner < 40; ++corner) {
      const std::uint64_t bits = corner == 0 ? ~0ull : corner == 1 ? 0 : mix64(corner);
      auto made = make_controller(kind, {3, 2, corner, "bounds"});
      ASSERT_TRUE(static_cast<bool>(made));
      to_corner(**made, bits);
      EXPECT_TRUE(survives(**made, 400, corner)) << kind << " at corner " << corner;
    }
}

TEST(SlowBounds, AMillionStepsStayFinite) {
  for (const char* kind : {"sox", "semox", "dep"})
    for (const std::uint64_t bits : {~std::uint64_t{0}, mix64(7), mix64(8)}) {
      auto made = make_controller(kind, {4, 3, 1, "bounds"});
      ASSERT_TRUE(static_cast<bool>(made));
      to_corner(**made, bits);
      EXPECT_TRUE(survives(**made, 1'000'000, bits)) << kind << " at corner " << bits;
    }
}

/// Hash of all State after some hundred steps in a world of one's own echo.
std::uint64_t hash_after(const char* kind, std::size_t n, std::size_t m) {
  AgentSpec spec;
  spec.controller = kind;
  spec.seed = 21;
  spec.wiring = {{"derivative", {}}, {"one_to_one", {}}};
  auto made = WiredController::make(n, m, spec);
  EXPECT_TRUE(static_cast<bool>(made));
  std::vector<double> x(n), y(m);
  for (int k = 0; k < 400; ++k) {
    (*made)->step(x, y);
    for (std::size_t i = 0; i < n; ++i)
      x[i] = 0.7 * x[i] + 0.3 * y[i % m] * (1 + 0.1 * static_cast<double>(i));
  }
  ByteWriter w;
  (*made)->save(w);
  return hash64(w.bytes());
}

// The same numbers from gcc and clang, with and without optimisation.
TEST(Determinism, EveryBuildGivesTheseHashes) {
  EXPECT_EQ(hash_after("sox", 9, 18), 14019986095117683285u);
  EXPECT_EQ(hash_after("sox", 3, 2), 9381497162563713875u);
  EXPECT_EQ(hash_after("semox", 7, 4), 5285516909657385420u);
  EXPECT_EQ(hash_after("dep", 5, 5), 5671204836109878174u);
  EXPECT_EQ(hash_after("experts", 4, 3), 16712224303586590273u);
}

}  // namespace
}  // namespace sandlot::selforg::test
