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
#include "formats/kind.h"

namespace sandlot::formats::eyesim {

Result<Node> sim_tree(std::string_view text, const std::string& file, const ReadOptions& options,
                      Diagnostics& diagnostics);

/// A scenario of single robots and objects in a world of EyeSim as a .sim file; of everything else one warning each says that
/// it is left out.
/// Errors   a world that is neither .wld nor .maz.
Result<std::string> sim_of(const Scenario& scenario, Diagnostics& diagnostics);

/// EyeSim's word for one of our files of its robots or objects; "" for others.
std::string built_in_type(const std::string& model, bool robot);
/// The name that a .robi or .esObj file gives its type; that of the file when it cannot be read.
std::string declared_type(const std::string& written, const std::string& folder, bool robot,
                          const Place& place);

}  // namespace sandlot::formats::eyesim
