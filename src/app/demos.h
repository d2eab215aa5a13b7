#pragma once
/// Scenarios that come with Sandlot, found beside the program, above it, or in the current folder.
#include <string>

#include "base/result.h"

namespace sandlot::app {

/// File of the scenario that `sandlot demo NAME` runs.
Result<std::string> demo_file(const std::string& name);
/// Prints the names that demo_file() knows. @return the exit code
int list_demos();

}  // namespace sandlot::app
