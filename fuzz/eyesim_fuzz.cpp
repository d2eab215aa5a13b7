/// Any bytes as each of EyeSim's formats: a world of finite, physical numbers or one error. The first byte chooses the format.
/// What is written of a maze or a scenario is read again.
#include "base/check.h"
#include "formats/eyesim/plan.h"
#include "formats/eyesim/sim.h"
#include "formats/kind.h"

namespace {

using namespace sandlot;

void scenario(std::string_view text, const std::string& file) {
  Diagnostics diagnostics;
  const formats::FormatKind& format = *formats::find_format(file);
  const auto read = format.scenario(text, file, {}, {}, diagnostics);
  if (!read) {
    SL_CHECK(!read.error().what.empty() && read.error().place.file);
    return;
  }
  for (const formats::RobotGroup& robot : read->robots)
    SL_CHECK(!robot.name.empty() && !robot.model.empty() && is_finite(robot.placement.X_WM));
  const auto written = format.write_scenario(*read, diagnostics);
  if (written) SL_CHECK(format.scenario(*written, file, {}, {}, diagnostics));
}

void maze(std::string_view text, const std::string& file) {
  Diagnostics diagnostics;
  const auto plan = formats::eyesim::read_maze(text, file, diagnostics);
  if (!plan) return;
  const auto written = formats::eyesim::maze_text(*plan, diagnostics);
  if (written) SL_CHECK(formats::eyesim::read_maze(*written, file, diagnostics));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr const char* files[] = {"/nowhere/fuzz.wld", "/nowhere/fuzz.maz", "/nowhere/fuzz.robi",
                                          "/nowhere/fuzz.esObj", "/nowhere/fuzz.sim"};
  if (size == 0) return 0;
  const std::string file = files[data[0] % std::size(files)];
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (formats::find_format(file)->scenario) return scenario(text, file), 0;
  if (file == files[1]) maze(text, file);
  Diagnostics diagnostics;
  formats::ReadOptions options;
  options.path.folders.clear();
  options.skip_missing = true;
  const auto result = formats::find_format(file)->world(text, file, options, diagnostics);
  if (!result) {
    SL_CHECK(!result.error().what.empty() && result.error().place.file);
    return 0;
  }
  for (const model::Instance& instance : result->instances) {
    SL_CHECK(is_finite(instance.X_WM) && !instance.model->links.empty());
    for (const model::Link& link : instance.model->links) {
      const Vec3& moments = link.inertial.moments;
      SL_CHECK(is_finite(link.X_ML) && link.inertial.mass_kg > 0 && is_finite(link.inertial.X_LCo));
      SL_CHECK(instance.model->is_static || (moments.x > 0 && moments.y > 0 && moments.z > 0));
    }
    for (const model::Joint& joint : instance.model->joints)
      SL_CHECK(joint.child < instance.model->links.size() && is_finite(joint.X_CJ));
    for (const model::DeviceDecl& device : instance.devices)
      SL_CHECK(device.link < instance.model->links.size() && is_finite(device.X_LS));
  }
  return 0;
}
