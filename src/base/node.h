#pragma once
/// A configuration value that remembers where it was written: the common form of YAML, SDF and URDF.
///
/// Readers build Nodes; specs are read from them (base/read.h), so every complaint can name file, line and
/// key.
///
/// Copies share what they hold until one of them is written to, so that ten thousand robots of one model keep
/// its keys once. A pointer or reference that a non-const member gave is for writing at once: one kept from
/// before the Node was copied writes into the copy as well.
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace sandlot {

class Node {
 public:
  enum class Type { null, scalar, sequence, map };
  struct Entry;

  Node() = default;
  static Node scalar(std::string text, Place place = {});
  static Node sequence(Place place = {});
  static Node map(Place place = {});

  Type type() const;
  bool is_null() const { return type() == Type::null; }
  bool is_scalar() const { return type() == Type::scalar; }
  bool is_sequence() const { return type() == Type::sequence; }
  bool is_map() const { return type() == Type::map; }
  const Place& place() const;
  void set_place(Place place);

  /// The text of a scalar; "" otherwise.
  const std::string& text() const;
  /// Elements of a sequence; empty otherwise.
  const std::vector<Node>& items() const;
  std::vector<Node>& items();
  /// Entries of a map in file order; empty otherwise.
  const std::vector<Entry>& entries() const;
  std::vector<Entry>& entries();

  /// The value of a key, or null (nullptr) when there is none. Maps only.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  /// Adds or replaces.
  Node& set(std::string key, Node value);
  Node& push(Node value);
  bool erase(std::string_view key);

  /// An error at this node's place.
  Error error(std::string what, std::string fix = "", std::string path = "") const;

 private:
  struct Content;
  const Content& content() const;
  Content& own();  ///< to be written to: nobody else's

  std::shared_ptr<Content> content_;  ///< null: nothing, written nowhere
};

struct Node::Entry {
  std::string key;
  Node value;
  Place key_place;
};

/// Lays `over` upon `base`: maps merge key by key, anything else is replaced.
void merge(Node& base, const Node& over);

/// "a map", "a list", "text 'x'", "nothing": for error messages.
std::string describe(const Node& node);

}  // namespace sandlot
