#include "devices/drives/sdf_drive.h"

#include <algorithm>
#include <cmath>

namespace sandlot::sdf_element {

/// Joint names of one side under any of the given element names, repeated ones included.
void copy_joints(const Node& element, std::initializer_list<const char*> names, Node& config,
                 const char* key) {
  Node joints = Node::sequence(element.place());
  for (const char* name : names) {
    const Node* const node = element.find(name);
    if (!node) continue;
    joints.set_place(node->place());
    if (node->is_sequence())
      for (const Node& item : node->items()) joints.push(Node::scalar(text(&item), item.place()));
    else joints.push(Node::scalar(text(node), node->place()));
  }
  if (!joints.items().empty()) config.set(key, std::move(joints));
}

namespace {

Status copy_limit(const Node& element, const std::string& quantity, const char* common, Node& config,
                  const char* key, Diagnostics& diagnostics) {
  for (const std::string& name : {quantity, std::string(common)}) {
    SL_ASSIGN(const auto max, number(element, "max_" + name));
    SL_ASSIGN(const auto min, number(element, "min_" + name));
    if (!max && !min) continue;
    const Node& node = *find(element, max ? "max_" + name : "min_" + name);
    if (max && min && *min != -*max)
      diagnostics.warn(find(element, "min_" + name)
                           ->error("<min_" + name + "> differs from <max_" + name +
                                   ">: the larger magnitude limits both directions"));
    config.set(key, scalar(std::max(std::abs(max.value_or(0)), std::abs(min.value_or(0))), node));
    return {};
  }
  config.set(key, Node::scalar(unlimited, element.place()));
  return {};
}

}  // namespace

Status copy_limits(const Node& element, Node& config, Diagnostics& diagnostics) {
  SL_TRY(copy_limit(element, "linear_velocity", "velocity", config, "max_linear_speed", diagnostics));
  SL_TRY(copy_limit(element, "angular_velocity", "velocity", config, "max_angular_speed", diagnostics));
  SL_TRY(copy_limit(element, "linear_acceleration", "acceleration", config, "max_linear_acceleration",
                    diagnostics));
  return copy_limit(element, "angular_acceleration", "acceleration", config, "max_angular_acceleration",
                    diagnostics);
}

void warn_unknown_of_drive(const Node& element, std::initializer_list<std::string_view> known,
                           const std::string& what, Diagnostics& diagnostics) {
  constexpr std::string_view common[] = {"min_velocity",
                                         "max_velocity",
                                         "min_acceleration",
                                         "max_acceleration",
                                         "min_linear_velocity",
                                         "max_linear_velocity",
                                         "min_angular_velocity",
                                         "max_angular_velocity",
                                         "min_linear_acceleration",
                                         "max_linear_acceleration",
                                         "min_angular_acceleration",
                                         "max_angular_acceleration",
                                         "odom_publish_frequency",
                                         "update_rate",
                                         "ros"};
  Node rest = Node::map(element.place());
  for (const Node::Entry& entry : element.entries())
    if (std::find(std::begin(common), std::end(common), entry.key) == std::end(common) &&
        std::find(known.begin(), known.end(), entry.key) == known.end())
      rest.entries().push_back(entry);
  warn_unknown(rest, {}, what, diagnostics);
}

}  // namespace sandlot::sdf_element
