#include "base/read.h"

#include <gtest/gtest.h>

#include <array>

#include "base/describe.h"

namespace sandlot::read_test {
namespace {

enum class Colour : std::uint8_t { red, green };
constexpr EnumName<Colour> colour_names[] = {{"red", Colour::red}, {"green", Colour::green}};
std::span<const EnumName<Colour>> enum_names(Colour) { return colour_names; }

struct Vec3 {
  double x = 0, y = 0, z = 0;
  static constexpr std::size_t extent = 3;
  double& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  const double& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

struct Inner {
  double white = 0.5;
  int fixed = 3;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "m", "Noise.", 0, 10, Field::tunable}, s.white);
    visit(Field{"fixed", "1", "Fixed.", 0, 10}, s.fixed);
  }
};

struct Spec {
  int beams = 181;
  double range_m = 2;
  bool on = false;
  std::string name = "x";
  Colour colour = Colour::red;
  Vec3 offset;
  std::vector<double> list;
  std::vector<std::string> names;
  std::optional<double> maybe;
  std::vector<Inner> many;
  Inner noise;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"beams", "1", "Number of beams.", 1, 100'000}, s.beams);
    visit(Field{"range", "m", "Range.", 0, 100, Field::tunable}, s.range_m);
    visit(Field{"on", "", "Switch."}, s.on);
    visit(Field{"name", "", "Name.", 0, 0, Field::none, 5}, s.name);
    visit(Field{"colour", "", "Colour."}, s.colour);
    visit(Field{"offset", "m", "Offset.", -1, 1}, s.offset);
    visit(Field{"list", "m", "Numbers.", 0, 1, Field::none, 3}, s.list);
    visit(Field{"names", "", "Names.", 0, 0, Field::none, 4, 1}, s.names);
    visit(Field{"maybe", "m", "Optional."}, s.maybe);
    visit(Field{"many", "", "Several."}, s.many);
    visit(Field{"noise", "", "Noise."}, s.noise);
  }
};

const auto file = std::make_shared<const std::string>("a.yaml");
Node text(std::string value, int line = 7, int column = 3) {
  return Node::scalar(std::move(value), {file, line, column});
}
Node list(std::initializer_list<const char*> values) {
  Node node = Node::sequence({file, 7, 3});
  int column = 4;
  for (const char* value : values) node.push(text(value, 7, column++));
  return node;
}
Node map(std::string key, Node value) {
  Node node = Node::map({file, 1, 1});
  node.entries().push_back({std::move(key), std::move(value), {file, 6, 2}});
  return node;
}
template <class S = Spec>
std::string complaint(const Node& node) {
  const auto result = read_spec<S>(node);
  return result ? "" : result.error().text();
}

TEST(Read, DefaultsHoldWhereNothingIsWritten) {
  const auto spec = read_spec<Spec>(Node());
  ASSERT_TRUE(spec);
  EXPECT_EQ(spec->beams, 181);
  EXPECT_EQ(spec->noise.white, 0.5);
  EXPECT_FALSE(spec->maybe.has_value());
}

TEST(Read, TakesEveryKindOfValue) {
  Node node = Node::map();
  node.set("beams", text("12"));
  node.set("range", text("50 cm"));
  node.set("on", text("yes"));
  node.set("name", text("five5"));
  node.set("colour", text("green"));
  node.set("offset", list({"0.1", "20 cm", "-1"}));
  node.set("list", list({"0", "1"}));
  node.set("names", text("single"));
  node.set("maybe", text("2.5"));
  Node two = Node::sequence();
  two.push(map("white", text("1 mm")));
  two.push(Node::map());
  node.set("many", std::move(two));
  node.set("noise", map("white", text("9")));
  const auto spec = read_spec<Spec>(node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->beams, 12);
  EXPECT_EQ(spec->range_m, 0.5);
  EXPECT_TRUE(spec->on);
  EXPECT_EQ(spec->name, "five5");
  EXPECT_EQ(spec->colour, Colour::green);
  EXPECT_EQ(spec->offset, (Vec3{0.1, 0.2, -1}));
  EXPECT_EQ(spec->list, (std::vector<double>{0, 1}));
  EXPECT_EQ(spec->names, std::vector<std::string>{"single"});
  EXPECT_EQ(spec->maybe, 2.5);
  ASSERT_EQ(spec->many.size(), 2u);
  EXPECT_EQ(spec->many[0].white, 1e-3);
  EXPECT_EQ(spec->many[1].white, 0.5);
  EXPECT_EQ(spec->noise.white, 9);
}

