#include "base/field_json.h"

namespace sandlot {

void write_field(JsonWriter& json, const FieldInfo& field) {
  json.key("type").text(field.type);
  json.key("unit").text(field.unit);
  json.key("help").text(field.help);
  json.key("default").text(field.default_value);
  json.key("required").flag(field.required);
  json.key("tunable").flag(field.tunable);
  json.key("choices").texts(field.choices);
  json.key("length").integer(field.length);
  if (field.type != "number" && field.type != "integer" && field.type != "list of number") return;
  json.key("min").real(field.min);
  json.key("max").real(field.max);
}

}  // namespace sandlot
