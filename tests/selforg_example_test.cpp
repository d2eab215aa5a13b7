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
  // 120 s at 0.5 m/s are 60 m. A robot that only trembles stays within some metres.
  EXPECT_GT(way_m(sox.out), 10) << sox.out;
  EXPECT_EQ(shell(program() + " --steps 6000 --seed 1").out, sox.out);
  EXPECT_NE(shell(program() + " --steps 6000 --seed 2").out, sox.out);
  // Without learning and noise of a C of 1 at rest: it stays.
  const Printed still = shell(program() + " --steps 6000 --controller braitenberg");
  EXPECT_EQ(way_m(still.out), 0) << still.out;
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
