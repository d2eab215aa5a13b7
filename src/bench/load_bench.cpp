/// P8: what loading costs beside libsdformat's own parse of the same text.
#include <algorithm>
#include <string>

#include <sdf/sdf.hh>

#include "base/check.h"
#include "bench/bench.h"
#include "formats/sdf/sdf.h"

namespace sandlot::bench {
namespace {

constexpr int models = 500;

/// A world of small robots: two links, a joint, shapes, a sensor each. With `frames`, the second link and the joint's
/// axis are given relative to frames, so that they have to be resolved.
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

/// Ours first: libsdformat leaves millions of free chunks behind, and tidying them up is paid by the next to allocate.
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

}  // namespace

std::vector<Row> loading() {
  return {world_row("P8 world of 500 models", false), world_row("P8 world of 500 models with frames", true)};
}

}  // namespace sandlot::bench
