/// A box or a cylinder to push, carry or roll about: one homogeneous solid.
///
/// Frame    M: on the ground below its middle, x, y and z along its edges.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::block {
namespace {

enum class Form : std::uint8_t { box, cylinder };
std::span<const EnumName<Form>> enum_names(Form) {
  static constexpr EnumName<Form> names[] = {{"box", Form::box}, {"cylinder", Form::cylinder}};
  return names;
}

struct Spec {
  Form form = Form::box;
  std::array<double, 3> size_m{0.14, 0.14, 0.14};
  double mass_kg = 0.3, friction = 0.5;
  std::array<double, 3> color{0.75, 0.1, 0.08};

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"form", "", "Form of the block. A cylinder stands upright; its diameter is its size along x."},
        s.form);
    visit(Field{"size", "m", "Size along x, y and z.", 1e-3, 1e3}, s.size_m);
    visit(Field{"mass", "kg", "Mass of the block.", 1e-4, 1e6}, s.mass_kg);
    visit(Field{"friction", "1", "Coefficient of friction of its surface.", 0, 1e3}, s.friction);
    visit(Field{"color", "1", "Colour: red, green and blue.", 0, 1}, s.color);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  const std::uint32_t body = add_link(out.model, "body", {});
  model::Surface surface;
  surface.mu = surface.mu2 = s.friction;
  const Color color{static_cast<float>(s.color[0]), static_cast<float>(s.color[1]),
                    static_cast<float>(s.color[2]), 1};
  const Shape shape = s.form == Form::box ? Shape(Box{{s.size_m[0], s.size_m[1], s.size_m[2]}})
                                          : Shape(Cylinder{0.5 * s.size_m[0], s.size_m[2]});
  add_part(out.model, body,
           {.shape = shape,
            .X_LP = {{0, 0, 0.5 * s.size_m[2]}, {}},
            .mass_kg = s.mass_kg,
            .color = color,
            .surface = surface});
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "block",
    .help = "Box or cylinder to push about.",
});

}  // namespace sandlot::builders::block
