#include "base/node.h"

#include <gtest/gtest.h>

namespace sandlot {
namespace {

Node robot() {
  Node node = Node::map();
  node.set("laser", Node::map()).set("beams", Node::scalar("181"));
  node.set("names", Node::sequence()).push(Node::scalar("a"));
  return node;
}

TEST(Node, CopiesShareUntilOneIsWrittenTo) {
  const Node first = robot();
  Node second = first;
  EXPECT_EQ(&first.entries(), &std::as_const(second).entries());
  second.find("laser")->set("beams", Node::scalar("7"));
  second.find("names")->push(Node::scalar("b"));
  EXPECT_EQ(first.find("laser")->find("beams")->text(), "181");
  EXPECT_EQ(std::as_const(second).find("laser")->find("beams")->text(), "7");
  EXPECT_EQ(first.find("names")->items().size(), 1u);
  EXPECT_EQ(std::as_const(second).find("names")->items().size(), 2u);
  EXPECT_EQ(&first.find("names")->items()[0].text(), &std::as_const(second).find("names")->items()[0].text())
      << "what was not written to stays shared";
}

TEST(Node, AskingForWhatIsNotThereCopiesNothing) {
  const Node first = robot();
  Node second = first;
  EXPECT_EQ(second.find("sonar"), nullptr);
  EXPECT_FALSE(second.erase("sonar"));
  EXPECT_EQ(&first.entries(), &std::as_const(second).entries());
  EXPECT_TRUE(second.erase("laser"));
  EXPECT_EQ(first.entries().size(), 2u);
}

TEST(Node, NothingHasNeitherTextNorPlaceAndCanBecomeAMap) {
  Node node;
  EXPECT_TRUE(node.is_null());
  EXPECT_EQ(node.text(), "");
  EXPECT_EQ(node.place().file, nullptr);
  EXPECT_EQ(std::as_const(node).find("a"), nullptr);
  node.set("a", Node::scalar("1"));
  EXPECT_TRUE(node.is_map());
}

}  // namespace
}  // namespace sandlot
