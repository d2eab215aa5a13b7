#include "base/field_json.h"

#include <nlohmann/json.hpp>

namespace sandlot {

nlohmann::ordered_json field_json(const FieldInfo& field) {
  nlohmann::ordered_json out{{"type", field.type},         {"unit", field.unit},
                             {"help", field.help},         {"default", field.default_value},
                             {"required", field.required}, {"tunable", field.tunable},
                             {"choices", field.choices},   {"length", field.length}};
  if (field.type == "number" || field.type == "integer" || field.type == "list of number")
    out["min"] = field.min, out["max"] = field.max;
  return out;
}

}  // namespace sandlot
