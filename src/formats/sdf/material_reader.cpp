#include <algorithm>

#include "base/text.h"
#include "formats/sdf/reading.h"

namespace sandlot::formats {
namespace {

/// Diffuse colours of the materials that Gazebo Classic has by name; of those with a texture, about its mean.
/// Source   the names and colours of Gazebo Classic's gazebo.material, as its tutorials list them.
struct Named {
  std::string_view name;
  float r, g, b;
};
constexpr Named classic[] = {{"Grey", 0.7f, 0.7f, 0.7f},
                             {"Gray", 0.7f, 0.7f, 0.7f},
                             {"LightGrey", 0.8f, 0.8f, 0.8f},
                             {"DarkGrey", 0.175f, 0.175f, 0.175f},
                             {"DarkGray", 0.175f, 0.175f, 0.175f},
                             {"White", 1, 1, 1},
                             {"FlatBlack", 0.1f, 0.1f, 0.1f},
                             {"Black", 0, 0, 0},
                             {"Red", 1, 0, 0},
                             {"RedBright", 0.87f, 0.26f, 0.07f},
                             {"Green", 0, 1, 0},
                             {"Blue", 0, 0, 1},
                             {"SkyBlue", 0.13f, 0.44f, 0.7f},
                             {"DarkBlue", 0, 0, 0.5f},
                             {"Yellow", 1, 1, 0},
                             {"ZincYellow", 0.97f, 0.95f, 0.21f},
                             {"DarkYellow", 0.7f, 0.7f, 0},
                             {"Purple", 1, 0, 1},
                             {"Turquoise", 0, 1, 1},
                             {"Orange", 1, 0.51f, 0.05f},
                             {"DarkOrange", 0.71f, 0.27f, 0},
                             {"Indigo", 0.33f, 0, 0.5f},
                             {"Gold", 0.8f, 0.65f, 0.12f},
                             {"Brown", 0.5f, 0.3f, 0.1f},
                             {"Wood", 0.6f, 0.45f, 0.28f},
                             {"WoodFloor", 0.6f, 0.45f, 0.28f},
                             {"WoodPallet", 0.6f, 0.45f, 0.28f},
                             {"Bricks", 0.55f, 0.35f, 0.28f},
                             {"Road", 0.25f, 0.25f, 0.25f},
                             {"Asphalt", 0.25f, 0.25f, 0.25f},
                             {"Grass", 0.3f, 0.45f, 0.2f},
                             {"Residential", 0.5f, 0.5f, 0.5f},
                             {"CeilingTiled", 0.85f, 0.85f, 0.85f},
                             {"BlueGlow", 0, 0, 1},
                             {"GreenGlow", 0, 1, 0},
                             {"RedGlow", 1, 0, 0},
                             {"YellowGlow", 1, 1, 0},
                             {"OrangeTransparent", 1, 0.44f, 0},
                             {"BlueTransparent", 0, 0, 1},
                             {"GreenTransparent", 0, 1, 0},
                             {"RedTransparent", 1, 0, 0},
                             {"GreyTransparent", 0.5f, 0.5f, 0.5f},
                             {"BlackTransparent", 0, 0, 0},
                             {"YellowTransparent", 1, 1, 0}};

/// The colour of `Gazebo/Red` and the like; false for others.
bool classic_colour(const std::string& script, Color& out) {
  if (!starts_with(script, "Gazebo/")) return false;
  const std::string_view name = std::string_view(script).substr(7);
  const auto* const found = std::find_if(std::begin(classic), std::end(classic),
                                         [&](const Named& each) { return each.name == name; });
  if (found == std::end(classic)) return false;
  const bool clear = name.size() > 11 && name.substr(name.size() - 11) == "Transparent";
  out = {found->r, found->g, found->b, clear ? 0.5f : 1.0f};
  return true;
}

Status read_script(const Xml& script, model::Material& out, const Reading& in) {
  const Xml* const name = script.child("name");
  if (name && classic_colour(name->text, out.diffuse)) return out.from_mesh = false, Status();
  in.notes.warn(
      script, "the material script '" + (name ? name->text.substr(0, 80) : std::string()) + "' is not known",
      "give <diffuse> or <pbr>", "material script");
  return {};
}

/// PBR is reduced to its colour texture; roughness makes the highlight dull.
void read_pbr(const Xml& pbr, model::Material& out, const Reading& in) {
  const Xml* const metal = pbr.child("metal");
  const Xml* const flow = metal ? metal : pbr.child("specular");
  const Xml* const albedo = flow ? flow->child("albedo_map") : nullptr;
  if (!albedo || albedo->text.empty()) return;
  out.texture = in.find_texture(*albedo, albedo->text);
  out.from_mesh = false;
}

}  // namespace

Result<model::Material> read_material(const Xml& visual, const Reading& in) {
  model::Material out;
  double transparency = 0;
  SL_TRY(read_child(visual, "transparency", {0, 1}, transparency));
  if (const Xml* const material = visual.child("material")) {
    in.notes.unused(*material, "ambient diffuse specular emissive shininess script pbr",
                    "lighting shader render_order double_sided");
    const Xml* const script = material->child("script");
    const Xml* const pbr = material->child("pbr");
    const Xml* const diffuse = material->child("diffuse");
    const Xml* const color = diffuse ? diffuse : material->child("ambient");
    if (color) {
      SL_ASSIGN(out.diffuse, read_color(*color));
      out.from_mesh = false;
    } else if (script) {
      SL_TRY(read_script(*script, out, in));
    } else if (pbr) {
      out.diffuse = {1, 1, 1, 1};
    }
    if (const Xml* const child = material->child("specular")) { SL_ASSIGN(out.specular, read_color(*child)); }
    if (const Xml* const child = material->child("emissive")) { SL_ASSIGN(out.emissive, read_color(*child)); }
    double shininess = 0;
    SL_TRY(read_child(*material, "shininess", not_negative, shininess));
    out.shininess = static_cast<float>(shininess);
    if (pbr) read_pbr(*pbr, out, in);
  }
  out.diffuse.a *= static_cast<float>(1 - transparency);
  return out;
}

}  // namespace sandlot::formats
