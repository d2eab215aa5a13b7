#include "base/atomic_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/test_folder.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  static std::string content_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder), {}); }

  const test::TestFolder made;
  const std::string folder = made.path.string() + "/";
};

TEST_F(AtomicFileTest, AppearsWhenItIsCommitted) {
  const std::string path = folder + "x.csv";
  ASSERT_TRUE(write_file(path, "first, longer"));
  AtomicFile file(path);
  ASSERT_TRUE(file.write("sec"));
  ASSERT_TRUE(file.write("ond"));
  EXPECT_EQ(content_of(path), "first, longer");
  ASSERT_TRUE(file.commit());
  EXPECT_EQ(content_of(path), "second");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, LeavesTheOldFileWhenDiscarded) {
  const std::string path = folder + "x.csv";
  ASSERT_TRUE(write_file(path, "old"));
  {
    AtomicFile file(path);
    ASSERT_TRUE(file.write("new"));
  }
  EXPECT_EQ(content_of(path), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, ReplacesTheFileThatALinkLeadsTo) {
  ASSERT_TRUE(write_file(folder + "real", "old"));
  fs::create_symlink("real", folder + "link");
  ASSERT_TRUE(write_file(folder + "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder + "link"));
  EXPECT_EQ(content_of(folder + "real"), "new");
}

TEST_F(AtomicFileTest, WritesToADeviceInPlace) {
  EXPECT_EQ(AtomicFile("/dev/null").temporary_path(), "/dev/null")
      << "a superuser's rename would leave a plain file there";
  EXPECT_EQ(AtomicFile(folder + "run.json").temporary_path(), folder + "run.json.part");
  EXPECT_TRUE(write_file("/dev/null", "text"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFileTest, SaysWhyItCannotBeWritten) {
  const Status full = write_file("/dev/full", "text");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().what, "cannot write '/dev/full': No space left on device");
  const Status missing = write_file(folder + "none/x", "text");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().what, "cannot write '" + folder + "none/x': No such file or directory");
  EXPECT_EQ(files(), 0);
}

}  // namespace
}  // namespace sandlot