// Every complaint names the place of the value (or of the key), the path, and what would be right.
TEST(Read, EveryFaultIsNamedWithPlaceAndPath) {
  EXPECT_EQ(complaint(map("beam", text("5"))), "a.yaml:6:2: unknown key 'beam'; did you mean 'beams'?");
  EXPECT_EQ(complaint(map("beams", text("1000000000"))),
            "a.yaml:7:3: /beams: must be in [1, 1e+05], is 1e+09; Number of beams.");
  EXPECT_EQ(complaint(map("beams", text("1.5"))), "a.yaml:7:3: /beams: must be a whole number, is 1.5");
  EXPECT_EQ(complaint(map("range", text("nan"))),
            "a.yaml:7:3: /range: must be in [0, 100] m, is nan; Range.");
  EXPECT_EQ(complaint(map("range", text("inf"))),
            "a.yaml:7:3: /range: must be in [0, 100] m, is inf; Range.");
  EXPECT_EQ(complaint(map("range", text("-1e-9"))),
            "a.yaml:7:3: /range: must be in [0, 100] m, is -1e-09; Range.");
  EXPECT_EQ(complaint(map("range", text("5 kg"))),
            "a.yaml:7:3: /range: unit 'kg' does not fit; units that fit: m, mm, cm, km, um, in, ft");
  EXPECT_EQ(complaint(map("range", text("wide"))),
            "a.yaml:7:3: /range: 'wide' is not a number; write a number, in m or with its unit");
  EXPECT_EQ(complaint(map("range", list({"1"}))), "a.yaml:7:3: /range: expected a number, found a list");
  EXPECT_EQ(complaint(map("on", text("maybe"))), "a.yaml:7:3: /on: expected true or false, found 'maybe'");
  EXPECT_EQ(complaint(map("name", text("sixsix"))),
            "a.yaml:7:3: /name: text has 6 characters; at most 5 are allowed");
  EXPECT_EQ(complaint(map("colour", text("gren"))),
            "a.yaml:7:3: /colour: 'gren' is not a choice here; did you mean 'green'?");
  EXPECT_EQ(complaint(map("offset", list({"1", "2"}))),
            "a.yaml:7:3: /offset: expected a list of 3 values, found one of 2");
  EXPECT_EQ(complaint(map("offset", list({"0", "0", "2"}))),
            "a.yaml:7:6: /offset/2: must be in [-1, 1] m, is 2; Offset.");
  EXPECT_EQ(complaint(map("list", list({"0", "0", "0", "0"}))),
            "a.yaml:7:3: /list: list has 4 elements; at most 3 are allowed");
  EXPECT_EQ(complaint(map("list", list({"0", "x"}))),
            "a.yaml:7:5: /list/1: 'x' is not a number; write a number, in m or with its unit");
  EXPECT_EQ(complaint(map("list", text("1"))), "a.yaml:7:3: /list: expected a list, found '1'");
  EXPECT_EQ(complaint(map("noise", map("white", text("11")))),
            "a.yaml:7:3: /noise/white: must be in [0, 10] m, is 11; Noise.");
  EXPECT_EQ(complaint(map("noise", map("whte", text("1")))),
            "a.yaml:6:2: /noise: unknown key 'whte'; did you mean 'white'?");
  Node two = Node::sequence();
  two.push(Node::map());
  two.push(map("fixed", text("99")));
  EXPECT_EQ(complaint(map("many", std::move(two))),
            "a.yaml:7:3: /many/1/fixed: must be in [0, 10], is 99; Fixed.");
  EXPECT_EQ(complaint(text("5")), "a.yaml:7:3: expected a map of keys, found '5'");
}

TEST(Read, TheLengthOfAListIsNotThatOfItsTexts) {
  const auto spec = read_spec<Spec>(map("names", list({"front_left_wheel_joint", "", "c", "d"})));
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->names.front(), "front_left_wheel_joint");
  EXPECT_TRUE(read_spec<Spec>(map("names", text("front_left_wheel_joint")))) << "one text is a list of one";
  EXPECT_EQ(complaint(map("names", list({"a", "b", "c", "d", "e"}))),
            "a.yaml:7:3: /names: list has 5 elements; at most 4 are allowed");
}

TEST(Read, TheFirstFaultIsReportedAndASlipInAKeyBeforeAll) {
  Node node = map("beams", text("0"));
  node.entries().push_back({"rnge", text("1"), {file, 9, 9}});
  EXPECT_EQ(complaint(node), "a.yaml:9:9: unknown key 'rnge'; did you mean 'range'?");
}

struct Needy {
  std::string joint;
  std::uint8_t small = 0;
  std::int64_t big = 0;
  std::uint32_t unbounded = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Name of a joint.", 0, 0, Field::required}, s.joint);
    visit(Field{"small", "1", "A byte."}, s.small);
    visit(Field{"big", "1", "A long one.", -1e30, 1e30}, s.big);
    visit(Field{"unbounded", "1", "No range given."}, s.unbounded);
  }
};

