/// P9: cost of a viewer of 1000 moving robots: bytes per robot and frame, and time of the simulation's thread
/// beside the same run without anybody looking. The page's own time per frame is measured by a browser:
/// tests/js/page_bench.mjs.
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "base/check.h"
#include "base/test_folder.h"
#include "bench/bench.h"
#include "console/console.h"
#include "server/server.h"
#include "sim/load/load.h"
#include "sim/session/session.h"

namespace sandlot::bench {
namespace {

constexpr int robots = 1000;
constexpr double run_s = 5;
/// Data that a viewer receives once, when it connects (world, channels), are not part of the cost of frames.
constexpr std::uint64_t first_tick = 150;

/// A link with two wheels that turn, and a drive that goes round in circles of its own.
std::string world_text() {
  const std::string inertial =
      "<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz></inertia></inertial>\n";
  const auto wheel = [&](const std::string& name, const std::string& y) {
    return "<link name='" + name + "'><pose>0 " + y + " 0.05 -1.5707963 0 0</pose>\n" + inertial +
           "<visual "
           "name='v'><geometry><cylinder><radius>0.05</radius><length>0.02</length></cylinder></geometry>"
           "</visual></link>\n<joint name='" +
           name + "_joint' type='continuous'><parent>base</parent><child>" + name +
           "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  };
  return "<sdf version='1.9'><model name='r'>\n<link name='base'><pose>0 0 0.05 0 0 0</pose>\n" + inertial +
         "<collision name='c'><geometry><box><size>0.2 0.16 0.08</size></box></geometry></collision>\n"
         "<visual name='v'><geometry><box><size>0.2 0.16 0.08</size></box></geometry></visual></link>\n" +
         wheel("left", "0.1") + wheel("right", "-0.1") +
         "<plugin name='gz::sim::systems::DiffDrive' filename='gz-sim-diff-drive-system'>"
         "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
         "<wheel_separation>0.2</wheel_separation><wheel_radius>0.05</wheel_radius></plugin>\n</model></"
         "sdf>\n";
}

std::unique_ptr<Simulation> make_run() {
  const test::TestFolder folder;
  folder.write("r.sdf", world_text());
  std::ofstream(folder.file("run.yaml")) << "version: 1\nname: viewer\nphysics: planar\n"
                                            "time: {step: 10 ms, substeps: 1}\nseed: 1\nrobots:\n"
                                            "  - name: r\n    model: r.sdf\n    count: "
                                         << robots
                                         << "\n    distribution: {grid: {centre: [0, 0, 0], spacing: 1 m}}\n"
                                            "    controller: {kind: sequence, steps: [{at: 0 s, orders: "
                                            "{diff_drive: [0.2, 0, 0.7]}}]}\n";
  Diagnostics diagnostics;
  auto setup = load(folder.file("run.yaml"), {}, diagnostics);
  SL_CHECK_MSG(setup, setup ? "" : setup.error().text().c_str());
  setup->stop = Time::from_s(run_s);
  auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  SL_CHECK_MSG(simulation, simulation ? "" : simulation.error().text().c_str());
  return std::move(*simulation);
}

struct Seen {
  std::atomic<std::uint64_t> frames{0}, bytes{0};
};

/// Subscribes to the poses and reads until the run is over.
void view(const std::string& url, Seen& seen) {
  auto client = server::WebSocketClient::connect("ws" + url.substr(4), "foxglove.websocket.v1", 5);
  SL_CHECK_MSG(client, client ? "" : client.error().text().c_str());
  bool subscribed = false;
  for (;;) {
    auto message = (*client)->receive(5);
    if (!message) return;
    if (message->text) {
      const auto json = nlohmann::json::parse(message->bytes, nullptr, false);
      if (subscribed || json.is_discarded() || json.value("op", "") != "advertise") continue;
      for (const auto& channel : json["channels"])
        if (channel.value("topic", "") == "/sandlot/poses") {
          const std::string ask = R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":)" +
                                  channel["id"].dump() + "}]}";
          subscribed = static_cast<bool>((*client)->send(std::as_bytes(std::span(ask)), true));
        }
    } else if (!message->bytes.empty() && message->bytes.front() == std::byte{1}) {
      ++seen.frames;
      seen.bytes += message->bytes.size();
    }
  }
}

/// Time of the simulation's thread for the run in real time, from `first_tick` on.
double one_run(Seen* seen) {
  Session session(make_run(), {.pace = {1.0}, .history_mb = 0});
  Console console(session, {});
  auto server = server::Server::start({.transport = {.port = 0}, .name = "viewer", .version = ""}, session,
                                      console);
  SL_CHECK_MSG(server, server ? "" : server.error().text().c_str());
  std::thread viewer;
  if (seen) viewer = std::thread([&] { view((*server)->url(), *seen); });
  double begin = 0;
  RunReport report;
  const Status status = session.run(report, [&](const Simulation& simulation) {
    if (begin == 0 && simulation.tick_index() >= first_tick) begin = thread_seconds();
    return true;
  });
  const double used_s = thread_seconds() - begin;
  SL_CHECK_MSG(status, status ? "" : status.error().text().c_str());
  (*server)->stop();
  if (viewer.joinable()) viewer.join();
  return used_s;
}

}  // namespace

std::vector<Row> viewer() {
  Seen seen;
  std::vector<double> with, without;
  for (int i = 0; i < 3; ++i) {
    without.push_back(one_run(nullptr));
    with.push_back(one_run(&seen));
  }
  const auto median = [](std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + 1, v.end());
    return v[1];
  };
  const double frames = static_cast<double>(seen.frames.load());
  const double bytes = frames > 0 ? static_cast<double>(seen.bytes.load()) / frames / robots : 0;
  const double ticks = run_s * 100 - first_tick;
  return {row("P9 bytes per robot and frame", "B", bytes, 40, 1),
          row("P9 tick of 1000 robots with a viewer", "us", median(with) / ticks * 1e6,
              median(without) / ticks * 1e6, 1.05)};
}

}  // namespace sandlot::bench
