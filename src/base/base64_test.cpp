#include "base/base64.h"

#include <gtest/gtest.h>

namespace sandlot {
namespace {

std::string encoded(std::string_view text) {
  std::string out;
  add_base64(std::as_bytes(std::span(text)), out);
  return out;
}

TEST(Base64, HasTheExamplesOfTheStandard) {
  const std::pair<const char*, const char*> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, base64] : examples) {
    EXPECT_EQ(encoded(plain), base64);
    EXPECT_EQ(from_base64(base64), plain);
  }
}

TEST(Base64, ReadsAllBytesBackWithAndWithoutPadding) {
  std::string all;
  for (int i = 255; i >= 0; --i) all += static_cast<char>(i);
  std::string text = encoded(all);
  EXPECT_EQ(from_base64(text), all);
  while (text.back() == '=') text.pop_back();
  EXPECT_EQ(from_base64(text), all);
}

TEST(Base64, RefusesWhatIsNotBase64) {
  for (const char* const text : {"A", "Zm9vY", "Zm 9v", "Zm9v\n", "Zg==Zg==", "Zm9-", "\xff\xff\xff\xff"})
    EXPECT_EQ(from_base64(text), std::nullopt) << text;
}

}  // namespace
}  // namespace sandlot
