/// `sandlot new controller`: projects that run and pass their own tests, from names that are checked, over nobody's files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "command.h"
#include "programs/test_sandbox.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// In the folder, with the built command as SANDLOT.
Printed in_folder(const std::string& folder, const std::string& command) {
  return shell("export SANDLOT=" + fs::absolute(SANDLOT_BIN).string() + "; cd " + folder + " && " + command);
}

std::set<std::string> files_in(const std::string& folder) {
  std::set<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out.insert(fs::relative(entry.path(), folder));
  return out;
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(New, APythonProjectPassesItsTests) {
  const TestFolder scratch;
  const Printed made = in_folder(scratch.path, "$SANDLOT new controller wall --lang python");
  ASSERT_EQ(made.exit_code, 0) << made.out;
  EXPECT_THAT(made.out, HasSubstr("cd wall\n  sandlot run wall.yaml --port 8765\n"
                                  "  python3 wall_controller.py\n"));
  const std::string project = scratch.file("wall");
  const std::set<std::string> files = files_in(project);
  for (const char* each :
       {"README.md", "wall.yaml", "wall_controller.py", "wall_test.py", "sandlot_client/__init__.py"})
    EXPECT_EQ(files.count(each), 1u) << each;
  for (const std::string& each : files)
    EXPECT_EQ(text_of(project + "/" + each).find("@NAME@"), std::string::npos) << each;
  const Printed tested = in_folder(project, "python3 wall_test.py");
  EXPECT_EQ(tested.exit_code, 0) << tested.out;
  EXPECT_THAT(tested.out, HasSubstr("Ran 2 tests"));
  // The test sees a program that does nothing.
  const Printed broken = in_folder(project,
                                   "sed -i 's/rover.command(.*/pass/' wall_controller.py && "
                                   "python3 wall_test.py");
  EXPECT_NE(broken.exit_code, 0);
  EXPECT_THAT(broken.out, HasSubstr("it did not arrive"));
}

TEST(New, AJavaScriptProjectPassesItsTests) {
  if (shell("node --version").exit_code != 0) GTEST_SKIP() << "no node";
  const TestFolder scratch;
  const std::string project = scratch.file("deep/er");
  const Printed made = in_folder(scratch.path, "$SANDLOT new controller Wall_2 --lang js --out deep/er");
  ASSERT_EQ(made.exit_code, 0) << made.out;
  const Printed tested = in_folder(project, "node Wall_2_test.mjs");
  EXPECT_EQ(tested.exit_code, 0) << tested.out;
  EXPECT_THAT(tested.out, HasSubstr("# pass 2"));
}

TEST(SlowNew, ACppProjectBuildsAndPassesItsTest) {
  const TestFolder scratch;
  const Printed made = in_folder(scratch.path, "$SANDLOT new controller wall --lang cpp");
  ASSERT_EQ(made.exit_code, 0) << made.out;
  const Printed built = in_folder(scratch.file("wall"), "cmake -B build && cmake --build build");
  ASSERT_EQ(built.exit_code, 0) << built.out;
  EXPECT_THAT(built.out, testing::Not(HasSubstr("warning")));
  const Printed tested = in_folder(scratch.file("wall"), "ctest --test-dir build --output-on-failure");
  EXPECT_EQ(tested.exit_code, 0) << tested.out;

  // So does the program of docs/clients.md.
  const std::string page = text_of("docs/clients.md"), fence = "```cpp\n";
  const std::size_t begin = page.find(fence) + fence.size();
  scratch.write("wall/wall_controller.cpp", page.substr(begin, page.find("```", begin) - begin));
  const Printed rebuilt = in_folder(scratch.file("wall"), "cmake --build build");
  EXPECT_EQ(rebuilt.exit_code, 0) << rebuilt.out;
}

TEST(New, ARobiosProgramArrives) {
  SKIP_WITHOUT_SANDBOX();
  const TestFolder scratch;
  fs::permissions(scratch.path, fs::perms(0755));  // programs of root run as nobody
  const Printed made = in_folder(scratch.path, "$SANDLOT new controller wall --lang robios");
  ASSERT_EQ(made.exit_code, 0) << made.out;
  EXPECT_THAT(made.out, HasSubstr("cd wall\n  sandlot run wall.yaml --port 8765\n"));
  EXPECT_EQ(files_in(scratch.file("wall")), (std::set<std::string>{"README.md", "wall.c", "wall.yaml"}));
  const Printed run = in_folder(scratch.file("wall"), "XDG_CACHE_HOME=$PWD/.. $SANDLOT run wall.yaml");
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_THAT(run.out, HasSubstr("arrived"));
}

TEST(New, NamesAreCheckedAndLanguagesSuggested) {
  const TestFolder scratch;
  for (const char* name : {"''", "2nd", "a-b", "../a", "a/b", "_a", "a.b", "\"a b\"", "é"}) {
    const Printed refused = in_folder(scratch.path,
                                      "$SANDLOT new controller --lang python " + std::string(name));
    EXPECT_EQ(refused.exit_code, 2) << name;
    EXPECT_THAT(refused.out, HasSubstr("cannot be the name of a controller")) << name;
  }
  const Printed longest = in_folder(scratch.path,
                                    "$SANDLOT new controller --lang python " + std::string(65, 'a'));
  EXPECT_EQ(longest.exit_code, 2);
  const Printed language = in_folder(scratch.path, "$SANDLOT new controller a --lang pyton");
  EXPECT_EQ(language.exit_code, 2);
  EXPECT_THAT(language.out, HasSubstr("did you mean 'python'?"));
  EXPECT_TRUE(fs::is_empty(scratch.path));
}

TEST(New, FilesThatExistAreNeverReplaced) {
  const TestFolder scratch;
  fs::create_directory(scratch.file("wall"));
  fs::create_symlink("nowhere", scratch.file("wall/README.md"));
  scratch.write("wall/other.txt", "mine");
  const Printed refused = in_folder(scratch.path, "$SANDLOT new controller wall --lang python");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.out, HasSubstr("wall/README.md exists already"));
  EXPECT_FALSE(fs::exists(scratch.file("wall/wall.yaml"))) << "nothing is written by halves";
  fs::remove(scratch.file("wall/README.md"));
  EXPECT_EQ(in_folder(scratch.path, "$SANDLOT new controller wall --lang python").exit_code, 0);
  EXPECT_EQ(text_of(scratch.file("wall/other.txt")), "mine");
  EXPECT_EQ(in_folder(scratch.path, "$SANDLOT new controller wall --lang js").exit_code, 2);
}

}  // namespace
}  // namespace sandlot::test
