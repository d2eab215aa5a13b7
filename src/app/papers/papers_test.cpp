#include "app/papers/papers.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace sandlot::app {
namespace {

using testing::HasSubstr;
using testing::Not;

RepeatSummary runs(const std::vector<std::pair<std::uint64_t, double>>& criteria) {
  RepeatSummary out;
  for (const auto& [seed, criterion] : criteria) {
    RepeatedRun& run = out.runs.emplace_back();
    run.seed = seed, run.criterion = criterion, run.end_s = 10, run.success = criterion > 1;
  }
  return out;
}

TEST(Papers, DifferencesAreThoseOfRunsWithOneSeed) {
  const auto criterion = [](const RepeatedRun& run) { return run.criterion; };
  // Seeds 2 and 3 are in both: differences 1 and 3, mean 2, deviation sqrt(2), standard error 1;
  // Student's t for one degree of freedom is 12.706.
  const Estimate e = paired_difference(runs({{1, 9}, {2, 1}, {3, 2}}), runs({{3, 5}, {2, 2}, {4, 0}}),
                                       criterion);
  EXPECT_EQ(e.count, 2u);
  EXPECT_NEAR(*e.mean, 2, 1e-12);
  EXPECT_NEAR(*e.deviation, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(*e.low, 2 - 12.706, 1e-3);
  RepeatSummary failed = runs({{1, 9}});
  failed.runs[0].errors.emplace_back("exploded");
  EXPECT_EQ(paired_difference(failed, runs({{1, 5}}), criterion).count, 0u);
}

TEST(Papers, TablesOfRunsAreCsv) {
  const RepeatSummary a = runs({{7, 0.5}, {8, 2}});
  EXPECT_EQ(csv_of({{"one, two", &a}}),
            "condition,seed,criterion,success,end_time [s],state_hash\n"
            "\"one, two\",7,0.5,0,10,0000000000000000\n\"one, two\",8,2,1,10,0000000000000000\n");
}

TEST(ReportPage, IsOneFileWithEverythingInIt) {
  ReportPage page("A & B", "source");
  page.heading("One");
  page.table({"x"}, {{"<1>"}});
  page.figure("<?xml version=\"1.0\"?>\n<svg>f</svg>", "caption");
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("<title>A &amp; B</title>"));
  EXPECT_THAT(html, HasSubstr("<td>&lt;1&gt;</td>"));
  EXPECT_THAT(html, HasSubstr("<figure><svg>f</svg><figcaption>caption"));
  // Two drawings with one id in one document: the second would be cut by the first one's frame.
  for (int i = 0; i < 2; ++i)
    page.figure("<svg><clipPath id=\"map\"/><g clip-path=\"url(#map)\"/><use href=\"#map\"/></svg>", "");
  for (const char* const id : {"f2-map", "f3-map"})
    EXPECT_THAT(page.html(),
                HasSubstr(fmt::format("id=\"{0}\"/><g clip-path=\"url(#{0})\"/><use href=\"#{0}\"/>", id)));
  EXPECT_THAT(html, Not(HasSubstr("http://")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
}

TEST(ReportPage, SetsWhatStandsBetweenBackticksAsCode) {
  ReportPage page("A `b`", "by `sandlot <x>`");
  page.paragraph("an odd ` stays");
  page.table({"x"}, {{"`a` and `b`"}});
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("<p>by <code>sandlot &lt;x&gt;</code></p>"));
  EXPECT_THAT(html, HasSubstr("<p>an odd ` stays</p>"));
  EXPECT_THAT(html, HasSubstr("<td><code>a</code> and <code>b</code></td>"));
}

}  // namespace
}  // namespace sandlot::app
