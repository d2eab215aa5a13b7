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
std::string row(const BuiltinCommand& command) {
  const std::string text = std::string("| `") + command.name + (*command.usage ? " " : "") +
                           escaped(command.usage, "|") + "`" + (command.steers ? " \\*" : "") + " | ";
  return text + (*command.aliases ? "also `" + std::string(command.aliases) + "`" : "") + " | " +
         escaped(command.help, "|*") + " |\n";
}

TEST(ConsoleDocs, TheTableIsThatOfTheCommands) {
  std::ifstream in("docs/console.md");
  const std::string page(std::istreambuf_iterator<char>(in), {});
  ASSERT_FALSE(page.empty());
  std::string rows;
  for (const BuiltinCommand& command : commands()) rows += row(command);
  EXPECT_NE(page.find("\n" + rows + "\n"), std::string::npos) << "docs/console.md should have:\n" << rows;
}

TEST(ConsoleDocs, NamesAreKnownOnce) {
  std::vector<std::string> names = command_names({});
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  for (const BuiltinCommand& command : commands()) {
    EXPECT_EQ(find_command(command.name), &command);
    EXPECT_FALSE(command.arguments.empty()) << command.name;
  }
}

}  // namespace
}  // namespace sandlot::console
