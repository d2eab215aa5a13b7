/// Faulty files: every file of tests/bad is refused with one error, at the line and with the words that its first line
/// expects (base/test_expectations.h).
#include <gtest/gtest.h>

#include "base/test_expectations.h"
#include "formats/scenario/scenario.h"
#include "formats/sdf/sdf.h"

namespace sandlot::formats {
namespace {

std::vector<std::string> files(const std::string& extension) {
  return test::files_in("tests/bad", extension);
}

template <class Read>
void check(const std::string& path, Read read) {
  SCOPED_TRACE(path);
  const std::vector<test::Expectation> expectations = test::expectations_in(path);
  ASSERT_FALSE(expectations.empty()) << "the file does not say what it expects";
  const test::Expectation& expected = expectations.front();
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
