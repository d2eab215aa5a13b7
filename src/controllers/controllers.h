#pragma once
/// Table of the controllers that come with Sandlot.
#include <span>

#include "control/controller.h"

namespace sandlot {

std::span<const ControllerKind* const> controller_kinds();
/// By name, or an error with the nearest one.
Result<const ControllerKind*> find_controller_kind(std::string_view name);

}  // namespace sandlot
