#pragma once
/// The key `preset` of a device: ready-made keys of its kind, below those given in addition.
#include <string_view>

#include "base/node.h"
#include "devices/kind.h"

namespace sandlot {

/// Replaces `preset: name` by the keys it stands for; nothing happens when there is none.
/// Errors   a kind without presets, a name that is none of them (with the nearest).
Status lay_preset(Node& config, const Kind& kind);
/// As above for a kind by name; an unknown kind is left to the simulation, which may know more kinds.
Status lay_preset(Node& config, std::string_view kind);

}  // namespace sandlot
