#pragma once
/// Scene light: a light on a robot that a device switches, as cameras and light sensors see it.
///
/// A device asks for one while it is built (DeviceBuild::shine) and sets its colour when it acts, before the scene of the tick is
/// drawn. The colour is State of the device.
#include <cstdint>

#include "base/bytes.h"
#include "geometry/color.h"
#include "model/light.h"

namespace sandlot {

class SceneLight {
 public:
  /// @param declared  posed in the link; its colours are those of full light
  SceneLight(std::uint32_t link, model::Light declared) : link_(link), declared_(std::move(declared)) {}
  std::uint32_t link() const { return link_; }

  /// Factors on the declared colours; black: it is off.
  void set(Color factors) { factors_ = factors; }
  const Color& factors() const { return factors_; }
  bool is_off() const { return factors_.r <= 0 && factors_.g <= 0 && factors_.b <= 0; }
  /// As it shines now.
  model::Light now() const {
    const auto times = [&](Color c) {
      return Color{c.r * factors_.r, c.g * factors_.g, c.b * factors_.b, c.a};
    };
    model::Light light = declared_;
    light.color = times(light.color);
    light.specular = times(light.specular);
    return light;
  }

  void save(ByteWriter& w) const { write(w, factors_); }
  void load(ByteReader& r) {
    read(r, factors_);
    for (const float factor : {factors_.r, factors_.g, factors_.b})
      if (!(factor >= 0 && factor <= 1)) r.fail();
  }

 private:
  std::uint32_t link_;
  model::Light declared_;
  Color factors_{0, 0, 0, 1};
};

}  // namespace sandlot
