/// `sandlot reproduce eyesim`: one page without a network, whose formulas hold, and which is the same again but for wall times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Numbers of a CSV file behind its first line; cells that are none are NaN.
std::vector<std::vector<double>> rows_of(const std::string& path) {
  std::istringstream in(read_file(path));
  std::vector<std::vector<double>> out;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<double>& row = out.emplace_back();
    bool quoted = false;
    std::string cell;
    for (const char c : line + ",") {
      if (c == '"') quoted = !quoted;
      else if (c != ',' || quoted) cell += c;
      else {
        char* end = nullptr;
        const double x = std::strtod(cell.c_str(), &end);
        row.push_back(!cell.empty() && *end == '\0' ? x : NAN);
        cell.clear();
      }
    }
  }
  return out;
}

/// The page without its last section, which has wall times.
std::string same_part(const std::string& html) {
  const std::size_t speed = html.find("<h2>Section 8");
  EXPECT_NE(speed, std::string::npos);
  return html.substr(0, speed);
}

TEST(LongReproduce, EyesimIsOnePageWhoseFormulasHold) {
  const TestFolder scratch;
  const auto make = [&](const std::string& out, const std::string& more) {
    const Printed made = sandlot("reproduce eyesim --repeat 2 --out " + scratch.file(out) + more);
    EXPECT_EQ(made.exit_code, 0) << made.out;
    return read_file(scratch.file(out + "/index.html"));
  };
  const std::string html = make("out", "");
  for (const char* const text :
       {"Section 2", "Section 5", "Section 5.1", "Section 6", "Section 7", "Section 8", "the paper",
        "FL alone", "VWCurve(500, 90, 200)", "P_b 0.01, P_p 0.1: unharmed messages", "salt and pepper",
        "data:image/png;base64", "<svg", "side 1, side 2, corner 1, side 3", "sum 4000 of 4000"})
    EXPECT_THAT(html, HasSubstr(text));
  for (const char* const text : {"src=\"http", "href=\"http", "<script", "<link", "drawing.svg", ">outside<",
                                 ">nan", "The robots differ"})
    EXPECT_THAT(html, Not(HasSubstr(text)));
  EXPECT_FALSE(fs::exists(scratch.file("out/drawing.svg")));
  // Nothing from the future, and every pair of clocks in its slot.
  EXPECT_THAT(html, HasSubstr("After 300 of 300 calls"));
  EXPECT_THAT(html, HasSubstr("<td>0 of "));

  // Predicted by the paper's rows against measured: two wheels, the car; v_x and v_y of the Mecanum drive.
  const auto drives = rows_of(scratch.file("out/drives.csv"));
  ASSERT_EQ(drives.size(), 5u + 8u + 5u);
  for (const auto& row : drives) {
    ASSERT_EQ(row.size(), 8u);
    // A tick of two seconds is 0.08 mm/s and 0.07 deg/s; the ideal level moves the base exactly.
    EXPECT_NEAR(row[2], row[5], 2e-4);
    if (row[3] == 0) continue;
    EXPECT_NEAR(row[3], row[6], 2e-4);
  }
  for (const std::size_t i : {0u, 1u, 2u, 3u, 4u, 13u, 14u, 15u, 16u, 17u})
    EXPECT_NEAR(drives[i][4], drives[i][7], 2e-3) << i;
  // The turning rate of four wheels: (-1, 1, -1, 1) and not (-1, 1, 1, -1).
  EXPECT_NEAR(drives[7][7], -drives[7][4], 1e-4) << "BL alone";
  EXPECT_NEAR(drives[10][7], 0, 1e-6) << "sideways";
  EXPECT_GT(std::abs(drives[10][4]), 0.1);

  for (const char* const file : {"sensors.csv", "driving.csv", "radio.csv"}) {
    const auto rows = rows_of(scratch.file(std::string("out/") + file));
    EXPECT_GE(rows.size(), 6u) << file;
    for (const auto& row : rows) {
      ASSERT_EQ(row.size(), 7u) << file;
      EXPECT_LE(row[4], row[2]) << file;
      EXPECT_GE(row[5], row[2]) << file;
      EXPECT_GT(row[6], 10) << file;
    }
  }
  EXPECT_EQ(rows_of(scratch.file("out/slots.csv")).size(), 300u);
  EXPECT_EQ(rows_of(scratch.file("out/speed.csv")).size(), 8u);

  EXPECT_EQ(same_part(html), same_part(make("again", " --at-a-time 1")));
  EXPECT_EQ(read_file(scratch.file("out/radio.csv")), read_file(scratch.file("again/radio.csv")));
}

}  // namespace
}  // namespace sandlot::test
