#pragma once
/// The field list of a spec as data: for `sandlot list`, the JSON schema, forms and the generated docs.
#include <string>
#include <string_view>
#include <vector>

#include "base/struct_info.h"
#include "base/text.h"

namespace sandlot {

/// One leaf field of a spec, nested ones with their path.
struct FieldInfo {
  std::string path;  ///< "noise/white"
  std::string type;  ///< "number", "integer", "bool", "text", "choice", "list of number", "list of text",
                     ///< "list of lists of number", "list of maps", "map"
  std::string unit, help;
  double min = 0, max = 0;
  bool tunable = false, required = false, optional = false;
  std::string default_value;  ///< as a file would write it
  std::vector<std::string> choices;
  std::size_t length = 0;  ///< of fixed vectors (or of the inner lists), 0 otherwise
  std::string elements;    ///< of a list whose elements are described elsewhere: under which name
  bool for_map = false;    ///< this list may be written in place of the map that holds it
  std::size_t min_count = 0, max_count = 0;  ///< of "list of maps"
};

/// Appends the fields of a struct that is the value of a field with the unit `unit`.
void describe_struct(const TypeInfo& type, const void* value, const std::string& prefix,
                     std::string_view unit, std::vector<FieldInfo>& out, bool optional);

template <Fielded Spec>
std::vector<FieldInfo> describe_fields(const Spec& spec = {}) {
  std::vector<FieldInfo> out;
  describe_struct(type_info<Spec>, &spec, "", "", out, false);
  return out;
}

}  // namespace sandlot
