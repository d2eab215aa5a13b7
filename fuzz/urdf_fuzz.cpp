/// Any bytes as a URDF file: one error with its place, or a robot of finite numbers that can be written as SDF and read
/// back equal in what holds it together.
#include "base/check.h"
#include "formats/sdf/document.h"
#include "formats/sdf/sdf.h"
#include "formats/sdf/write.h"

using namespace sandlot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const formats::SdfOptions options{.limits = {.max_bytes = 1 << 16, .max_depth = 32, .max_elements = 2'000},
                                    .path = {}};
  Diagnostics diagnostics;
  const auto result = formats::parse_sdf(text, "/nowhere/fuzz.urdf", diagnostics, options);
  if (!result) {
    SL_CHECK(!result.error().what.empty() && result.error().place.file);
    return 0;
  }
  for (const auto& instance : result->instances) {
    const model::Model& model = *instance.model;
    SL_CHECK(is_finite(instance.X_WM) && !model.links.empty());
    for (const auto& link : model.links) SL_CHECK(is_finite(link.X_ML) && link.inertial.mass_kg > 0);
    for (const auto& joint : model.joints)
      SL_CHECK(joint.child < model.links.size() && is_finite(joint.X_CJ) && is_finite(joint.axis_J));
    for (const auto& device : instance.devices)
      SL_CHECK(device.link < model.links.size() && is_finite(device.X_LS));
  }
  if (result->instances.size() != 1 || !result->world_name.empty()) return 0;

  // The translated tree, written and read again, is the same robot.
  Diagnostics unheard;
  formats::Notes notes(unheard);
  const auto root = formats::load_document(text, "/nowhere/fuzz.urdf", notes, options);
  SL_CHECK(root);
  const auto back = formats::parse_sdf(formats::xml_text(*root, text), "/nowhere/back.sdf", unheard,
                                       {.path = {}});
  SL_CHECK_MSG(back, back.error().what.c_str());
  const model::Model &was = *result->instances[0].model, &is = *back->instances.at(0).model;
  SL_CHECK(was.links.size() == is.links.size() && was.joints.size() == is.joints.size());
  for (std::size_t l = 0; l < was.links.size(); ++l)
    SL_CHECK(was.links[l].name == is.links[l].name && was.links[l].X_ML == is.links[l].X_ML);
  // And what can be said in URDF can be read as URDF.
  if (const auto urdf = formats::urdf_of(result->instances[0], unheard)) {
    const auto again = formats::parse_sdf(formats::xml_text(*urdf), "/nowhere/again.urdf", unheard,
                                          {.path = {}});
    SL_CHECK(again || !again.error().what.empty());
  }
  return 0;
}
