#pragma once
/// Scenarios of EyeSim (.sim) as the keys of scenario files: world, robots with their programs, objects, markers.
///
/// Names    a robot is called as its type, the second one NAME_2 and so on; objects likewise.
/// Programs a controller of kind `robios` each; `controller:NAME` in their place is a controller of Sandlot.
/// Time     a step of 50 ms with ten of physics.
#include <string>
#include <string_view>

#include "base/node.h"
#include "base/result.h"

namespace sandlot::formats::eyesim {

Result<Node> sim_tree(std::string_view text, const std::string& file, Diagnostics& diagnostics);

}  // namespace sandlot::formats::eyesim
