#pragma once
/// Values of SDF elements: numbers in range, vectors, poses, colours, each fault with its line.
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "files/xml.h"
#include "geometry/pose.h"
#include "model/model.h"

namespace sandlot::formats {

/// Bounds of a number. Finite, so that infinities are refused.
struct Range {
  double min, max;
  bool above_min = false;  ///< min itself is refused
};
inline constexpr Range position_range{-1e6, 1e6};
inline constexpr Range size_range{0, 1e6, true};
inline constexpr Range angle_range{-1e4, 1e4};
inline constexpr Range not_negative{0, 1e16};

/// What goes along while a file is read: warnings, each place once. Those of one cause in one file are folded into the
/// first, which counts the others.
class Notes {
 public:
  explicit Notes(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}
  Notes(const Notes&) = delete;
  Notes& operator=(const Notes&) = delete;
  /// Says how many there were of each.
  ~Notes();
  /// @param cause  what tells causes apart where the text names a single thing; "": the text
  void warn(const Xml& element, std::string what, std::string fix = "", const std::string& cause = "");
  Diagnostics& diagnostics() { return diagnostics_; }
  /// Names every child of `element` that is in neither list (names separated by spaces; `visual*` may come several
  /// times). What is only for the eye, or belongs to another program's namespace, stands in `silent` or has a colon.
  void unused(const Xml& element, std::string_view used, std::string_view silent = "");

 private:
  Diagnostics& diagnostics_;
  struct Cause {
    std::size_t index;  ///< of its first warning
    int more = 0;
  };
  std::set<std::pair<std::string, int>> said_;
  std::map<std::string, Cause> causes_;  ///< by file and cause
  std::size_t places_ = 0;
};

/// The element's text as a number.
Result<double> read_double(const Xml& element, Range range);
Result<bool> read_flag(const Xml& element);
Result<Vec3> read_vec3(const Xml& element, Range range);
Result<std::array<double, 2>> read_point(const Xml& element, Range range);
Result<Color> read_color(const Xml& element);
/// A <pose>: six numbers, or with rotation_format="quat_xyzw" seven; degrees="true" is understood.
Result<Pose> read_sdf_pose(const Xml& element);

/// Overwrites `out` if `parent` has the child.
Status read_child(const Xml& parent, const char* key, Range range, double& out);
Status read_child(const Xml& parent, const char* key, bool& out);
Status read_child(const Xml& parent, const char* key, Range range, Vec3& out);
/// As above, but what lies beyond the range, infinities included, counts as its end: files write "no limit" in many
/// ways. Where the range begins at 0 a negative number is still an error.
Status read_capped(const Xml& parent, const char* key, Range range, double& out);
/// The pose of an element as written in its own <pose>; identity if it has none.
Result<Pose> read_child_pose(const Xml& parent);

}  // namespace sandlot::formats
