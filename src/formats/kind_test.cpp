#include "formats/kind.h"

#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

namespace sandlot::formats {
namespace {

TEST(FormatKinds, HaveExtensionsOfTheirOwnAndReadOneSortOfContent) {
  std::set<std::string_view> names, extensions;
  for (const FormatKind* const kind : format_kinds()) {
    SCOPED_TRACE(kind->name);
    EXPECT_TRUE(names.insert(kind->name).second);
    EXPECT_FALSE(kind->extensions.empty());
    for (const std::string_view extension : kind->extensions) {
      EXPECT_EQ(extension.substr(0, 1), ".");
      EXPECT_TRUE(extensions.insert(extension).second) << extension;
      EXPECT_EQ(find_format("folder.x/file" + std::string(extension)), kind);
    }
    EXPECT_NE(kind->scenario == nullptr, kind->world == nullptr);
    EXPECT_GT(kind->max_bytes, 0u);
  }
}

TEST(FormatKinds, AFileOfNoFormatHasNoKind) {
  EXPECT_EQ(find_format("notes.md"), nullptr);
  EXPECT_EQ(find_format("yaml"), nullptr);
  EXPECT_EQ(find_format(""), nullptr);
  EXPECT_EQ(known_extensions(),
            ".yaml, .yml, .sdf, .world, .urdf, .xacro, .wld, .maz, .maze, .robi, .esObj, .esobj or .sim");
}

TEST(FormatKinds, AModelMayHaveAnyExtensionButThatOfAScenario) {
  const std::string file = testing::TempDir() + "robot.xml";
  std::ofstream(file) << "<robot name='r'><link name='base'/></robot>";
  Diagnostics diagnostics;
  const auto content = read_world(file, {}, diagnostics);
  std::filesystem::remove(file);
  ASSERT_TRUE(content) << content.error().text();
  EXPECT_FALSE(content->is_world());
  EXPECT_EQ(content->instances.size(), 1u);

  const auto scenario = read_world("somewhere/indoor.yaml", {}, diagnostics);
  ASSERT_FALSE(scenario);
  EXPECT_EQ(scenario.error().what, "'somewhere/indoor.yaml' holds scenarios, not a world or a model");
}

}  // namespace
}  // namespace sandlot::formats
