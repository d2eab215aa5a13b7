#include "run/step_times_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace sandlot {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

StepTime step(double now_s, std::optional<double> wall_s) {
  StepTime out;
  out.now = Time::from_s(now_s);
  out.step = Time::from_s(0.01);
  out.wall_s = wall_s;
  out.compute_s = 0.0005;
  return out;
}

TEST(StepTimesFile, HasALinePerTickWithItsUnits) {
  const test::TestFolder folder;
  StepTimesFile file(folder.file("t.csv"));
  file.on_step(step(0.01, std::nullopt));
  file.on_step(step(0.02, 0.0012345));
  ASSERT_TRUE(file.finish());
  const std::string text = folder.read("t.csv");
  EXPECT_THAT(text, StartsWith("# Step times of a run, all in seconds."));
  EXPECT_THAT(
      text,
      HasSubstr("\ntime_s,step_s,wall_s,compute_s\n0.01,0.01,,0.0005000\n0.02,0.01,0.0012345,0.0005000\n"));
  const auto read = read_step_times(text, "t.csv");
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2u);
  EXPECT_FALSE((*read)[0].wall_s);
  EXPECT_EQ((*read)[1].wall_s, 0.0012345);
  EXPECT_EQ((*read)[1].now, Time::from_s(0.02));
}

TEST(StepTimesFile, ErrorsNameTheLine) {
  EXPECT_FALSE(StepTimesFile("/no/such/folder/t.csv").status());
  for (const char* text :
       {"time,x\n", "time_s,step_s,wall_s,compute_s\n1,2,3\n", "time_s,step_s,wall_s,compute_s\n1,2,3,4,5\n",
        "time_s,step_s,wall_s,compute_s\n1,,3,4\n", "time_s,step_s,wall_s,compute_s\n1,0.1,nan,4\n",
        "time_s,step_s,wall_s,compute_s\n1,0.1,-1,4\n", "time_s,step_s,wall_s,compute_s\n1,0,1,4\n"}) {
    const auto read = read_step_times(text, "t.csv");
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().what, StartsWith("t.csv:")) << text;
  }
  EXPECT_TRUE(read_step_times("", "t.csv"));
}

}  // namespace
}  // namespace sandlot
