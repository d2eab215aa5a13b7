/// Many chargers among many batteries: who is in reach.
#include <gtest/gtest.h>

#include "sim/world/test_movers.h"

namespace sandlot::test {
namespace {

TEST(Charger, ReachesTheBatteriesWithinItsDistanceAmongMany) {
  // Robots 1 m apart on a square of 12 by 12, among them chargers of several reaches, one of them switched off: each counts the
  // lattice points within its reach, also those at exactly this distance (3 and 4 m along the axes: 5 m).
  constexpr int side = 12;
  for (const char* const engine : {"planar", "rigid"}) {
    model::Setup setup = movers({}, side * side, engine);
    for (int i = 0; i < side * side; ++i) {
      model::Instance& robot = setup.instances[1 + static_cast<std::size_t>(i)];
      robot.X_WM.p = {1.0 * (i % side), 1.0 * (i / side), 0.2};
      robot.devices.push_back(
          device("battery", "battery", map({{"capacity", "10 J"}, {"initial_charge", "0.5"}})));
    }
    struct Station {
      int x, y;
      double reach_m;
      bool on;
    };
    const std::vector<Station> stations{{0, 0, 1, true},    {6, 6, 0.5, true},  {6, 6, 2, true},
                                        {11, 0, 5, true},   {-7, 5, 6.9, true}, {-7, 5, 7, true},
                                        {20, 20, 60, true}, {3, 3, 2, false},   {4, 9, 3.1, true}};
    for (std::size_t k = 0; k < stations.size(); ++k) {
      const Station& each = stations[k];
      // High above the robots' heads, so that nothing touches, and the charger as high as the batteries.
      model::Instance station = placed("station" + std::to_string(k),
                                       one_shape("post", Cylinder{0.1, 0.4}, 0),
                                       {{1.0 * each.x, 1.0 * each.y, 2}, {}});
      station.is_robot = true;
      station.devices.push_back(device("charger", "charger",
                                       map({{"power", "1 W"},
                                            {"reach", std::to_string(each.reach_m)},
                                            {"on", each.on ? "true" : "false"}}),
                                       {{0, 0, -1.8}, {}}));
      setup.instances.push_back(std::move(station));
    }
    const auto simulation = build(std::move(setup));
    advance(*simulation, 1);
    std::vector<double> charged_J(side * side);
    for (std::size_t k = 0; k < stations.size(); ++k) {
      const Station& each = stations[k];
      std::vector<std::size_t> near;
      for (std::size_t i = 0; i < charged_J.size(); ++i) {
        const int dx = static_cast<int>(i) % side - each.x, dy = static_cast<int>(i) / side - each.y;
        if (each.on && dx * dx + dy * dy <= each.reach_m * each.reach_m) near.push_back(i);
      }
      for (const std::size_t i : near) charged_J[i] += 0.01 / static_cast<double>(near.size());
      const std::string count = "station" + std::to_string(k) + "/charger.batteries";
      EXPECT_EQ(value(*simulation, count.c_str()), near.size()) << engine << " " << count;
    }
    for (std::size_t i = 0; i < charged_J.size(); ++i) {
      const std::string energy = "robot" + std::to_string(i + 1) + "/battery.charged";
      EXPECT_NEAR(value(*simulation, energy.c_str()), charged_J[i], 1e-12) << engine << " " << energy;
    }
  }
}

}  // namespace
}  // namespace sandlot::test
