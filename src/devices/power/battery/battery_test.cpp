#include "devices/power/battery/battery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::battery {
namespace {

using test::config;
using test::Rig;
using testing::HasSubstr;

TEST(OpenCircuit, InvertsItsOwnEnergy) {
  // 9 V to 11 V over the first half, then to 10 V: falling pieces are allowed, too.
  const Point points[] = {{0, 9}, {0.5, 11}, {1, 10}};
  const OpenCircuit curve(points);
  EXPECT_NEAR(curve.mean_V(), 0.5 * 10 + 0.5 * 10.5, 1e-15);
  EXPECT_NEAR(curve.energy_at(0.25), 0.25 * 9.5, 1e-15);  // at 10 V half way
  for (const double charge : {0.0, 0.1, 0.25, 0.5, 0.7, 1.0}) {
    const OpenCircuit::At at = curve.at(curve.energy_at(charge));
    EXPECT_NEAR(at.charge, charge, 1e-15);
    EXPECT_NEAR(at.voltage_V, charge < 0.5 ? 9 + 4 * charge : 11 - 2 * (charge - 0.5), 1e-14);
  }
}

/// A battery of 100 J and 10 V behind 1 ohm in an account with one meter.
struct Bench : Rig {
  EnergyAccount own;
  EnergyMeter meter;
  explicit Bench(const char* initial = "0.5", const char* most_W = "1e9")
      : Rig(kind, test::two_wheels(), 0.1) {
    account = &own;
    own.meters.push_back(&meter);
    const Status added = add("b", config({{"capacity", "100"},
                                          {"voltage", "10"},
                                          {"resistance", "1"},
                                          {"initial_charge", initial},
                                          {"recuperation", "0.5"},
                                          {"max_charge_power", most_W}}));
    EXPECT_TRUE(added) << (added ? "" : added.error().text());
  }
  void settle() {
    pool->settle(context(now + tick), due());
    now = now + tick;
  }
  double state(const char* name) {
    auto path = parse_value_path(name);
    return pool->value(0, ValuePart::state, *path).value;
  }
};

TEST(Battery, TakesWhatIsGivenBackAndWhatChargersOffer) {
  // 1.6 J given back, of which half arrives, and 0.3 J offered in 0.1 s: 11 W into 10 V behind 1 ohm make
  // J = 22 / (10 + sqrt(100 + 44)) = 1 A, 10 W of which stay.
  Bench bench;
  bench.meter.draw(-1.6);
  bench.own.offered_J = 0.3;
  bench.settle();
  EXPECT_NEAR(bench.state("load_current"), -1, 1e-14);
  EXPECT_NEAR(bench.state("terminal_voltage"), 11, 1e-13);
  EXPECT_NEAR(bench.state("energy"), 51, 1e-13);
  EXPECT_NEAR(bench.state("lost"), 0.1, 1e-15);
  EXPECT_NEAR(bench.state("charged"), 0.3, 1e-15);
  EXPECT_NEAR(bench.state("rejected"), 0.8, 1e-15);
  EXPECT_NEAR(bench.meter.state.drawn_J, -0.8, 1e-15);
  EXPECT_NEAR(bench.state("drained"), -0.8 + 0.1, 1e-15);
  EXPECT_EQ(bench.own.offered_J, 0);
}

TEST(Battery, TakesNoMoreThanItsGreatestPowerAndChargersFirst) {
  // Of 0.8 J and 0.3 J in 0.1 s, as above, 5 W are taken: the charger's 0.3 J and 0.2 J of the motors'. 5 W into 10 V behind
  // 1 ohm make J = 10 / (10 + sqrt(100 + 20)).
  Bench bench("0.5", "5");
  bench.meter.draw(-1.6);
  bench.own.offered_J = 0.3;
  bench.settle();
  const double current_A = 10 / (10 + std::sqrt(120.0)), lost_J = 0.1 * current_A * current_A;
  EXPECT_NEAR(bench.state("load_current"), -current_A, 1e-14);
  EXPECT_NEAR(bench.state("energy"), 50 + 0.5 - lost_J, 1e-13);
  EXPECT_NEAR(bench.state("charged"), 0.3, 1e-15);
  EXPECT_NEAR(bench.meter.state.drawn_J, -0.2, 1e-15);
  EXPECT_NEAR(bench.state("rejected"), 0.8 + 0.6, 1e-15);
  EXPECT_NEAR(bench.state("drained"), -0.2 + lost_J, 1e-15);
}

TEST(Battery, AFullOneTakesNothingBack) {
  Bench bench("1");
  bench.meter.draw(-1.6);
  bench.settle();
  EXPECT_EQ(bench.state("energy"), 100);
  EXPECT_EQ(bench.state("rejected"), 1.6);
  EXPECT_EQ(bench.meter.state.drawn_J, 0);
  EXPECT_EQ(bench.own.room(0.1), 0);
  bench.sense();
  EXPECT_EQ(bench.topic<msg::BatteryState>("b/state").message.power_supply_status, 4);
}

TEST(Battery, RefusesForgedState) {
  Bench bench;
  const std::vector<std::byte> good = bench.saved();
  bench.load(good);
  int refused = 0;
  for (std::size_t at = 0; at + 8 <= good.size(); at += 8) {
    std::vector<std::byte> forged = good;
    const double number = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(&forged[at], &number, 8);
    ByteReader r(forged);
    bench.pool->load(0, r);
    refused += !r.ok();
  }
  EXPECT_GE(refused, 12);  // two parameters and ten numbers of its state
  bench.load(good);
  EXPECT_EQ(bench.own.energy_J, 50);
}

TEST(Battery, ReadsTheLinearBatteryOfGazebo) {
  Node element = config({{"battery_name", "b"},
                         {"voltage", "4.2"},
                         {"open_circuit_voltage_constant_coef", "4.2"},
                         {"open_circuit_voltage_linear_coef", "-2.0"},
                         {"initial_charge", "1.25"},
                         {"capacity", "2.5"},
                         {"resistance", "0.07"},
                         {"smooth_current_tau", "2.0"},
                         {"power_load", "2.1"},
                         {"enable_recharge", "true"}});
  Diagnostics diagnostics;
  auto keys = from_sdf(element, diagnostics);
  ASSERT_TRUE(keys) << keys.error().text();
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_THAT(diagnostics.warnings[0].text(), HasSubstr("<enable_recharge> has no effect"));
  EXPECT_EQ(keys->find("drain")->text(), "2.1");
  keys->erase("drain");  // for the simulation
  Rig rig(kind, test::two_wheels());
  EnergyAccount account;
  rig.account = &account;
  const Status added = rig.add("b", *keys);
  ASSERT_TRUE(added) << added.error().text();
  // V = e0 + e1 (1 - q): 3.2 V at half charge; 1.25 Ah at the mean of 2.2 V and 3.2 V.
  EXPECT_NEAR(account.energy_J, 1.25 * 3600 * 2.7, 1e-9);
  EXPECT_NEAR(account.fraction, 0.5, 1e-15);
  for (const char* key : {"capacity", "open_circuit_voltage_constant_coef"}) {
    Node broken = element;
    broken.set(key, Node::scalar("0"));
    EXPECT_FALSE(from_sdf(broken, diagnostics)) << key;
  }
}

}  // namespace
}  // namespace sandlot::battery
