/// Every file of tests/bad is refused with one error, at the line and with the words that its first line expects:
/// `# expect: line 7: words` or, in XML, the same in a comment. Without `line N: ` only the words are compared.
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "base/text.h"
#include "formats/scenario/scenario.h"
#include "formats/sdf/sdf.h"

namespace sandlot::formats {
namespace {

struct Expected {
  int line = 0;
  std::string words;
};

Expected expected_in(const std::string& path) {
  std::string first;
  std::ifstream in(path);
  std::getline(in, first);
  const std::string mark = "expect: ";
  const std::size_t begin = first.find(mark);
  if (begin == std::string::npos) return {};
  std::string text = first.substr(begin + mark.size());
  if (const std::size_t end = text.rfind(" -->"); end != std::string::npos) text.resize(end);
  Expected out;
  if (starts_with(text, "line ")) {
    const char* const end = std::from_chars(text.data() + 5, text.data() + text.size(), out.line).ptr;
    text = text.substr(std::min<std::size_t>(static_cast<std::size_t>(end - text.data()) + 2, text.size()));
  }
  out.words = text;
  return out;
}

std::vector<std::string> files(const std::string& extension) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator("tests/bad"))
    if (entry.path().extension() == extension) out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

template <class Read>
void check(const std::string& path, Read read) {
  SCOPED_TRACE(path);
  const Expected expected = expected_in(path);
  ASSERT_FALSE(expected.words.empty() && expected.line == 0) << "the file does not say what it expects";
  Diagnostics diagnostics;
  testing::internal::CaptureStderr();
  const auto result = read(path, diagnostics);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "somebody else complained too";
  ASSERT_FALSE(result) << "was accepted";
  const Error& error = result.error();
  const std::string text = (error.path.empty() ? "" : error.path + ": ") + error.what +
                           (error.fix.empty() ? "" : "; " + error.fix);
  EXPECT_NE(text.find(expected.words), std::string::npos) << text;
  EXPECT_EQ(error.place.file ? *error.place.file : "", path);
  if (expected.line > 0) { EXPECT_EQ(error.place.line, expected.line) << text; }
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST(BadFiles, Scenarios) {
  ASSERT_GE(files(".yaml").size(), 30u);
  for (const std::string& path : files(".yaml"))
    check(path, [](const std::string& p, Diagnostics& d) { return read_scenario(p, {}, d); });
}

TEST(BadFiles, Worlds) {
  ASSERT_GE(files(".sdf").size(), 30u);
  for (const std::string& path : files(".sdf"))
    check(path, [](const std::string& p, Diagnostics& d) { return read_sdf(p, d); });
}

TEST(BadFiles, Robots) {
  ASSERT_GE(files(".urdf").size(), 20u);
  for (const std::string& path : files(".urdf"))
    check(path, [](const std::string& p, Diagnostics& d) { return read_sdf(p, d); });
}

}  // namespace
}  // namespace sandlot::formats
