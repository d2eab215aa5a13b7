#pragma once
/// JSON of clients as a document, judged for depth and size before anything is made of it. For the readers of wire.
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "base/result.h"

namespace sandlot::wire {

struct JsonLimits {
  std::size_t bytes = 1 << 20;
  int depth = 32;
  std::size_t values = 160'000;
};

/// What a client wrote, as an error sentence may repeat it.
std::string shown(std::string_view text);

/// An object. Errors: none, deeper or larger than the limits, a key twice.
Result<nlohmann::json> read_object(std::string_view text, const JsonLimits& limits);

}  // namespace sandlot::wire
