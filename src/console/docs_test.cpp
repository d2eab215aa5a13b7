#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "console/command.h"

namespace sandlot::console {
namespace {

std::string escaped(std::string_view text, std::string_view signs) {
  std::string out;
  for (const char c : text) {
    if (signs.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// The row of a command in docs/console.md.
std::string row(const Verb& verb) {
  const std::string text = std::string("| `") + verb.name + (*verb.usage ? " " : "") +
                           escaped(verb.usage, "|") + "`" + (verb.steers ? " \\*" : "") + " | ";
  return text + (*verb.others ? "also `" + std::string(verb.others) + "`" : "") + " | " +
         escaped(verb.help, "|*") + " |\n";
}

TEST(ConsoleDocs, TheTableIsThatOfTheCommands) {
  std::ifstream in("docs/console.md");
  const std::string page(std::istreambuf_iterator<char>(in), {});
  ASSERT_FALSE(page.empty());
  std::string rows;
  for (const Verb& verb : commands()) rows += row(verb);
  EXPECT_NE(page.find("\n" + rows + "\n"), std::string::npos) << "docs/console.md should have:\n" << rows;
}

TEST(ConsoleDocs, NamesAreKnownOnce) {
  std::vector<std::string> names = command_names({});
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  for (const Verb& verb : commands()) {
    EXPECT_EQ(find_command(verb.name), &verb);
    EXPECT_FALSE(verb.arguments.empty()) << verb.name;
  }
}

}  // namespace
}  // namespace sandlot::console
