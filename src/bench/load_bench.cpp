/// P8: cost of loading, compared with libsdformat's parse of the same text.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#ifdef SANDLOT_HAS_SDFORMAT
#include <sdf/sdf.hh>
#endif

#include "base/check.h"
#include "base/test_folder.h"
#include "bench/bench.h"
#include "formats/sdf/sdf.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::bench {
namespace {

#ifdef SANDLOT_HAS_SDFORMAT
constexpr int models = 500;

/// A world of small robots: two links, a joint, shapes, a sensor each. With `frames`, the second link and the
/// joint's axis are given relative to frames, so that they have to be resolved.
std::string world_text(bool frames) {
  const std::string inertial =
      "<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz></inertia></inertial>\n";
  const std::string shape =
      "<pose>0 0 0.1 0 0 0</pose>\n<geometry><box><size>0.4 0.3 0.2</size></box></geometry>\n";
  std::string text = "<sdf version='1.9'>\n<world name='bench'>\n";
  for (int i = 0; i < models; ++i) {
    const std::string n = std::to_string(i);
    text +=
        "<model name='robot" + n + "'>\n<pose>" + n + " 0 0 0 0 0.5</pose>\n<link name='base'>\n" + inertial +
        "<collision name='c'>\n" + shape +
        "<surface><friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction></surface>\n</collision>\n"
        "<visual name='v'>\n" +
        shape +
        "<material><diffuse>0.8 0.1 0.1 1</diffuse></material>\n</visual>\n"
        "<sensor name='lidar' type='gpu_lidar'>\n<update_rate>10</update_rate>\n<lidar><scan><horizontal>"
        "<samples>181</samples><min_angle>-1.57</min_angle><max_angle>1.57</max_angle></horizontal></scan>"
        "<range><min>0.1</min><max>10</max></range></lidar>\n</sensor>\n</link>\n";
    if (frames) text += "<frame name='hub' attached_to='base'><pose>0 0.2 0 0 0 0</pose></frame>\n";
    text += "<link name='wheel'>\n" +
            std::string(frames ? "<pose relative_to='hub'>0 0 0 1.5707963 0 0</pose>\n"
                               : "<pose>0 0.2 0 1.5707963 0 0</pose>\n") +
            inertial +
            "<collision "
            "name='c'><geometry><cylinder><radius>0.1</radius><length>0.05</length></cylinder></geometry>"
            "</collision>\n</link>\n<joint name='axle' "
            "type='revolute'>\n<parent>base</parent>\n<child>wheel</child>\n<axis><xyz" +
            std::string(frames ? " expressed_in='base'>0 1 0" : ">0 0 1") +
            "</xyz></axis>\n</joint>\n</model>\n";
  }
  return text + "</world>\n</sdf>\n";
}

template <class Work>
double median_of_three(Work&& work) {
  double times[3];
  for (double& t : times) {
    const double begin = thread_seconds();
    work();
    t = thread_seconds() - begin;
  }
  std::sort(std::begin(times), std::end(times));
  return times[1];
}

/// Ours first: libsdformat leaves millions of free chunks behind, and tidying them up is paid by the next to
/// allocate.
Row world_row(const std::string& name, bool frames) {
  const std::string text = world_text(frames);
  const double ours_s = median_of_three([&] {
    Diagnostics diagnostics;
    const auto content = formats::parse_sdf(text, "/bench/world.sdf", diagnostics);
    SL_CHECK_MSG(content && content->instances.size() == models, content ? "" : content.error().what.c_str());
  });
  const double reference_s = median_of_three([&] {
    sdf::Root root;
    SL_CHECK(root.LoadSdfString(text).empty() && root.WorldByIndex(0)->ModelCount() == models);
  });
  return row(name, "s", ours_s, reference_s, 2);
}

#endif

/// A scenario of 10,000 robots with a drive and a laser each, from files to a simulation that stands at tick
/// 0.
Row crowd_row() {
  const test::TestFolder folder;
  std::ofstream(folder.file("bot.sdf"))
      << R"(<sdf version='1.9' xmlns:sandlot='urn:sandlot:sdf'><model name='bot'>
<link name='base'><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
<collision name='c'><pose>0 0 0.1 0 0 0</pose><geometry><cylinder><radius>0.1</radius><length>0.1</length></cylinder></geometry></collision></link>
<link name='l'><pose>0 0.1 0.05 0 0 0</pose><inertial><mass>0.1</mass><inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial></link>
<link name='r'><pose>0 -0.1 0.05 0 0 0</pose><inertial><mass>0.1</mass><inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial></link>
<joint name='lj' type='continuous'><parent>base</parent><child>l</child><axis><xyz>0 1 0</xyz></axis></joint>
<joint name='rj' type='continuous'><parent>base</parent><child>r</child><axis><xyz>0 1 0</xyz></axis></joint>
<sandlot:device name='drive' kind='diff_drive'><left_joint>lj</left_joint><right_joint>rj</right_joint><wheel_radius>0.05</wheel_radius></sandlot:device>
<sandlot:device name='laser' kind='laser_scanner'><beams>24</beams><max_range>1</max_range></sandlot:device>
</model></sdf>)";
  std::ofstream(folder.file("crowd.yaml"))
      << "version: 1\nname: crowd\nphysics: planar\nrobots:\n"
         "  - {name: bot, model: bot.sdf, count: 10000, controller: wander,\n"
         "     distribution: {grid: {spacing: 1.4 m}}}\n";
  const double begin = thread_seconds();
  Diagnostics diagnostics;
  auto setup = load(folder.file("crowd.yaml"), {}, diagnostics);
  SL_CHECK_MSG(setup, setup.error().what.c_str());
  const auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  SL_CHECK_MSG(simulation, simulation.error().what.c_str());
  const double seconds = thread_seconds() - begin;
  return row("P8 scenario of 10,000 robots (reference: the 2 s allowed)", "s", seconds, 2, 1);
}

}  // namespace

std::vector<Row> loading() {
#ifdef SANDLOT_HAS_SDFORMAT
  return {world_row("P8 world of 500 models", false), world_row("P8 world of 500 models with frames", true),
          crowd_row()};
#else
  return {crowd_row()};  // built without libsdformat: no reference for worlds
#endif
}

}  // namespace sandlot::bench
