#pragma once
/// Marker: an area on the ground that rules and sensors test for overlap. It has no body.
///
/// A kind is one folder under markers/ and one line in markers/kinds.h. It writes a struct
///   struct Disc {
///     using Spec = ...; using State = NoFields;      // with field lists
///     Spec spec; State state;
///     Status init(const ElementBuild&);              // checks what ranges alone cannot
///     bool contains(Vec3 point_W) const;             // seen from above
///     std::vector<Vec3> outline_W() const;           // corners, counter-clockwise, for drawing
///   };
/// and `const MarkerKind kind = make_marker<Disc>({...})`. A Spec has a member `color` (color_field).
#include <array>
#include <memory>
#include <vector>

#include "base/describe.h"
#include "base/element.h"
#include "elements/world_view.h"
#include "geometry/color.h"

namespace sandlot {

class Marker : public Element {
 public:
  /// Reads the keys.
  virtual Status init(const ElementBuild& build) = 0;
  /// Whether a point lies above or below the area.
  virtual bool contains(Vec3 point_W) const = 0;
  /// Corners of the area, counter-clockwise, for drawing; a curve is approximated.
  virtual std::vector<Vec3> outline_W() const = 0;
  virtual Color color() const = 0;
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
  std::vector<Vec3> outline_W() const override { return this->element_.outline_W(); }
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

/// Key that every kind of marker has.
inline constexpr Field color_field{"color", "",
                                   "Colour of the area on the page: red, green and blue, each 0 to 1.", 0, 1};

std::span<const MarkerKind* const> marker_kinds();

}  // namespace sandlot
