/// The plain program of examples/selforg: an agent without simulator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.h"
#include "selforg/log_file.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

std::string program() {
  return (std::filesystem::path(SANDLOT_BIN).parent_path() / "selforg_wheels").string();
}

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

}  // namespace
}  // namespace sandlot::test
