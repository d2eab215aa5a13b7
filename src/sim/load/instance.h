#pragma once
/// One model of a file, or made by a builder, as an instance of a world.
#include <string>

#include "base/node.h"
#include "model/model.h"

namespace sandlot {

/// The model that a builder makes from `map`, on the ground at the origin.
/// @param path  of `map` in its file, for messages
Result<model::Instance> built_instance(const Node& map, const std::string& name, const std::string& path);

}  // namespace sandlot
