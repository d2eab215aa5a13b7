/// The first line is an override `path=value`, the rest a scenario.
#include "base/check.h"
#include "formats/scenario/scenario.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t line = all.find('\n');
  const std::string_view first = all.substr(0, line);
  const std::string_view text = line == std::string_view::npos ? "" : all.substr(line + 1);
  const std::size_t equals = first.find('=');
  std::vector<sandlot::formats::Override> overrides;
  if (equals != std::string_view::npos)
    overrides.push_back({std::string(first.substr(0, equals)), std::string(first.substr(equals + 1))});
  sandlot::Diagnostics diagnostics;
  const auto result = sandlot::formats::parse_scenario(text, "/nowhere/fuzz.yaml", overrides, diagnostics);
  if (result) {
    const auto& setup = result->setup;
    SL_CHECK(setup.step.ns > 0 && setup.substeps >= 1 && setup.control_interval >= 1);
    for (const auto& robot : result->robots)
      SL_CHECK(robot.count >= 0 && sandlot::is_finite(robot.placement.X_WM));
  } else {
    SL_CHECK(!result.error().text().empty());
  }
  return 0;
}
