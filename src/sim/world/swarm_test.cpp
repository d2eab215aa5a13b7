/// The swarm as its scenario file runs it: what the robots do, and that pools, threads and snapshots change nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controllers/controllers.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

model::Setup swarm(int robots, const std::vector<formats::Override>& more = {}) {
  Diagnostics diagnostics;
  LoadOptions options;
  std::vector<formats::Override> overrides = more;
  overrides.push_back({"robots.count", std::to_string(robots)});
  options.overrides = overrides;
  auto setup = load("scenarios/swarm.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error().text());
  return std::move(*setup);
}

std::unique_ptr<Simulation> simulation(model::Setup setup, const SimulationOptions& options = {}) {
  Diagnostics diagnostics;
  auto made = Simulation::create(std::move(setup), options, diagnostics);
  EXPECT_TRUE(made) << (made ? "" : made.error().text());
  return std::move(*made);
}

void run(Simulation& sim, int ticks) {
  for (int i = 0; i < ticks; ++i) ASSERT_TRUE(sim.tick());
}

std::vector<Vec3> places(const Simulation& sim) {
  std::vector<Vec3> out;
  for (const auto& entity : sim.entities())
    if (entity->instance.is_robot) out.push_back(sim.engine().pose(entity->id).p);
  return out;
}

/// Mean square distance from where each began.
double spread_m2(const std::vector<Vec3>& begin, const std::vector<Vec3>& now) {
  double sum = 0;
  for (std::size_t i = 0; i < begin.size(); ++i) sum += dot(now[i] - begin[i], now[i] - begin[i]);
  return sum / static_cast<double>(begin.size());
}

TEST(Swarm, StandsApartAtItsDensityWithinItsWalls) {
  for (const int robots : {1, 7, 300}) {
    const auto sim = simulation(swarm(robots));
    const std::vector<Vec3> at = places(*sim);
    ASSERT_EQ(at.size(), static_cast<std::size_t>(robots));
    // One per 2 m^2, and 0.3 m from the walls.
    const double most_m = std::sqrt(2.0 * robots) / 2 - 0.3;
    for (std::size_t i = 0; i < at.size(); ++i) {
      EXPECT_LE(std::max(std::abs(at[i].x), std::abs(at[i].y)), most_m + 1e-9);
      for (std::size_t k = 0; k < i; ++k)
        ASSERT_GE(dot(at[i] - at[k], at[i] - at[k]), 0.3 * 0.3 - 1e-9) << i << " and " << k;
    }
  }
}

TEST(Swarm, SpreadsAndKeepsApart) {
  const auto sim = simulation(swarm(100));
  const std::vector<Vec3> begin = places(*sim);
  run(*sim, 20);
  const double early = spread_m2(begin, places(*sim));
  // Free for 2 s at 0.2 m/s, a tick to set out and 0.1 s to speed up: at most (0.4 m)^2, which most of them reach.
  EXPECT_LT(early, 0.16);
  EXPECT_GT(early, 0.08);
  run(*sim, 180);
  EXPECT_GT(spread_m2(begin, places(*sim)), 4 * early);
  const std::vector<Vec3> at = places(*sim);
  const double half = std::sqrt(200.0) / 2;
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_LE(std::max(std::abs(at[i].x), std::abs(at[i].y)), half - 0.08);
    // Discs of 0.085 m that the engine lets overlap by a few millimetres at most.
    for (std::size_t k = 0; k < i; ++k) EXPECT_GT(dot(at[i] - at[k], at[i] - at[k]), 0.165 * 0.165);
  }
}

TEST(Swarm, IsTheSameInAnyNumberOfThreads) {
  std::uint64_t hash = 0;
  for (const int threads : {1, 2, 4}) {
    const auto sim = simulation(swarm(300), {.threads = threads});
    run(*sim, 30);
    if (threads == 1) hash = sim->state_hash();
    EXPECT_EQ(sim->state_hash(), hash) << threads << " threads";
  }
}

