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

TEST(Charger, GivesWhatOneBatteryCannotTakeToTheNext) {
  // 4 W for two, of whom the first takes 1 W at most: 3 W are left for the second.
  model::Setup setup = movers({}, 2);
  for (int i = 0; i < 2; ++i) {
    model::Instance& robot = setup.instances[1 + static_cast<std::size_t>(i)];
    robot.X_WM.p = {0, 1.0 * i, 0.2};
    Node keys = map({{"capacity", "10 J"}, {"initial_charge", "0.5"}});
    if (i == 0) keys.set("max_charge_power", Node::scalar("1 W"));
    robot.devices.push_back(device("battery", "battery", keys));
  }
  model::Instance station = placed("station", one_shape("post", Cylinder{0.1, 0.4}, 0),
                                   {{0.5, 0.5, 0.2}, {}});
  station.is_robot = true;
  station.devices.push_back(device("charger", "charger", map({{"power", "4 W"}, {"reach", "1 m"}})));
  setup.instances.push_back(std::move(station));
  const auto simulation = build(std::move(setup));
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 5 + 1, 1e-11);
  EXPECT_NEAR(value(*simulation, "robot2/battery.energy"), 5 + 3, 1e-11);
  EXPECT_EQ(value(*simulation, "robot1/battery.rejected"), 0);
}

TEST(Charger, OfARobotDrawsNothingForBatteriesThatAreFull) {
  model::Setup setup = movers({}, 2);
  for (int i = 0; i < 2; ++i) {
    model::Instance& robot = setup.instances[1 + static_cast<std::size_t>(i)];
    robot.X_WM.p = {0, 0.6 * i, 0.2};
    robot.devices.push_back(device("battery", "battery", map({{"capacity", "10 J"}})));
  }
  setup.instances[1].devices.push_back(
      device("charger", "charger", map({{"power", "1 W"}, {"reach", "1 m"}})));
  const auto simulation = build(std::move(setup));
  advance(*simulation, 50);
  EXPECT_EQ(value(*simulation, "robot1/charger.batteries"), 1);
  EXPECT_EQ(value(*simulation, "robot1/charger.drawn"), 0);
  EXPECT_EQ(value(*simulation, "robot1/battery.energy"), 10);
}

TEST(EnergyRule, IsForTheRobotsThatItNames) {
  model::Setup setup = movers({}, 2);
  for (std::size_t i = 1; i <= 2; ++i)
    setup.instances[i].devices.push_back(
        device("battery", "battery", map({{"capacity", "1 J"}, {"drain", "2 W"}})));
  model::ElementDecl rule;
  rule.name = rule.kind = "energy";
  rule.config.set("robots", Node::sequence()).push(Node::scalar("robot2"));
  setup.rules.push_back(rule);
  const auto simulation = build(std::move(setup));
  advance(*simulation, 60);  // both are empty after 0.5 s
  EXPECT_EQ(value(*simulation, "robot1/battery.empty"), 1);
  EXPECT_EQ(value(*simulation, "rules/energy.count"), 1);
  drive(*simulation, 1, 0, "robot1");
  drive(*simulation, 1, 0, "robot2");
  advance(*simulation, 1);
  EXPECT_TRUE(simulation->outcomes()[0].status);
  EXPECT_FALSE(simulation->outcomes()[1].status);
}

}  // namespace
}  // namespace sandlot::test
