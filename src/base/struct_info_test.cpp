#include "base/struct_info.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/describe.h"
#include "base/read.h"
#include "base/values.h"

namespace sandlot::struct_info_test {
namespace {

enum class Colour : std::uint8_t { red, green };
constexpr EnumName<Colour> colour_names[] = {{"red", Colour::red}, {"green", Colour::green}};
std::span<const EnumName<Colour>> enum_names(Colour) { return colour_names; }
enum class Nameless : std::uint8_t { none, some };

/// Has components, and is a fixed vector.
struct Point {
  double x = 0, y = 0;
  static constexpr std::size_t extent = 2;
  double& operator[](std::size_t i) { return i == 0 ? x : y; }
  const double& operator[](std::size_t i) const { return i == 0 ? x : y; }
};
constexpr Component point_parts[] = {{"x", ""}, {"angle", "rad"}};
std::span<const Component> components(const Point&) { return point_parts; }
double component(const Point& p, std::size_t i) { return p[i]; }

struct Part {
  double gain = 2;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"gain", "U/s", "Gain.", 0, 10, Field::tunable}, s.gain);
  }
  Status check(const Node& node, const std::string& path) const {
    return gain != 7 ? Status() : node.error("seven is too lucky", "", path);
  }
};

/// As a stage of a chain: its member is a copy that is put back.
struct Copied {
  static constexpr const char* described_as = "copied";
  std::optional<Part> part;
  static void fields(auto& s, auto&& visit) {
    std::optional<Part> here = s.part;
    visit(Field{"part", "", "Part."}, here);
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(s)>>) s.part = here;
  }
};

struct Chain {
  static constexpr const char* list_key = "stages";
  double white = 0;
  std::vector<Copied> stages;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "", "White.", 0, 1}, s.white);
    visit(Field{"stages", "", "Stages."}, s.stages);
  }
};

struct Every {
  bool on = true;
  std::int8_t small = -3;
  std::uint64_t large = 5;
  float single = 0.5f;
  double number = 0.25;
  Colour colour = Colour::green;
  std::string text = "word";
  Node node;
  std::optional<double> maybe;
  std::optional<Part> maybe_part;
  std::array<int, 2> array{1, 2};
  Point point{3, 4};
  std::vector<double> numbers{6, 7, 8};
  std::vector<bool> bools{false, true};
  std::vector<std::string> texts;
  std::vector<Point> points{{1, 2}};
  std::vector<Part> parts{{}, {}};
  Part part;
  Chain chain;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"on", "", "Bool."}, s.on);
    visit(Field{"small", "1", "Integer."}, s.small);
    visit(Field{"large", "1", "Integer."}, s.large);
    visit(Field{"single", "m", "Number."}, s.single);
    visit(Field{"number", "m", "Number."}, s.number);
    visit(Field{"colour", "", "Choice."}, s.colour);
    visit(Field{"text", "", "Text."}, s.text);
    visit(Field{"node", "", "Node."}, s.node);
    visit(Field{"maybe", "s", "Option."}, s.maybe);
    visit(Field{"maybe_part", "m", "Option."}, s.maybe_part);
    visit(Field{"array", "1", "Array."}, s.array);
    visit(Field{"point", "m", "Fixed vector."}, s.point);
    visit(Field{"numbers", "m", "List."}, s.numbers);
    visit(Field{"bools", "", "List."}, s.bools);
    visit(Field{"texts", "", "List."}, s.texts);
    visit(Field{"points", "m", "List of lists."}, s.points);
    visit(Field{"parts", "m", "List of structs."}, s.parts);
    visit(Field{"part", "m", "Struct."}, s.part);
    visit(Field{"chain", "m", "Struct or list."}, s.chain);
  }
};

/// What only a state may hold, and a list of fields that depends on the value.
struct State {
  Time since = Time::from_s(1.5);
  Nameless mode = Nameless::some;
  std::vector<double> slots;
  static void fields(auto& s, auto&& visit) {
    static constexpr const char* names[] = {"0", "1", "2"};
    visit(Field{"since", "", "Time."}, s.since);
    visit(Field{"mode", "", "Enumeration without names."}, s.mode);
    for (std::size_t i = 0; i < s.slots.size(); ++i) visit(Field{names[i], "m", "Slot."}, s.slots[i]);
  }
};

Node scalar(const char* text) { return Node::scalar(text); }
Node list(std::initializer_list<const char*> texts) {
  Node out = Node::sequence();
  for (const char* text : texts) out.push(scalar(text));
  return out;
}
Node map(const char* key, Node value) {
  Node out = Node::map();
  out.set(key, std::move(value));
  return out;
}

