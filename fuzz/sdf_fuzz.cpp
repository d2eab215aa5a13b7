/// Any bytes: parse_sdf answers with a world of finite, physical numbers or with one error.
#include "base/check.h"
#include "formats/sdf/sdf.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  sandlot::Diagnostics diagnostics;
  const auto result = sandlot::formats::parse_sdf(
      text, "/nowhere/fuzz.sdf", diagnostics,
      {.limits = {.max_bytes = 1 << 16, .max_depth = 32, .max_elements = 2'000}});
  if (!result) {
    SL_CHECK(!result.error().what.empty() && result.error().place.file);
    return 0;
  }
  for (const auto& instance : result->instances) {
    SL_CHECK(is_finite(instance.X_WM) && !instance.model->links.empty());
    for (const auto& link : instance.model->links)
      SL_CHECK(is_finite(link.X_ML) && link.inertial.mass_kg > 0);
    for (const auto& joint : instance.model->joints) {
      SL_CHECK(joint.child < instance.model->links.size() && is_finite(joint.X_CJ) &&
               is_finite(joint.axis_J));
      SL_CHECK(joint.parent < instance.model->links.size() || joint.parent == sandlot::model::world_link);
    }
    for (const auto& device : instance.devices)
      SL_CHECK(device.link < instance.model->links.size() && is_finite(device.X_LS));
  }
  return 0;
}
