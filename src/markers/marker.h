#pragma once
/// Marker: an area on the ground that rules and sensors test for overlap. It has no body.
///
/// A kind is one folder under markers/ and one line in markers/kinds.h. It writes a struct
///   struct Disc {
///     using Spec = ...; using State = NoFields;      // with field lists
///     Spec spec; State state;
///     Status init(const ElementBuild&);              // checks what ranges alone cannot
///     bool contains(Vec3 point_W) const;             // seen from above
///     bool meets(const RoundedHull& hull) const;     // likewise
///     std::vector<std::vector<Vec3>> outlines_W() const;    // simple polygons that cover the area, for drawing
///   };
/// and `const MarkerKind kind = make_marker<Disc>({...})`. A Spec has the members `color` and `visible` (color_field,
/// visible_field).
#include <array>
#include <memory>
#include <vector>

#include "base/describe.h"
#include "base/element.h"
#include "elements/world_view.h"
#include "geometry/color.h"
#include "geometry/rounded_hull.h"

namespace sandlot {

class Marker : public Element {
 public:
  /// Reads the keys.
  virtual Status init(const ElementBuild& build) = 0;
  /// Whether a point lies above or below the area.
  virtual bool contains(Vec3 point_W) const = 0;
  /// Whether an outline, seen from above, shares a point with the area.
  virtual bool meets(const RoundedHull& hull) const = 0;
  /// Simple polygons that together cover the area, each counter-clockwise, for drawing; a curve is approximated. They may
  /// overlap.
  virtual std::vector<std::vector<Vec3>> outlines_W() const = 0;
  virtual Color color() const = 0;
  /// Whether the area is painted on the ground, for cameras and sensors of the ground.
  virtual bool visible() const = 0;
};

struct MarkerKind {
  const char* name;
  const char* help;
  // Filled by make_marker:
  std::vector<FieldInfo> (*describe)() = nullptr;
  std::unique_ptr<Marker> (*create)() = nullptr;
};

template <class M>
class MarkerAdapter final : public ElementAdapter<Marker, M> {
 public:
  Status init(const ElementBuild& build) override {
    SL_ASSIGN(this->element_.spec, read_spec<typename M::Spec>(build.decl.config));
    return this->element_.init(build);
  }
  bool contains(Vec3 point_W) const override { return this->element_.contains(point_W); }
  bool meets(const RoundedHull& hull) const override { return this->element_.meets(hull); }
  std::vector<std::vector<Vec3>> outlines_W() const override { return this->element_.outlines_W(); }
  bool visible() const override { return this->element_.spec.visible; }
  Color color() const override {
    const auto& [r, g, b] = this->element_.spec.color;
    return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b), 1};
  }
};

template <class M>
constexpr MarkerKind make_marker(MarkerKind kind) {
  kind.describe = [] { return describe_fields<typename M::Spec>(); };
  kind.create = []() -> std::unique_ptr<Marker> { return std::make_unique<MarkerAdapter<M>>(); };
  return kind;
}

/// Keys that every kind of marker has.
inline constexpr Field color_field{"color", "", "Colour of the area: red, green and blue, each 0 to 1.", 0,
                                   1};
inline constexpr Field visible_field{
    "visible", "", "Whether the area is painted on the ground, where cameras and ground sensors see it."};

std::span<const MarkerKind* const> marker_kinds();

}  // namespace sandlot
