#include "formats/sdf/values.h"

#include <array>

#include "base/math.h"
#include "base/text.h"

namespace sandlot::formats {
namespace {

constexpr std::size_t max_causes = 200;
constexpr std::size_t max_places = 100'000;

bool listed(std::string_view names, std::string_view name, bool* several) {
  for (const std::string_view each : split(names, ' ')) {
    const bool star = !each.empty() && each.back() == '*';
    if ((star ? each.substr(0, each.size() - 1) : each) != name) continue;
    if (several) *several = star;
    return true;
  }
  return false;
}

Error out_of_range(const Xml& element, double x, Range range) {
  const std::string bound = range.above_min
                                ? "above " + number_text(range.min) + " and at most " + number_text(range.max)
                                : "in [" + number_text(range.min) + ", " + number_text(range.max) + "]";
  if (x < 0 && range.min == 0)
    return element.error("negative " + element.name + ": " + number_text(x), "it must be " + bound);
  return element.error("<" + element.name + "> must be " + bound + ", is " + number_text(x));
}

Status in_range(const Xml& element, double x, Range range) {
  if (!std::isfinite(x))
    return element.error("<" + element.name + "> is not a finite number", "write a plain number");
  if (x < range.min || x > range.max || (range.above_min && x == range.min))
    return out_of_range(element, x, range);
  return {};
}

/// The numbers of a text; false when one is none or there are more than N.
template <std::size_t N>
bool read_numbers(std::string_view text, std::array<double, N>& out, std::size_t& count) {
  count = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n", i);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
    if (count == N || !parse_number(text.substr(begin, end - begin), out[count])) return false;
    ++count;
    i = end;
  }
  return true;
}

Error not_numbers(const Xml& element, const char* wanted) {
  return element.error("<" + element.name + "> is '" + element.text.substr(0, 40) + "'",
                       std::string("expected ") + wanted);
}

}  // namespace

Notes::~Notes() {
  for (const auto& [key, cause] : causes_) {
    Error& first = diagnostics_.warnings[cause.index];
    if (cause.more > 0)
      (first.fix.empty() ? first.what : first.fix) += " (and " + std::to_string(cause.more) +
                                                      " more like it)";
  }
}

void Notes::warn(const Xml& element, std::string what, std::string fix, const std::string& cause) {
  // An included model stands in the world many times, but its lines are the same.
  if (places_ > max_places) return;
  if (!said_.emplace(to_string(element.place) + what, element.place.line).second) return;
  ++places_;
  const std::string file = element.place.file ? *element.place.file : "";
  const std::string key = file + '\n' + (cause.empty() ? what + '\n' + fix : cause);
  if (const auto known = causes_.find(key); known != causes_.end()) {
    ++known->second.more;
  } else if (causes_.size() < max_causes) {
    causes_.emplace(key, Cause{diagnostics_.warnings.size()});
    diagnostics_.warn(element.error(std::move(what), std::move(fix)));
  } else {
    diagnostics_.warn({"further warnings are left out", "", element.place});
    places_ = max_places + 1;
  }
}

void Notes::unused(const Xml& element, std::string_view used, std::string_view silent) {
  std::set<std::string_view> seen;
  for (const Xml& child : element.children) {
    bool several = false;
    if (listed(used, child.name, &several)) {
      if (!several && !seen.insert(child.name).second)
        warn(child, "a second <" + child.name + "> is not used", "the first one counts");
    } else if (!listed(silent, child.name, nullptr) && child.name.find(':') == std::string::npos) {
      std::vector<std::string> known;
      for (const std::string_view each : split(used, ' ')) known.emplace_back(each.substr(0, each.find('*')));
      const std::string near = nearest(child.name, known);
      warn(child, "<" + child.name.substr(0, 60) + "> in <" + element.name + "> is not used",
           near.empty() ? "" : "did you mean <" + near + ">?");
    }
  }
}

Result<double> read_double(const Xml& element, Range range) {
  double x = 0;
  if (!parse_number(element.text, x)) return not_numbers(element, "a number");
  SL_TRY(in_range(element, x, range));
  return x;
}

