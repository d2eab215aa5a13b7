#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "app/commands.h"

namespace sandlot::app {
namespace {

TEST(WriteFile, ADeviceIsWrittenToAndKeepsItsPlace) {
  EXPECT_EQ(landing_of("/dev/null").written, "/dev/null")
      << "a superuser's rename would leave a plain file there";
  EXPECT_EQ(landing_of("run.json").written, "run.json.part");
  EXPECT_TRUE(write_file("/dev/null", "text"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_FALSE(write_file("/dev/full", "text"));
  EXPECT_FALSE(write_file("/nonexistent/x", "text"));
}

TEST(WriteFile, LeavesNothingButTheFile) {
  const auto folder = std::filesystem::temp_directory_path() / ("sandlot-write-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const std::string file = (folder / "x.json").string();
  ASSERT_TRUE(write_file(file, "first, longer"));
  ASSERT_TRUE(write_file(file, "second"));
  std::string text;
  std::getline(std::ifstream(file), text);
  EXPECT_EQ(text, "second");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace sandlot::app
