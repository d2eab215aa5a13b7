/// P11: what recording costs. A dozen rovers with scanners drive through a flat with and without a recorder;
/// images of a camera go through the recorder's writer and through bare lz4. Files are written where
/// temporary files lie.
#include <lz4frame.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/check.h"
#include "base/test_folder.h"
#include "bench/bench.h"
#include "messages/sensor_images.h"
#include "record/recorder.h"
#include "sim/load/load.h"

namespace sandlot::bench {
namespace {

std::string link(const char* name, const char* pose, const char* shape, const char* mass, double moment,
                 const char* mu) {
  const std::string i = std::to_string(moment);
  return std::string("<link name='") + name + "'><pose>" + pose + "</pose><inertial><mass>" + mass +
         "</mass><inertia><ixx>" + i + "</ixx><iyy>" + i + "</iyy><izz>" + i +
         "</izz></inertia></inertial><collision name='c'><geometry>" + shape +
         "</geometry><surface><friction><ode><mu>" + mu + "</mu><mu2>" + mu +
         "</mu2></ode></friction></surface></collision></link>\n";
}

std::string joint(const char* name, const char* child) {
  return std::string("<joint name='") + name + "' type='continuous'><parent>base</parent><child>" + child +
         "</child><axis><xyz>0 1 0</xyz></axis></joint>\n";
}

std::string wall(int number, const char* pose, const char* size) {
  return "<model name='wall" + std::to_string(number) + "'><static>true</static><pose>" + pose +
         "</pose><link name='l'><collision name='c'><geometry><box><size>" + size +
         "</size></box></geometry></collision></link></model>\n";
}

/// Twelve rovers as models/rover, with scanners of 360 beams, in four rooms with doors and things to push.
std::string write_flat(const test::TestFolder& folder) {
  const std::string wheel = "<sphere><radius>0.05</radius></sphere>";
  const std::string device = "<sandlot:device name='";
  std::ofstream(folder.file("bot.sdf"))
      << "<sdf version='1.9' xmlns:sandlot='urn:sandlot:sdf'><model name='bot'>\n"
      << link("base", "0 0 0.1 0 0 0", "<cylinder><radius>0.17</radius><length>0.1</length></cylinder>", "4",
              0.04, "0.3")
      << link("caster", "-0.125 0 0.017 0 0 0", "<sphere><radius>0.017</radius></sphere>", "0.05", 1e-4, "0")
      << "<joint name='fork' type='fixed'><parent>base</parent><child>caster</child></joint>\n"
      << link("left", "0.01 0.115 0.05 0 0 0", wheel.c_str(), "0.15", 2e-4, "0.9")
      << link("right", "0.01 -0.115 0.05 0 0 0", wheel.c_str(), "0.15", 2e-4, "0.9")
      << joint("left_joint", "left") << joint("right_joint", "right") << device
      << "drive' kind='diff_drive'><left_joint>left_joint</left_joint><right_joint>right_joint"
      << "</right_joint><wheel_radius>0.05</wheel_radius><rate>50</rate></sandlot:device>\n"
      << device << "laser' kind='laser_scanner'><pose>0 0 0.15 0 0 0</pose><beams>360</beams><max_range>8"
      << "</max_range><rate>10</rate><noise><white>0.01</white></noise></sandlot:device>\n"
      << device << "left_encoder' kind='wheel_encoder'><joint>left_joint</joint><rate>50</rate>"
      << "</sandlot:device>\n"
      << device << "right_encoder' kind='wheel_encoder'><joint>right_joint</joint><rate>50</rate>"
      << "</sandlot:device>\n"
      << device << "truth' kind='ground_truth'><rate>50</rate></sandlot:device>\n</model></sdf>\n";
  std::ofstream world(folder.file("flat.sdf"));
  world << "<sdf version='1.9'><world name='flat'>\n<model name='ground'><static>true</static><link "
           "name='l'><collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry>"
           "</collision></link></model>\n";
  int walls = 0;
  for (const auto& [pose, size] : {std::pair("0 4.5 0.5 0 0 0", "12.2 0.2 1"),
                                   {"0 -4.5 0.5 0 0 0", "12.2 0.2 1"},
                                   {"6 0 0.5 0 0 0", "0.2 9.2 1"},
                                   {"-6 0 0.5 0 0 0", "0.2 9.2 1"},
                                   {"0 2.8 0.5 0 0 0", "0.1 3.4 1"},
                                   {"0 -2.8 0.5 0 0 0", "0.1 3.4 1"},
                                   {"-3.8 0 0.5 0 0 0", "4.2 0.1 1"},
                                   {"3.8 0 0.5 0 0 0", "4.2 0.1 1"},
                                   {"-3 2.2 0.35 0 0 0.4", "1.2 0.7 0.7"},
                                   {"3 -2.2 0.35 0 0 1", "1.2 0.7 0.7"}})
    world << wall(walls++, pose, size);
  world << "</world></sdf>\n";
  std::ofstream(folder.file("flat.yaml"))
      << "version: 1\nname: flat\nworld: flat.sdf\nphysics: rigid\n"
         "time: {step: 10 ms, substeps: 2, control_interval: 5}\nseed: 1\nrobots:\n"
         "  - {name: bot, model: bot.sdf, count: 12, controller: {kind: wander, radius: 0.18},\n"
         "     distribution: {uniform: {centre: [0, 0, 0], width: 11, height: 8, clearance: 0.45}}}\n";
  return folder.file("flat.yaml");
}

/// Processor time per simulated second: of the tick's thread, of the process.
struct Cost {
  double tick_s = 1e9, both_s = 1e9;
};

double process_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Keeps the lesser of each cost. @return the final hash
std::uint64_t drive(const std::string& scenario, const char* recording, Cost& best) {
  Diagnostics diagnostics;
  auto setup = load(scenario, {}, diagnostics);
  SL_CHECK_MSG(setup, setup.error().what.c_str());
  const auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  SL_CHECK_MSG(simulation, simulation.error().what.c_str());
  std::unique_ptr<Recorder> recorder;
  if (recording) {
    auto started = Recorder::start({.recording = {.file = recording}, .version = "bench"}, **simulation);
    SL_CHECK_MSG(started, started.error().what.c_str());
    recorder = std::move(*started);
    (*simulation)->add_observer(recorder.get());
  }
  constexpr int warm_up = 200, ticks = 1500;
  for (int i = 0; i < warm_up; ++i) SL_CHECK((*simulation)->tick());
  const double tick_begin = thread_seconds(), both_begin = process_seconds();
  for (int i = 0; i < ticks; ++i) SL_CHECK((*simulation)->tick());
  const double tick_s = thread_seconds() - tick_begin;
  if (recorder) SL_CHECK(recorder->finish() && recorder->report().dropped_messages == 0);
  constexpr double simulated_s = 0.01 * ticks;
  best.tick_s = std::min(best.tick_s, tick_s / simulated_s);
  best.both_s = std::min(best.both_s, (process_seconds() - both_begin) / simulated_s);
  return (*simulation)->state_hash();
}

/// Floor, wall and furniture with soft shading and the noise of a sensor: neither flat nor random.
msg::Image photograph(std::uint32_t number) {
  msg::Image image;
  image.height = 480;
  image.width = 640;
  image.encoding = "rgb8";
  image.step = 3 * image.width;
  image.data.resize(std::size_t{image.step} * image.height);
  std::uint64_t random = number;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint32_t at = x + 7 * number;
      const std::uint32_t light = y < 200 ? 180 - y / 8 : 90 + y / 6 + ((at / 80 + y / 60) % 2) * 25;
      for (std::uint32_t c = 0; c < 3; ++c) {
        random = mix64(random + 0x9e3779b97f4a7c15u);
        // The sum of four throws of 0..3: about 2.2 levels of noise.
        const auto noise = static_cast<std::uint32_t>((random & 3) + (random >> 2 & 3) + (random >> 4 & 3) +
                                                      (random >> 6 & 3));
        image.data[y * image.step + 3 * x + c] = static_cast<std::uint8_t>(light - 20 * c + at / 40 % 8 +
                                                                           noise);
      }
    }
  return image;
}

Row image_row(const std::string& scenario, const std::string& file) {
  Diagnostics diagnostics;
  auto setup = load(scenario, {}, diagnostics);
  SL_CHECK_MSG(setup, setup.error().what.c_str());
  const auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  SL_CHECK_MSG(simulation, simulation.error().what.c_str());
  std::vector<Frame> frames;
  for (std::uint32_t i = 0; i < 8; ++i) {
    auto topic = std::make_shared<Topic<msg::Image>>("/camera/image_raw");
    topic->message = photograph(i);
    frames.emplace_back().topics.push_back(std::move(topic));
  }
  std::vector<char> out;
  constexpr int rounds = 4;
  double bytes = 0;
  const Timing times = compare(
      9,
      [&] {
        model::Recording recording{.file = file};
        recording.hashes = false;
        auto writer = FrameWriter::create({.recording = recording, .version = "bench"}, **simulation);
        SL_CHECK_MSG(writer, writer.error().what.c_str());
        for (int i = 0; i < rounds; ++i)
          for (Frame& frame : frames) {
            frame.now = frame.now + Time::from_s(0.033);
            SL_CHECK(writer->write(frame, nullptr));
          }
        SL_CHECK(writer->finish({}));
      },
      [&] {
        bytes = 0;
        for (int i = 0; i < rounds; ++i)
          for (const Frame& frame : frames) {
            const auto& data = static_cast<const msg::Image*>(frame.topics[0]->data())->data;
            LZ4F_preferences_t preferences{};
            preferences.frameInfo.blockSizeID = LZ4F_max1MB;
            out.resize(LZ4F_compressFrameBound(data.size(), &preferences));
            SL_CHECK(!LZ4F_isError(
                LZ4F_compressFrame(out.data(), out.size(), data.data(), data.size(), &preferences)));
            bytes += static_cast<double>(data.size());
          }
      });
  return row("P11 images through the writer (reference: bare lz4)", "ns/B", 1e9 * times.ours_s / bytes,
             1e9 * times.reference_s / bytes, 2);
}

}  // namespace

std::vector<Row> recording() {
  const test::TestFolder folder;
  const std::string scenario = write_flat(folder), file = folder.file("bench.mcap");
  Cost with, without;
  for (int i = 0; i < 5; ++i) {
    const std::uint64_t alone = drive(scenario, nullptr, without);
    SL_CHECK_MSG(drive(scenario, file.c_str(), with) == alone, "recording changed the run");
  }
  return {row("P11 recording 12 robots, the run's thread", "s/s", with.tick_s, without.tick_s, 1.05),
          row("P11 recording 12 robots, with the writer's", "s/s", with.both_s, without.both_s, 1.25),
          image_row(scenario, file)};
}

}  // namespace sandlot::bench
