#include "base/read.h"

namespace sandlot {

Result<double> read_number(const Node& node, const Field& field, double min, double max, bool integer,
                           const std::string& path) {
  if (!node.is_scalar()) return wrong_type(node, "a number", path);
  auto quantity = parse_quantity(node.text(), *field.unit ? field.unit : "1");
  if (!quantity) {
    quantity.error().place = node.place();
    quantity.error().path = path;
    return quantity;
  }
  const double x = *quantity;
  const std::string unit = *field.unit && std::string_view(field.unit) != "1" ? " " + std::string(field.unit)
                                                                              : "";
  if (!(x >= min && x <= max))
    return node.error(
        "must be in [" + number_text(min) + ", " + number_text(max) + "]" + unit + ", is " + number_text(x),
        field.help, path);
  if (integer && x != std::floor(x))
    return node.error("must be a whole number, is " + number_text(x), "", path);
  return x;
}

Result<bool> read_bool(const Node& node, const std::string& path) {
  const std::string& text = node.text();
  if (node.is_scalar() && (text == "true" || text == "yes" || text == "on" || text == "1")) return true;
  if (node.is_scalar() && (text == "false" || text == "no" || text == "off" || text == "0")) return false;
  return wrong_type(node, "true or false", path);
}

Error unknown_key(const Node::Entry& entry, const std::vector<std::string>& known, const std::string& path) {
  const std::string fix = known.empty() ? std::string("no keys are allowed here")
                                        : suggestion(entry.key, known);
  return {"unknown key '" + entry.key.substr(0, 60) + "'", fix, entry.key_place, path};
}

Error wrong_type(const Node& node, const char* expected, const std::string& path) {
  return node.error(std::string("expected ") + expected + ", found " + describe(node), "", path);
}

}  // namespace sandlot
