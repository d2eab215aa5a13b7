#pragma once
/// Lint of a file that was built, for `check` and `run --verbose`.
#include <string>
#include <vector>

#include "formats/scenario/scenario.h"
#include "sim/lint/lint.h"

namespace sandlot::app {

/// Findings of the simulation and, where the file is a scenario, of its text. @param overrides, paths  with which it was read
std::vector<sandlot::Finding> lint_file(const std::string& file,
                                        const std::vector<formats::Override>& overrides,
                                        const std::vector<std::string>& paths, const Simulation& simulation);

/// "what; fix [rule]".
std::string text_of(const sandlot::Finding& finding);

}  // namespace sandlot::app
