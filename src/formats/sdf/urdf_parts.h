#pragma once
/// Shared declarations of the URDF translation; for formats/sdf/urdf*.cpp only.
#include <map>
#include <set>
#include <string>
#include <vector>

#include "files/xml.h"
#include "formats/sdf/values.h"

namespace sandlot::formats::urdf {

inline constexpr std::size_t nothing = ~std::size_t{0};

/// Adds a child that stands at the line of `from`.
Xml& add(Xml& parent, std::string name, const Xml& from, std::string text = "");

/// The attribute, or an error with what to write.
Result<std::string> required(const Xml& element, const char* key, const char* example);
/// Attribute `key` as `n` finite numbers with one blank between them; `fallback` (or, if null, an error) where it is
/// missing.
Result<std::string> numbers(const Xml& element, const char* key, std::size_t n, const char* fallback);
/// The numbers in a text that numbers() returned.
std::vector<double> values_of(const std::string& text);
/// One warning for each attribute that is not in `known` (names separated by blanks) and in no other namespace.
void unused_attributes(const Xml& element, std::string_view known, Notes& notes);

/// Adds the <pose> of an <origin> child; nothing where there is none.
Status add_pose(const Xml& owner, Xml& out, Notes& notes, const char* relative_to = nullptr);

/// Links and joints by index, with the names they have in SDF.
struct Robot {
  const Xml* element = nullptr;
  std::vector<const Xml*> links, joints;
  std::map<std::string, std::size_t> link_index, joint_index;  ///< by URDF name
  std::vector<std::string> link_names, joint_names;            ///< in SDF
  std::vector<std::size_t> parent_joint;                       ///< per link, or `nothing`
  std::vector<std::size_t> parent_link, child_link;            ///< per joint
  std::size_t root = nothing;
  bool root_is_world = false;
};

/// Materials by name: those of the robot, then those that visuals define on the way.
using Materials = std::map<std::string, const Xml*>;

/// How a link's mass is written; see urdf.h.
struct MassNote {
  enum class How { as_written, negligible, point, left_out } how = How::as_written;
  double negligible_kg = 0;
};
/// Per link.
Result<std::vector<MassNote>> weigh(const Robot& robot);

/// <inertial>, <visual>s and <collision>s of a link.
Status translate_link(const Xml& link, const MassNote& mass, const Materials& materials, Xml& out,
                      Notes& notes);
/// A <sensor> of <robot>, as an SDF sensor without its link.
Result<Xml> translate_sensor(const Xml& sensor, Notes& notes);

/// The <gazebo> elements, laid over links, joints and model; then the devices of transmissions.
/// @param links, joints  per index: the child of `model` that stands for it, or `nothing`
Status apply_extensions(const Robot& robot, Xml& model, const std::vector<std::size_t>& links,
                        const std::vector<std::size_t>& joints, Notes& notes);
Status add_drives(const Robot& robot, Xml& model, Notes& notes);

}  // namespace sandlot::formats::urdf
