#pragma once
/// Table of the kinds of programs that are not controllers.
#include <span>

#include "control/program.h"

namespace sandlot {

std::span<const ProgramKind* const> program_kinds();

}  // namespace sandlot
