#include "sim/watch/parameters.h"

#include <gtest/gtest.h>

#include <utility>

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

TEST(Parameters, AddressesNameTheFieldsOfRequests) {
  for (const auto& [field, path] : {std::pair("noise/0/white", "noise[0].white"),
                                    {"speed", "speed"},
                                    {"gains/12", "gains[12]"},
                                    {"a/1b/c", "a.1b.c"}}) {
    EXPECT_EQ(value_path(field), path);
    EXPECT_EQ(field_path(path), field);
  }
  EXPECT_EQ(field_path("noise.0.white"), "noise/0/white");
  const auto parsed = parse_parameter("rover1/laser.noise[0].white");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->target, "rover1/laser");
  EXPECT_EQ(parsed->field, "noise/0/white");
  EXPECT_EQ(parsed->address(), "rover1/laser.noise[0].white");
  for (const char* wrong : {"", "rover1", "rover1/laser.", "."})
    EXPECT_FALSE(parse_parameter(wrong)) << wrong;
}

TEST(Parameters, AreListedWithTheirValuesAndJudged) {
  const auto simulation = build(arena("rigid", 1));
  Parameters parameters(*simulation);
  bool found = false;
  for (const Parameter& parameter : parameters.list("rover1/laser")) {
    EXPECT_NE(parameters.value(parameter).index(), 0u) << parameter.address();
    found = found || parameter.address() == "rover1/laser.noise.white";
  }
  EXPECT_TRUE(found);
  EXPECT_TRUE(parameters.list("rover1/nothing").empty());
  EXPECT_EQ(parameters.value({"sim", "errors"}), ParameterValue(1.0));
  EXPECT_EQ(parameters.value({"rover1", "errors"}), ParameterValue(1.0));
  EXPECT_EQ(parameters.value({"rover1/laser", "failure"}), ParameterValue(std::string("planned")));
  EXPECT_EQ(parameters.value({"rover1/laser", "noise"}), ParameterValue());
  const Parameter white{"rover1/laser", "noise/white"};
  EXPECT_TRUE(parameters.check(white, Node::scalar("0.1")));
  EXPECT_FALSE(parameters.check(white, Node::scalar("-1"))) << "below its range";
  EXPECT_FALSE(parameters.check(white, Node::scalar("red")));
}

}  // namespace
}  // namespace sandlot::test
