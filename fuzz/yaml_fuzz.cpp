/// Any bytes: parse_yaml answers with a Node or one error that has a file, and both can be used.
#include "base/check.h"
#include "files/yaml.h"

namespace {

std::size_t size_of(const sandlot::Node& node) {
  std::size_t n = 1 + node.text().size();
  for (const sandlot::Node& item : node.items()) n += size_of(item);
  for (const auto& entry : node.entries()) n += entry.key.size() + size_of(entry.value);
  return n;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto result = sandlot::parse_yaml(text, "fuzz.yaml",
                                          {.max_bytes = 1 << 16, .max_depth = 32, .max_nodes = 10'000});
  if (result) {
    SL_CHECK(size_of(*result) > 0);
  } else {
    SL_CHECK(!result.error().what.empty() && result.error().place.file);
  }
  return 0;
}