Result<bool> read_flag(const Xml& element) {
  const std::string& text = element.text;
  if (text == "true" || text == "True" || text == "TRUE" || text == "1") return true;
  if (text == "false" || text == "False" || text == "FALSE" || text == "0") return false;
  return not_numbers(element, "true or false");
}

Result<Vec3> read_vec3(const Xml& element, Range range) {
  std::array<double, 3> v{};
  std::size_t n = 0;
  if (!read_numbers(element.text, v, n) || n != 3) return not_numbers(element, "three numbers");
  for (const double x : v) SL_TRY(in_range(element, x, range));
  return Vec3{v[0], v[1], v[2]};
}

Result<std::array<double, 2>> read_point(const Xml& element, Range range) {
  std::array<double, 2> v{};
  std::size_t n = 0;
  if (!read_numbers(element.text, v, n) || n != 2) return not_numbers(element, "two numbers");
  for (const double x : v) SL_TRY(in_range(element, x, range));
  return v;
}

Result<Color> read_color(const Xml& element) {
  std::array<double, 4> v{0, 0, 0, 1};
  std::size_t n = 0;
  if (!read_numbers(element.text, v, n) || n < 3)
    return not_numbers(element, "three or four numbers from 0 to 1");
  for (const double x : v) SL_TRY(in_range(element, x, {0, 1}));
  return Color{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
               static_cast<float>(v[3])};
}

Result<Pose> read_sdf_pose(const Xml& element) {
  const std::string* const format = element.attribute("rotation_format");
  const std::string* const degrees = element.attribute("degrees");
  const bool quaternion = format && *format == "quat_xyzw";
  if (format && !quaternion && *format != "euler_rpy")
    return element.error("rotation_format '" + format->substr(0, 40) + "' is not known",
                         "write euler_rpy or quat_xyzw");
  if (element.text.empty()) return Pose{};  // SDF takes an empty <pose/> as the identity
  std::array<double, 7> v{};
  std::size_t n = 0;
  if (!read_numbers(element.text, v, n) || n != (quaternion ? 7u : 6u))
    return not_numbers(element, quaternion ? "x y z qx qy qz qw" : "x y z roll pitch yaw");
  for (std::size_t i = 0; i < n; ++i) SL_TRY(in_range(element, v[i], i < 3 ? position_range : angle_range));
  const Vec3 p{v[0], v[1], v[2]};
  if (quaternion) {
    const Quat q{v[6], v[3], v[4], v[5]};
    if (!(norm(q) > 1e-6)) return element.error("the quaternion of this pose is zero");
    return Pose{p, normalised(q)};
  }
  const bool in_degrees = degrees && (*degrees == "true" || *degrees == "1");
  return pose_from_rpy(p, (in_degrees ? math::pi / 180 : 1.0) * Vec3{v[3], v[4], v[5]});
}

Status read_child(const Xml& parent, const char* key, Range range, double& out) {
  if (const Xml* const child = parent.child(key)) { SL_ASSIGN(out, read_double(*child, range)); }
  return {};
}

Status read_child(const Xml& parent, const char* key, bool& out) {
  if (const Xml* const child = parent.child(key)) { SL_ASSIGN(out, read_flag(*child)); }
  return {};
}

Status read_child(const Xml& parent, const char* key, Range range, Vec3& out) {
  if (const Xml* const child = parent.child(key)) { SL_ASSIGN(out, read_vec3(*child, range)); }
  return {};
}

Status read_capped(const Xml& parent, const char* key, Range range, double& out) {
  const Xml* const child = parent.child(key);
  if (!child) return {};
  double x = 0;
  if (parse_number(child->text, x) && !std::isnan(x) && (x > range.max || (x < range.min && range.min < 0)))
    return out = x > 0 ? range.max : range.min, Status();
  SL_ASSIGN(out, read_double(*child, range));
  return {};
}

Result<Pose> read_child_pose(const Xml& parent) {
  const Xml* const pose = parent.child("pose");
  return pose ? read_sdf_pose(*pose) : Pose{};
}

}  // namespace sandlot::formats
