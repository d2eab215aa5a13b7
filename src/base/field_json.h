#pragma once
/// A field of a spec as JSON, for `sandlot list --json` and for the forms of viewers.
#include "base/describe.h"
#include "base/json_writer.h"

namespace sandlot {

/// Writes all but its path, which each caller names in its own way, as members of the object that is open: type, unit, help,
/// default, required, tunable, choices, length; min and max of numbers and lists of them.
void write_field(JsonWriter& json, const FieldInfo& field);

}  // namespace sandlot