TEST(StructInfo, ReadsEveryKindOfMember) {
  Node node = Node::map();
  node.set("on", scalar("false"));
  node.set("small", scalar("-128"));
  node.set("large", scalar("1000000000000"));
  node.set("single", scalar("25 cm"));
  node.set("number", scalar("2 km"));
  node.set("colour", scalar("red"));
  node.set("text", scalar("other"));
  node.set("node", map("a", scalar("b")));
  node.set("maybe", scalar("5 ms"));
  node.set("maybe_part", map("gain", scalar("3")));
  node.set("array", list({"8", "9"}));
  node.set("point", list({"1", "50 cm"}));
  node.set("numbers", list({"1"}));
  node.set("bools", list({"true", "false", "true"}));
  node.set("texts", scalar("alone"));
  Node points = Node::sequence();
  points.push(list({"5", "6"}));
  node.set("points", points);
  Node parts = Node::sequence();
  parts.push(map("gain", scalar("4")));
  node.set("parts", parts);
  node.set("part", map("gain", scalar("50 cm/s")));
  Node stages = Node::sequence();
  stages.push(map("part", map("gain", scalar("6"))));
  node.set("chain", stages);

  const auto read = read_spec<Every>(node);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_FALSE(read->on);
  EXPECT_EQ(read->small, -128);
  EXPECT_EQ(read->large, 1000000000000u);
  EXPECT_EQ(read->single, 0.25f);
  EXPECT_EQ(read->number, 2000);
  EXPECT_EQ(read->colour, Colour::red);
  EXPECT_EQ(read->text, "other");
  EXPECT_EQ(read->node.find("a")->text(), "b");
  EXPECT_EQ(read->maybe, 0.005);
  EXPECT_EQ(read->maybe_part->gain, 3);
  EXPECT_EQ(read->array, (std::array<int, 2>{8, 9}));
  EXPECT_EQ(read->point.x, 1);
  EXPECT_EQ(read->point.y, 0.5);
  EXPECT_EQ(read->numbers, std::vector<double>{1});
  EXPECT_EQ(read->bools, (std::vector<bool>{true, false, true}));
  EXPECT_EQ(read->texts, std::vector<std::string>{"alone"});
  ASSERT_EQ(read->points.size(), 1u);
  EXPECT_EQ(read->points[0].y, 6);
  ASSERT_EQ(read->parts.size(), 1u);
  EXPECT_EQ(read->parts[0].gain, 4);
  EXPECT_EQ(read->part.gain, 0.5) << "the unit U/s of a field in metres is m/s";
  ASSERT_EQ(read->chain.stages.size(), 1u);
  EXPECT_EQ(read->chain.stages[0].part->gain, 6) << "a copy is put back";
}

TEST(StructInfo, RefusesWhatATypeCannotHold) {
  const auto fault = [](const char* key, Node value) {
    const auto read = read_spec<Every>(map(key, std::move(value)));
    return read ? std::string() : read.error().text();
  };
  EXPECT_NE(fault("small", scalar("128")), "");
  EXPECT_NE(fault("small", scalar("0.5")), "");
  EXPECT_NE(fault("large", scalar("-1")), "");
  EXPECT_NE(fault("colour", scalar("gren")).find("did you mean 'green'"), std::string::npos);
  EXPECT_NE(fault("array", list({"1"})).find("a list of 2 values"), std::string::npos);
  EXPECT_NE(fault("part", map("gain", scalar("7"))).find("seven is too lucky"), std::string::npos);
  EXPECT_NE(fault("maybe_part", map("gain", scalar("7"))).find("seven is too lucky"), std::string::npos);
  EXPECT_NE(fault("chain", map("wite", scalar("1"))).find("? stages are written as a list"),
            std::string::npos);
}

TEST(StructInfo, SetsTunablePartsOfStructsOptionsListsAndCopies) {
  Every x;
  x.maybe_part.emplace();
  x.chain.stages.resize(2);
  x.chain.stages[1].part.emplace();
  const auto set = [&](const char* path) { return set_tunable(x, path, scalar("3")); };
  EXPECT_TRUE(set("part/gain"));
  EXPECT_TRUE(set("maybe_part/gain"));
  EXPECT_TRUE(set("parts/1/gain"));
  EXPECT_TRUE(set("chain/1/part/gain"));
  EXPECT_EQ(x.part.gain, 3);
  EXPECT_EQ(x.maybe_part->gain, 3);
  EXPECT_EQ(x.parts[0].gain, 2);
  EXPECT_EQ(x.parts[1].gain, 3);
  EXPECT_EQ(x.chain.stages[1].part->gain, 3);
  for (const char* path : {"number", "parts/2/gain", "parts/1", "array/0", "chain/0/part/gain", "points/0/0"})
    EXPECT_FALSE(set(path)) << path;
}

