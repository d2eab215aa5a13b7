#pragma once
/// Table of the controllers that come with Sandlot.
#include <span>

#include "control/controller.h"

namespace sandlot {

std::span<const ControllerKind* const> controller_kinds();

}  // namespace sandlot
