/// The plain program of examples/selforg: an agent without simulator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "command.h"
#include "selforg/log_file.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

std::string program() {
  return (std::filesystem::path(SANDLOT_BIN).parent_path() / "selforg_wheels").string();
}

std::string source_folder() { return std::filesystem::current_path().string(); }

double way_m(const std::string& out) {
  double way = -1;
  (void)std::sscanf(out.c_str() + out.find(": ") + 2, "%lf", &way);
  return way;
}

TEST(SelfOrgExample, TheTwoWheelerBeginsToDriveByItself) {
  const Printed sox = shell(program() + " --steps 6000 --seed 1");
  ASSERT_EQ(sox.exit_code, 0) << sox.out;
  // Noise alone drives it 7 m in 120 s, with learning off; what learning adds is at least as much again.
  const Printed fixed = shell(program() + " --steps 6000 --seed 1 --set epsC=0");
  ASSERT_EQ(fixed.exit_code, 0) << fixed.out;
  EXPECT_GT(way_m(sox.out), 2 * way_m(fixed.out)) << sox.out << fixed.out;
  EXPECT_EQ(shell(program() + " --steps 6000 --seed 1").out, sox.out);
  EXPECT_NE(shell(program() + " --steps 6000 --seed 2").out, sox.out);
}

TEST(SelfOrgExample, LogsStoresAndLoads) {
  TestFolder folder;
  const std::string log = folder.file("log"), file = folder.file("agent");
  ASSERT_EQ(shell(program() + " --steps 500 --log " + log + " --store " + file).exit_code, 0);
  auto table = selforg::read_log(log);
  ASSERT_TRUE(static_cast<bool>(table)) << table.error().text();
  EXPECT_EQ(table->rows.size(), 100u);  // every fifth step
  EXPECT_EQ(table->columns[1], "x[0]");
  EXPECT_EQ(shell(program() + " --steps 10 --load " + file).exit_code, 0);
  const Printed other = shell(program() + " --controller semox --load " + file);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.out, HasSubstr("holds sox behind one_to_one; this agent is semox behind one_to_one"));
  const Printed wrong = shell(program() + " --set epsC=9");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.out, HasSubstr("epsC"));
}

/// Lines on standard input, one per "\\n".
Printed talked(const std::string& lines, const std::string& arguments = "--console paused") {
  return shell("printf '" + lines + "' | " + program() + " " + arguments);
}

TEST(SelfOrgExample, ItsConsoleOnATerminalTunesStoresAndLoads) {
  TestFolder folder;
  const std::string file = folder.file("agent"), log = folder.file("log");
  const Printed first = talked("step 300\\nset eps* 0.2\\nshow eps*\\nstep 200\\nstore " + file +
                               "\\nlist\\nquit\\n");
  ASSERT_EQ(first.exit_code, 0) << first.out;
  EXPECT_THAT(first.out, HasSubstr("epsC = 0.2\nepsA = 0.2\n"));
  EXPECT_THAT(first.out,
              HasSubstr("stored in " + file +
                        " after 500 steps\nsox behind one_to_one, 2 sensors, 2 motors, 500 steps"));
  // The steps are those of the program without a console.
  const auto end_of = [](const std::string& out) { return out.substr(out.find("ends at")); };
  EXPECT_EQ(end_of(talked("step 700\\nquit\\n").out), end_of(shell(program() + " --steps 700").out));
  const Printed second = talked("load " + file + "\\nlog " + log + " 10\\nstep 100\\nlog off\\nshow epsC\\n");
  ASSERT_EQ(second.exit_code, 0) << second.out;
  EXPECT_THAT(second.out, HasSubstr("epsC = 0.2"));
  auto table = selforg::read_log(log);
  ASSERT_TRUE(static_cast<bool>(table)) << table.error().text();
  EXPECT_EQ(table->rows.size(), 10u);
  EXPECT_EQ(talked("run\\nquit\\n", "--console paused").exit_code, 0);
  EXPECT_EQ(talked("quit", "--console on").exit_code, 0) << "a last line without an end counts";
}

TEST(SelfOrgExample, WrongLinesAreAnsweredAndChangeNothing) {
  TestFolder folder;
  std::ofstream(folder.file("bad")) << "SELFAGT\n but not really";
  const Printed out = talked(
      "sett a 1\\nset eps* 9\\nset epsD 1\\nload " + folder.file("bad") +
      "\\nstep 0\\nstep -1\\nshow Q\\nset epsC nan\\nshow eps*\\nset a = b = c\\n=\\n");
  EXPECT_EQ(out.exit_code, 0) << out.out;
  for (const char* part : {"there is no command 'sett'", "did you mean 'set'", "epsC",
                           "there is no parameter 'epsD'", "has version", "'0' is not a number of steps",
                           "'-1' is not a number of steps", "there is no 'Q'", "epsC = 0.1\nepsA = 0.1"})
    EXPECT_THAT(out.out, HasSubstr(part));
}

/// What a microcontroller would get: no heap, no mathematics, nothing at all from outside but what compilers may call.
TEST(SelfOrgExample, TheFixedSizeBuildNeedsNothingAndIsSmall) {
  TestFolder folder;
  const std::string object = folder.file("tiny.o");
  for (const char* standard : {"c++17", "c++20"}) {
    const Printed made = shell(
        "cd " + folder.path.string() + " && c++ -std=" + standard +
        " -Os -ffreestanding -fno-exceptions -fno-rtti -Wall -Wextra -Werror -Wdouble-promotion"
        " -fstack-usage -I " +
        source_folder() + "/src -c " + source_folder() + "/examples/selforg/tiny.cpp -o " + object);
    ASSERT_EQ(made.exit_code, 0) << made.out;
    std::istringstream undefined(shell("nm -u " + object).out);
    for (std::string sign, name; undefined >> sign >> name;)
      EXPECT_TRUE(name == "memcpy" || name == "memset" || name == "memmove") << name;
    const Printed size = shell("size " + object + " | tail -1");
    long text = 0, data = 0, bss = 0;
    ASSERT_EQ(std::sscanf(size.out.c_str(), "%ld %ld %ld", &text, &data, &bss), 3) << size.out;
    EXPECT_LT(text, 8 * 1024) << size.out;
    EXPECT_LT(data + bss, 1024) << size.out;
    EXPECT_GT(bss, 500) << "the object has its memory in itself";
    std::ifstream usage(folder.file("tiny.su"));
    int functions = 0;
    for (std::string line; std::getline(usage, line); ++functions) {
      std::istringstream words(line.substr(line.find('\t')));
      long bytes = 0;
      std::string kind;
      words >> bytes >> kind;
      EXPECT_EQ(kind, "static") << line;
      EXPECT_LT(bytes, 256) << line;
    }
    EXPECT_GT(functions, 3);
  }
}

}  // namespace
}  // namespace sandlot::test
