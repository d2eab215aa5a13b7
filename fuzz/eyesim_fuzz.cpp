/// Any bytes as each of EyeSim's formats: a world of finite, physical numbers or one error. The first byte chooses the format.
#include "base/check.h"
#include "formats/kind.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  static constexpr const char* files[] = {"/nowhere/fuzz.wld", "/nowhere/fuzz.maz", "/nowhere/fuzz.robi",
                                          "/nowhere/fuzz.esObj"};
  if (size == 0) return 0;
  const std::string file = files[data[0] % std::size(files)];
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
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