TEST(Read, ARequiredKeyIsMissed) {
  const Node empty = Node::map({file, 4, 5});
  EXPECT_EQ(complaint<Needy>(empty), "a.yaml:4:5: key 'joint' is missing; Name of a joint.");
}

// A cast of a double that the integer cannot hold is undefined: the type's own range is part of the check.
TEST(Read, IntegersStayWithinTheirType) {
  const auto with = [](const char* key, const char* value) {
    Node node = map("joint", text("j"));
    node.set(key, text(value));
    return node;
  };
  EXPECT_EQ(complaint<Needy>(with("small", "255")), "");
  EXPECT_EQ(complaint<Needy>(with("small", "256")),
            "a.yaml:7:3: /small: must be in [0, 255], is 256; A byte.");
  EXPECT_EQ(complaint<Needy>(with("small", "-1")), "a.yaml:7:3: /small: must be in [0, 255], is -1; A byte.");
  EXPECT_EQ(complaint<Needy>(with("unbounded", "4294967295")), "");
  EXPECT_NE(complaint<Needy>(with("unbounded", "4294967296")), "");
  EXPECT_EQ(complaint<Needy>(with("big", "9007199254740992")), "");
  EXPECT_NE(complaint<Needy>(with("big", "1e17")), "");  // a double no longer holds every integer
  EXPECT_NE(complaint<Needy>(with("big", "-1e300")), "");
}

TEST(SetTunable, ChangesTunableNumbersByPath) {
  Spec spec;
  EXPECT_TRUE(set_tunable(spec, "range", text("3")));
  EXPECT_TRUE(set_tunable(spec, "noise/white", text("4 mm")));
  EXPECT_EQ(spec.range_m, 3);
  EXPECT_EQ(spec.noise.white, 0.004);
}

TEST(SetTunable, RefusesTheRestAndLeavesTheSpecAlone) {
  Spec spec;
  const auto refused = [&](const char* path, const char* value) {
    const Status status = set_tunable(spec, path, text(value));
    return status ? "" : status.error().text();
  };
  EXPECT_EQ(refused("beams", "5"), "a.yaml:7:3: /beams: 'beams' is fixed once the run has started");
  EXPECT_EQ(refused("noise/fixed", "5"),
            "a.yaml:7:3: /noise/fixed: 'fixed' is fixed once the run has started");
  EXPECT_EQ(refused("noise", "5"), "a.yaml:7:3: /noise: 'noise' is fixed once the run has started");
  EXPECT_EQ(refused("noise/whit", "5"), "a.yaml:7:3: /noise: no parameter 'whit'; did you mean 'white'?");
  EXPECT_EQ(refused("range/x", "5"), "a.yaml:7:3: /range: 'range' has no parts");
  EXPECT_EQ(refused("range", "500"), "a.yaml:7:3: /range: must be in [0, 100] m, is 500; Range.");
  EXPECT_NE(refused("", "5"), "");
  EXPECT_NE(refused("/", "5"), "");
  EXPECT_EQ(spec.beams, 181);
  EXPECT_EQ(spec.range_m, 2);
}

TEST(Describe, NamesEveryLeafWithItsTypeUnitAndDefault) {
  const std::vector<FieldInfo> all = describe_fields<Spec>();
  const auto at = [&](const char* path) {
    for (const FieldInfo& info : all)
      if (info.path == path) return info;
    ADD_FAILURE() << path;
    return FieldInfo{};
  };
  EXPECT_EQ(all.size(), 14u);
  EXPECT_EQ(at("beams").type, "integer");
  EXPECT_EQ(at("beams").default_value, "181");
  EXPECT_EQ(at("beams").max, 100'000);
  EXPECT_FALSE(at("beams").tunable);
  EXPECT_EQ(at("range").unit, "m");
  EXPECT_TRUE(at("range").tunable);
  EXPECT_EQ(at("on").default_value, "false");
  EXPECT_EQ(at("colour").choices, (std::vector<std::string>{"red", "green"}));
  EXPECT_EQ(at("colour").default_value, "red");
  EXPECT_EQ(at("offset").length, 3u);
  EXPECT_EQ(at("offset").default_value, "[0, 0, 0]");
  EXPECT_EQ(at("list").type, "list of number");
  EXPECT_EQ(at("names").type, "list of text");
  EXPECT_TRUE(at("maybe").optional);
  EXPECT_EQ(at("maybe").default_value, "");
  EXPECT_EQ(at("many").type, "list of maps");
  EXPECT_EQ(at("many[]/white").default_value, "0.5");
  EXPECT_EQ(at("noise/white").unit, "m");
  EXPECT_TRUE(describe_fields<Needy>()[0].required);
}

}  // namespace
}  // namespace sandlot::read_test
