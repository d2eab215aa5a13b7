#include "files/yaml.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

namespace sandlot {
namespace {

std::string error_of(std::string_view text, const TextLimits& limits = {}) {
  const auto result = parse_yaml(text, "f.yaml", limits);
  return result ? "" : result.error().text();
}

TEST(Yaml, KeepsFileLineAndColumnOfKeysAndValues) {
  const auto root = parse_yaml("a: 1\nlist:\n  - x\n  -  {k: v}\n", "f.yaml");
  ASSERT_TRUE(root);
  EXPECT_EQ(to_string(root->find("a")->place()), "f.yaml:1:4");
  EXPECT_EQ(to_string(root->entries()[1].key_place), "f.yaml:2:1");
  const Node& list = *root->find("list");
  EXPECT_EQ(list.items()[0].text(), "x");
  EXPECT_EQ(to_string(list.items()[1].place()), "f.yaml:4:6");
  EXPECT_EQ(to_string(list.items()[1].find("k")->place()), "f.yaml:4:10");
}

TEST(Yaml, TellsNullFromText) {
  const auto root = parse_yaml("a:\nb: ~\nc: 'null'\nd: ''\n", "f.yaml");
  ASSERT_TRUE(root);
  EXPECT_TRUE(root->find("a")->is_null());
  EXPECT_TRUE(root->find("b")->is_null());
  EXPECT_EQ(root->find("c")->text(), "null");
  EXPECT_TRUE(root->find("d")->is_scalar());
}

TEST(Yaml, VariablesNeedNoQuotesInFlow) {
  const auto root = parse_yaml("a: {k: ${v}, l: [x${v_1}y, 2]}\nb: '${v}'\n", "f.yaml");
  ASSERT_TRUE(root) << root.error().text();
  EXPECT_EQ(root->find("a")->find("k")->text(), "${v}");
  EXPECT_EQ(root->find("a")->find("l")->items()[0].text(), "x${v_1}y");
  EXPECT_EQ(to_string(root->find("a")->find("l")->items()[1].place()), "f.yaml:1:28");
  EXPECT_EQ(root->find("b")->text(), "${v}");
}

TEST(Yaml, AnEmptyDocumentIsNull) {
  EXPECT_TRUE(parse_yaml("", "f")->is_null());
  EXPECT_TRUE(parse_yaml("# only a comment\n", "f")->is_null());
}

TEST(Yaml, AliasesStandForCopies) {
  const auto root = parse_yaml("a: &x {k: [1, 2]}\nb: *x\n", "f.yaml");
  ASSERT_TRUE(root);
  EXPECT_EQ(root->find("b")->find("k")->items()[1].text(), "2");
}

TEST(Yaml, RefusesWhatItCannotMean) {
  EXPECT_EQ(error_of("a: 1\nb: 2\na: 3\n"), "f.yaml:3:1: key 'a' is given twice; it is already in line 1");
  EXPECT_NE(error_of("a:\n\t- 1\n").find("; indent with blanks, not tabs"), std::string::npos);
  EXPECT_NE(error_of("a:\n  - b: 1\n   c: 2\n").find("equally far"), std::string::npos);
  EXPECT_EQ(error_of("? [a]\n: 1\n"), "f.yaml:1:3: a key must be a plain word");
  EXPECT_EQ(error_of("a: !thing 1\n").substr(0, 24), "f.yaml:1:4: tag '!thing'");
  EXPECT_EQ(error_of("a: 1\n---\nb: 2\n").substr(0, 34), "f.yaml:2:1: a second document begi");
  EXPECT_EQ(error_of("a: &x [*x]\n").substr(0, 36), "f.yaml:1:8: this alias stands for a ");
  EXPECT_NE(error_of("a: 1\n\tb: 2\n"), "");
  EXPECT_NE(error_of("a: {when: x[3] < 1}\n").find("needs quotes"), std::string::npos);
  EXPECT_EQ(error_of("a: [{when: x[3] > 1}]\n").substr(0, 55),
            "f.yaml:1:17: here begins nothing that YAML knows; withi");
  EXPECT_NE(error_of("a: @x\n").find("one that begins with @"), std::string::npos);
  EXPECT_EQ(error_of("a: *x\n").substr(0, 56), "f.yaml:1:4: no anchor of that name stands before this al");
  EXPECT_EQ(error_of("a: [1\nb: 2\n").substr(0, 9), "f.yaml:2:");
}

TEST(Yaml, RefusesBytesThatNoTextHas) {
  EXPECT_EQ(error_of(std::string_view("a: 1\nb: \0", 9)).substr(0, 34), "f.yaml:2:4: control character 0x00");
  EXPECT_EQ(error_of("ab\xC0\xAF").substr(0, 42),
            "f.yaml:1:3: byte 0xc0 is not valid UTF-8; ");  // overlong '/'
  EXPECT_NE(error_of("\xED\xA0\x80"), "");                  // surrogate
  EXPECT_NE(error_of("a: \xE2\x82"), "");                   // cut off
  EXPECT_EQ(error_of("a: \xE2\x82\xAC \xF0\x9F\xA4\x96\n"), "");
}

TEST(Yaml, BoundsDepthAndNumberOfValues) {
  const auto nest = [](std::size_t n) { return std::string(n, '[') + std::string(n, ']'); };
  EXPECT_EQ(error_of(nest(8), {.max_depth = 8}), "");
  EXPECT_EQ(error_of(nest(9), {.max_depth = 8}),
            "f.yaml:1:9: nested too deeply; at most 8 levels are allowed");
  EXPECT_NE(error_of(nest(1'000'000)), "");
  EXPECT_EQ(error_of("[1, 2, 3]", {.max_nodes = 4}), "");
  EXPECT_EQ(error_of("[1, 2, 3, 4]", {.max_nodes = 4}).substr(0, 28), "f.yaml:1:11: too many values");
}

TEST(Yaml, AliasesCountAsWhatTheyStandFor) {
  // "Billion laughs": 10^9 values in ten lines.
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string from = "*a" + std::to_string(i - 1), to = "a" + std::to_string(i);
    text += to + ": &" + to + " [" + from;
    for (int k = 1; k < 10; ++k) text += ", " + from;
    text += "]\n";
  }
  EXPECT_NE(error_of(text).find("too many values"), std::string::npos);
  // Depth adds up through aliases too.
  EXPECT_EQ(error_of("a: &a [[[1]]]\nb: [[*a]]\n", {.max_depth = 6}), "");
  EXPECT_NE(error_of("a: &a [[[1]]]\nb: [[*a]]\n", {.max_depth = 5}), "");
}

TEST(TextFile, EachObstacleHasItsOwnError) {
  const auto error = [](const std::string& path, std::size_t max) {
    const auto read = read_text_file(path, max);
    return read ? "" : read.error().text();
  };
  const std::string folder = testing::TempDir() + "sandlot_text_file";
  std::filesystem::create_directories(folder);
  EXPECT_EQ(error(folder, 10), folder + ": is a folder; name a file in it");
  EXPECT_EQ(error(folder + "/none", 10), folder + "/none: no such file");
  EXPECT_EQ(error("/dev/zero", 10), "/dev/zero: is not a regular file");
  const std::string file = folder + "/file";
  std::ofstream(file) << "hello";
  EXPECT_EQ(*read_text_file(file, 5), "hello");
  EXPECT_EQ(error(folder + "/fiel", 10), folder + "/fiel: no such file; did you mean '" + file + "'?");
  EXPECT_EQ(error(folder + "/none/file", 10),
            folder + "/none/file: no such file; there is no folder '" + folder + "/none'");
  // A sparse file of 1 GiB: refused by its size, so without reading it.
  std::filesystem::resize_file(file, 1u << 30);
  EXPECT_EQ(error(file, 16u << 20), file + ": is too large: 1024 MiB; at most 16 MiB are read");
  std::filesystem::remove_all(folder);
}

TEST(YamlText, IsReadAsTheSameTree) {
  const std::string text =
      "a: plain text\n\"b: c\": \"null\"\nempty: \"\"\nnothing: null\nmap: {}\nlist: [1, \"x, y\", \"- z\"]\n"
      "groups:\n  - name: one\n    inner:\n      - gaussian:\n          std: 0.1\n  - [1, 2]\nquote: "
      "\"a\\\"b\\\\c\\x0a\"\n";
  const auto tree = parse_yaml(text, "a.yaml");
  ASSERT_TRUE(tree) << tree.error().text();
  EXPECT_EQ(tree->find("quote")->text(), "a\"b\\c\n");
  EXPECT_TRUE(tree->find("nothing")->is_null());
  EXPECT_EQ(tree->find("b: c")->text(), "null");
  EXPECT_EQ(yaml_text(*tree), text);
}

}  // namespace
}  // namespace sandlot