TEST(StructInfo, FindsAndListsEveryKindOfValue) {
  const Every x;
  const auto value = [&](const auto& from, const char* path) {
    return value_at(from, *parse_value_path(path));
  };
  const std::map<std::string, double> expected = {
      {"on", 1},          {"small", -3},        {"large", 5},     {"single", 0.5},
      {"number", 0.25},   {"colour", 1},        {"array[1]", 2},  {"point[1]", 4},
      {"point.angle", 4}, {"numbers[2]", 8},    {"bools[1]", 1},  {"bools[0]", 0},
      {"points[0].x", 1}, {"parts[1].gain", 2}, {"part.gain", 2}, {"chain.white", 0}};
  for (const auto& [path, number] : expected) {
    EXPECT_EQ(value(x, path.c_str()).is, ValueFound::Is::value) << path;
    EXPECT_EQ(value(x, path.c_str()).value, number) << path;
  }
  EXPECT_EQ(value(x, "part.gain").unit, "m/s");
  EXPECT_EQ(value(x, "point.angle").unit, "rad");
  for (const char* path : {"maybe", "maybe_part.gain", "numbers[3]", "parts[2].gain", "bools[2]"})
    EXPECT_EQ(value(x, path).is, ValueFound::Is::absent) << path;
  for (const char* path : {"text", "node", "texts[0]"})
    EXPECT_EQ(value(x, path).is, ValueFound::Is::text) << path;
  for (const char* path : {"part", "array", "point", "parts[0]"})
    EXPECT_EQ(value(x, path).is, ValueFound::Is::compound) << path;
  for (const char* path : {"no", "array[2]", "point.z", "on[0]", "part.no", "number.x"})
    EXPECT_EQ(value(x, path).is, ValueFound::Is::unknown) << path;

  const State state{.slots = {1, 2}};
  EXPECT_EQ(value(state, "since").value, 1.5);
  EXPECT_EQ(value(state, "since").unit, "s");
  EXPECT_EQ(value(state, "mode").value, 1);
  EXPECT_EQ(value(state, "1").value, 2);
  EXPECT_EQ(value(state, "2").is, ValueFound::Is::unknown) << "there are two slots";

  std::vector<std::string> paths;
  list_values(x, "", "", "", [&](const ValueEntry& entry) {
    paths.push_back(entry.path + (entry.list ? "[]" : ""));
    EXPECT_EQ(entry.is == ValueFound::Is::absent,
              entry.list ? entry.count == 0 : entry.path.starts_with("maybe"))
        << entry.path;
  });
  EXPECT_EQ(paths, (std::vector<std::string>{"on", "small", "large", "single", "number", "colour", "maybe",
                                             "maybe_part.gain", "array[]", "point.x", "point.angle",
                                             "numbers[]", "bools[]", "points[0].x", "points[0].angle",
                                             "parts[0].gain", "parts[1].gain", "part.gain", "chain.white"}));
}

TEST(StructInfo, DescribesEveryKindOfMember) {
  std::map<std::string, FieldInfo> all;
  for (const FieldInfo& info : describe_fields<Every>()) all[info.path] = info;
  const std::map<std::string, std::pair<const char*, const char*>> expected = {
      {"on", {"bool", "true"}},
      {"small", {"integer", "-3"}},
      {"single", {"number", "0.5"}},
      {"colour", {"choice", "green"}},
      {"text", {"text", "word"}},
      {"node", {"map", ""}},
      {"maybe", {"number", ""}},
      {"maybe_part/gain", {"number", "2"}},
      {"array", {"list of number", "[1, 2]"}},
      {"point", {"list of number", "[3, 4]"}},
      {"numbers", {"list of number", "[6, 7, 8]"}},
      {"bools", {"list of number", "[false, true]"}},
      {"texts", {"list of text", "[]"}},
      {"points", {"list of lists of number", "[[1, 2]]"}},
      {"parts", {"list of maps", ""}},
      {"parts[]/gain", {"number", "2"}},
      {"chain/stages", {"list of maps", ""}}};
  for (const auto& [path, is] : expected) {
    ASSERT_TRUE(all.contains(path)) << path;
    EXPECT_EQ(all[path].type, is.first) << path;
    EXPECT_EQ(all[path].default_value, is.second) << path;
  }
  EXPECT_EQ(all["points"].length, 2u);
  EXPECT_EQ(all["parts[]/gain"].unit, "m/s");
  EXPECT_TRUE(all["chain/stages"].for_map);
  EXPECT_EQ(all["chain/stages"].elements, "copied");
  EXPECT_FALSE(all.contains("chain/stages[]/part/gain")) << "described elsewhere, under its own name";
  EXPECT_TRUE(all["maybe_part/gain"].optional);
}

}  // namespace
}  // namespace sandlot::struct_info_test
