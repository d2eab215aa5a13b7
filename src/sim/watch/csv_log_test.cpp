#include "sim/watch/csv_log.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/test_folder.h"
#include "sim/test_world.h"

namespace sandlot {
namespace {

std::string content(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(CsvLog, WritesALinePerSample) {
  const test::TestFolder folder;
  const std::string file = folder.file("run.csv");
  std::ofstream(file) << "something longer than what follows, which must not shine through"
                      << std::string(999, 'x');
  const auto simulation = test::build(test::arena("planar", 1));
  auto log = CsvLog::open(*simulation, {file,
                                        20,
                                        {{"sim.tick", {}},
                                         {"max(1, 2)", {}},
                                         {"sim.time", {}},
                                         {"rover1/laser.ranges[99]", {}},
                                         {"1 / (sim.tick - 5)", {}}},
                                        {}});
  ASSERT_TRUE(log) << log.error().text();
  EXPECT_NE(content(file).find("something"), std::string::npos);  // not touched before begin()
  ASSERT_TRUE((*log)->begin());
  simulation->add_observer(log->get());
  test::advance(*simulation, 11);
  ASSERT_TRUE((*log)->finish());
  EXPECT_EQ(content(file),
            "time,sim.tick,\"max(1, 2)\",sim.time [s],rover1/laser.ranges[99] [m],1 / (sim.tick - 5)\n"
            "0,0,2,0,,-0.2\n"
            "0.05,5,2,0.05,,inf\n"
            "0.1,10,2,0.1,,0.2\n");
}

TEST(CsvLog, SaysWhatIsWrongBeforeItTouchesTheFile) {
  const test::TestFolder folder;
  const auto simulation = test::build(test::arena("planar", 1));
  const auto complaint = [&](const model::LogDecl& decl) {
    const auto log = CsvLog::open(*simulation, decl);
    return log ? "" : log.error().text();
  };
  const std::string file = folder.file("new.csv");
  EXPECT_NE(complaint({file, 0, {{"rovr1.pose.x", {}}}, {}}).find("did you mean"), std::string::npos);
  EXPECT_NE(complaint({file, 200, {{"sim.time", {}}}, {}}).find("above the tick rate"), std::string::npos);
  EXPECT_NE(complaint({folder.file("no/x.csv"), 0, {{"sim.time", {}}}, {}}).find("cannot write the log"),
            std::string::npos);
  { const auto log = CsvLog::open(*simulation, {file, 0, {{"sim.time", {}}}, {}}); }
  EXPECT_FALSE(std::filesystem::exists(file));  // opened, never begun
}

TEST(CsvLog, AFullDiskIsNoticed) {
  const auto simulation = test::build(test::arena("planar", 1));
  auto log = CsvLog::open(*simulation, {"/dev/full", 0, {{"sim.time", {}}}, {}});
  ASSERT_TRUE(log);
  EXPECT_FALSE((*log)->begin());
  EXPECT_NE((*log)->status().error().text().find("No space left"), std::string::npos);
}

}  // namespace
}  // namespace sandlot
