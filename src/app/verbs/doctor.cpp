#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands.h"
#include "app/demos.h"
#include "base/json_text.h"
#include "base/math.h"
#include "base/random.h"
#include "programs/sandbox.h"
#include "run/summary.h"
#include "server/server.h"
#include "sim/load/load.h"

namespace sandlot::app {
namespace {

struct Complaint {
  std::string name;
  bool ok;
  std::string detail;
};

/// Test of determinism: a small pile of boxes has one hash with one and two threads, and over a restore.
Complaint repeatable(const EngineKind& engine) {
  auto box = std::make_shared<model::Model>();
  box->name = "box";
  box->links.push_back({.name = "link"});
  box->links.front().inertial.moments = {0.1, 0.1, 0.1};
  box->links.front().collisions.push_back(
      {.name = "c", .X_LC = {}, .shape = Box{{0.4, 0.4, 0.4}}, .surface = {}, .place = {}});
  auto ground = std::make_shared<model::Model>();
  ground->name = "ground";
  ground->is_static = true;
  ground->links.push_back({.name = "link"});
  ground->links.front().collisions.push_back(
      {.name = "c", .X_LC = {}, .shape = Plane{{0, 0, 1}}, .surface = {}, .place = {}});
  model::Setup setup;
  setup.engine = engine.name;
  setup.instances.push_back({.name = "ground", .original_name = "ground", .model = ground});
  for (int i = 0; i < 5; ++i) {
    const std::string name = "box" + std::to_string(i);
    setup.instances.push_back(
        {.name = name, .original_name = name, .model = box, .X_WM = {{0.05 * i, 0, 0.3 + 0.5 * i}, {}}});
  }
  std::uint64_t hashes[3] = {};
  for (int variant = 0; variant < 3; ++variant) {
    Diagnostics diagnostics;
    const SimulationOptions options{.threads = variant == 1 ? 2 : 1};
    auto simulation = Simulation::create(setup, options, diagnostics);
    if (!simulation) return {engine.name, false, simulation.error().text()};
    for (int tick = 0; tick < 100; ++tick) {
      if (variant == 2 && tick == 50) {
        const auto snapshot = (*simulation)->snapshot();
        simulation = Simulation::restore(snapshot, options, diagnostics);
        if (!simulation) return {engine.name, false, simulation.error().text()};
      }
      if (Status status = (*simulation)->tick(); !status) return {engine.name, false, status.error().text()};
    }
    hashes[variant] = (*simulation)->state_hash();
  }
  const bool same = hashes[0] == hashes[1] && hashes[0] == hashes[2];
  return {std::string("repeatable, ") + engine.name, same,
          same ? "one hash for 1 and 2 threads and over a snapshot: " + hash_text(hashes[0])
               : "hashes differ: " + hash_text(hashes[0]) + " " + hash_text(hashes[1]) + " " +
                     hash_text(hashes[2])};
}

/// Known bits of the functions that all results depend on, from the machine of the project's golden hashes.
Complaint known_bits() {
  Stream stream(1, entity_key("doctor"), Purpose::noise, 0);
  std::uint64_t h = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = stream.normal();
    for (const double y : {math::sin(x), math::atan2(x, 0.5), math::exp(x), math::pow(std::abs(x), 1.5)}) {
      std::uint64_t bits;
      std::memcpy(&bits, &y, 8);
      h = hash_combine(h, bits);
    }
  }
  constexpr std::uint64_t expected = 0x037a49614dbce6ac;
  return {"known bits", h == expected,
          "mathematics and random numbers give " + hash_text(h) + ", expected " + hash_text(expected)};
}

}  // namespace

int doctor(bool json) {
  std::vector<Complaint> findings;
  findings.push_back({"version", true, std::string("sandlot ") + SANDLOT_VERSION});
  findings.push_back({"numeric profile", true, Simulation::profile()});
  findings.push_back(
      {"threads", true, std::to_string(std::thread::hardware_concurrency()) + " on this machine"});
  findings.push_back(known_bits());
  for (const EngineKind* engine : engine_kinds()) findings.push_back(repeatable(*engine));
  const auto demo = demo_file("indoor");
  findings.push_back({"demo scenario", static_cast<bool>(demo), demo ? *demo : demo.error().text()});
  // A program without it simulates as well: no fault.
  findings.push_back(
      {"page", true,
       server::has_page() ? "built in" : "not built in: `./dev build` installs node and what else it needs"});
  const auto sandbox = programs::sandbox_version();
  findings.push_back({"sandbox", true,
                      sandbox ? "programs of scenarios run in sandboxes of " + *sandbox
                              : "none for programs of scenarios: " + sandbox.error().text()});
  bool all_ok = true;
  auto list = nlohmann::ordered_json::array();
  for (const Complaint& finding : findings) {
    all_ok = all_ok && finding.ok;
    list.push_back({{"name", finding.name}, {"ok", finding.ok}, {"detail", finding.detail}});
    if (!json) fmt::print("{:<5} {:<20} {}\n", finding.ok ? "ok" : "BAD", finding.name, finding.detail);
  }
  if (json) fmt::print("{}\n", json_text(list));
  return all_ok ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
