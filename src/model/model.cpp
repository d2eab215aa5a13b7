#include "model/model.h"

namespace sandlot::model {

std::optional<std::uint32_t> Model::find_link(std::string_view wanted) const {
  for (std::uint32_t i = 0; i < links.size(); ++i)
    if (links[i].name == wanted) return i;
  return std::nullopt;
}

std::optional<std::uint32_t> Model::find_joint(std::string_view wanted) const {
  for (std::uint32_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == wanted) return i;
  return std::nullopt;
}

}  // namespace sandlot::model
