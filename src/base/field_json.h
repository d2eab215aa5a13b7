#pragma once
/// A field of a spec as JSON, for `sandlot list --json` and for the forms of viewers.
#include <nlohmann/json_fwd.hpp>

#include "base/describe.h"

namespace sandlot {

/// All but its path, which each of those who ask calls by another name: type, unit, help, default, required, tunable, choices,
/// length; min and max of numbers and lists of them.
nlohmann::ordered_json field_json(const FieldInfo& field);

}  // namespace sandlot
