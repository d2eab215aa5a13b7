#include "base/result.h"

namespace sandlot {

std::string to_string(const Place& place) {
  std::string text = place.file ? *place.file : "";
  if (place.line > 0) text += (text.empty() ? "line " : ":") + std::to_string(place.line);
  if (place.line > 0 && place.column > 0) text += ":" + std::to_string(place.column);
  return text;
}

std::string Error::text() const {
  std::string text = to_string(place);
  if (!text.empty()) text += ": ";
  if (!path.empty()) text += path + ": ";
  text += what;
  if (!fix.empty()) text += "; " + fix;
  return text;
}

}  // namespace sandlot