/// The same controller as a kind of its own without step_all, so that it is stepped one by one.
TEST(Swarm, PoolAndSingleControllersGiveTheSameBits) {
  const auto kinds = controller_kinds();
  const auto pooled = *std::find_if(kinds.begin(), kinds.end(), [](const ControllerKind* k) {
    return std::string_view(k->name) == "diffusion";
  });
  ASSERT_NE(pooled->step_all, nullptr);
  ControllerKind single = *pooled;
  single.name = "one_by_one";
  single.step_all = nullptr;
  const ControllerKind* const more[] = {&single};
  model::Setup setup = swarm(60);
  const auto a = simulation(setup);
  for (model::Instance& instance : setup.instances)
    for (model::ControllerDecl& decl : instance.controllers) decl.kind = "one_by_one";
  const auto b = simulation(std::move(setup), {.extra_controllers = more});
  // Halves of it, mixed: kinds are stepped one after the other, robots keep their order.
  setup = swarm(60);
  for (std::size_t i = 0; i < setup.instances.size(); i += 2)
    for (model::ControllerDecl& decl : setup.instances[i].controllers) decl.kind = "one_by_one";
  const auto c = simulation(std::move(setup), {.extra_controllers = more});
  for (int i = 0; i < 60; ++i) {
    run(*a, 1), run(*b, 1), run(*c, 1);
    ASSERT_EQ(a->state_hash(), b->state_hash()) << "tick " << i;
    ASSERT_EQ(a->state_hash(), c->state_hash()) << "tick " << i;
  }
}

TEST(Swarm, GoesOnFromASnapshot) {
  const auto whole = simulation(swarm(50));
  run(*whole, 25);
  const std::vector<std::byte> half = whole->snapshot();
  run(*whole, 25);
  Diagnostics diagnostics;
  auto rest = Simulation::restore(half, {.threads = 2}, diagnostics);
  ASSERT_TRUE(rest) << rest.error().text();
  run(**rest, 25);
  EXPECT_EQ((*rest)->state_hash(), whole->state_hash());
}

TEST(Swarm, ADriveWithoutOdometryMovesTheSame) {
  const auto quiet = simulation(swarm(20));
  const auto telling = simulation(swarm(20, {{"robots.devices.drive.odometry", "true"}}));
  run(*quiet, 40), run(*telling, 40);
  EXPECT_EQ(quiet->find_topic("/scout1/drive/ideal"), nullptr);
  ASSERT_NE(telling->find_topic("/scout1/drive/ideal"), nullptr);
  const auto a = places(*quiet), b = places(*telling);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i], b[i]);
}

TEST(Swarm, RobotsOfAGroupShareWhatTheyWereDeclaredWithUntilOneIsTuned) {
  const auto sim = simulation(swarm(20));
  const auto entities = sim->entities();
  const Simulation::Entity &first = *entities[entities.size() - 2], &second = *entities.back();
  EXPECT_TRUE(first.instance.devices.shares_with(second.instance.devices));
  EXPECT_TRUE(first.instance.controllers.shares_with(second.instance.controllers));
  EXPECT_EQ(&first.programs[0]->decl, &second.programs[0]->decl);
  run(*sim, 2);
  const auto number = [](const Simulation& of, const Simulation::Entity& entity) {
    const ValueStep path[] = {{"max_linear_speed"}};
    return of.pool(*entity.devices[0]).value(entity.devices[0]->index, ValuePart::parameter, path).value;
  };
  sim->submit(ParameterRequest{second.devices[0]->path, "max_linear_speed", Node::scalar("0.05")});
  run(*sim, 1);
  EXPECT_EQ(number(*sim, first), 0.5) << "a neighbour's speed was changed";
  EXPECT_EQ(number(*sim, second), 0.05);
  // A snapshot gives each its own again.
  Diagnostics diagnostics;
  const auto back = Simulation::restore(sim->snapshot(), {}, diagnostics);
  ASSERT_TRUE(back);
  const auto again = (*back)->entities();
  EXPECT_EQ(number(**back, *again[again.size() - 2]), 0.5);
  EXPECT_EQ(number(**back, *again.back()), 0.05);
  run(*sim, 3), run(**back, 3);
  EXPECT_EQ(sim->state_hash(), (*back)->state_hash());
}

}  // namespace
}  // namespace sandlot
