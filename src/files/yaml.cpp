#include "files/yaml.h"

#include <cctype>
#include <istream>
#include <streambuf>
#include <unordered_map>
#include <unordered_set>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

namespace sandlot {
namespace {

/// Stand-ins for the braces of ${name}. In a flow list or map YAML takes braces for its own, and `{speed: ${v}}`
/// would be a puzzling error. check_text() keeps these bytes out of files, so the way back is unique.
constexpr char open_brace = '\x01', close_brace = '\x02';

std::string hide_variables(std::string_view text) {
  std::string out(text);
  for (std::size_t i = 0; (i = out.find("${", i)) != std::string::npos; i += 2) {
    std::size_t end = i + 2;
    while (end < out.size() && (std::isalnum(static_cast<unsigned char>(out[end])) || out[end] == '_')) ++end;
    if (end == i + 2 || end == out.size() || out[end] != '}') continue;
    out[i + 1] = open_brace;
    out[end] = close_brace;
  }
  return out;
}

std::string show_variables(std::string text) {
  for (char& c : text) c = c == open_brace ? '{' : c == close_brace ? '}' : c;
  return text;
}

/// yaml-cpp takes in a whole [...] or {...} before it reports the first event, at some hundred bytes per token: one
/// that is absurdly deep or long has to be refused before. Brackets in comments and quotes are counted too, hence the
/// generous depth; the exact limits are the Builder's.
Status check_flow(std::string_view text, const TextLimits& limits,
                  const std::shared_ptr<const std::string>& file) {
  constexpr std::size_t absurd_depth = 1000;
  std::size_t depth = 0, commas = 0;
  int line = 1;
  for (const char c : text) {
    line += c == '\n';
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0 && --depth == 0) commas = 0;
    commas += c == ',' && depth > 0;
    if (depth > absurd_depth) return Error{"nested too deeply, or brackets are not closed", "", {file, line}};
    if (commas > limits.max_nodes)
      return Error{
          "too many values", "at most " + std::to_string(limits.max_nodes) + " are allowed", {file, line}};
  }
  return {};
}

/// How a handler stops yaml-cpp's recursion; caught in parse_yaml.
struct Refused {
  Error error;
};

/// Reads from the caller's text; std::istringstream would copy it.
struct ViewBuffer : std::streambuf {
  explicit ViewBuffer(std::string_view text) {
    char* const begin = const_cast<char*>(text.data());  // never written to: no pbackfail, no overflow
    setg(begin, begin, begin + text.size());
  }
};

class Builder final : public YAML::EventHandler {
 public:
  Builder(std::shared_ptr<const std::string> file, const TextLimits& limits)
      : file_(std::move(file)), limits_(limits) {}

  Node take() { return std::move(root_); }
  int documents() const { return documents_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) refuse(mark, "a second document begins here", "write one document per file");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node node;
    node.set_place(at(mark));
    count(mark, 1);
    add(std::move(node), mark, anchor, 1);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check_tag(mark, tag);
    count(mark, 1);
    add(Node::scalar(show_variables(value), at(mark)), mark, anchor, 1);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end())
      refuse(mark, "this alias stands for a value that contains it", "write the value out");
    if (stack_.size() + found->second.depth > limits_.max_depth) refuse_depth(mark);
    count(mark, found->second.nodes);
    const std::size_t nodes = found->second.nodes, depth = found->second.depth;
    add(Node(found->second.node), mark, 0, nodes, depth);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(Node::sequence(at(mark)), mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(Node::map(at(mark)), mark, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  /// A list or map that is being filled.
  struct Open {
    Node node;
    YAML::Mark mark;
    YAML::anchor_t anchor = 0;
    std::size_t nodes = 1;  ///< in it so far, itself included
    std::size_t depth = 1;  ///< of what it contains
    bool has_key = false;
    std::string key;
    Place key_place;
    std::unordered_map<std::string, int> lines;  ///< of the keys so far
  };
  struct Anchored {
    Node node;
    std::size_t nodes, depth;
  };

  Place at(const YAML::Mark& mark) const {
    return mark.is_null() ? Place{file_, 0, 0} : Place{file_, mark.line + 1, mark.column + 1};
  }
  [[noreturn]] void refuse(const YAML::Mark& mark, std::string what, std::string fix = "") const {
    throw Refused{{std::move(what), std::move(fix), at(mark)}};
  }
  [[noreturn]] void refuse_depth(const YAML::Mark& mark) const {
    refuse(mark, "nested too deeply", "at most " + std::to_string(limits_.max_depth) + " levels are allowed");
  }
  void check_tag(const YAML::Mark& mark, const std::string& tag) const {
    // "?" is a plain scalar, "!" a quoted one.
    if (tag.empty() || tag == "?" || tag == "!" || tag.rfind("tag:yaml.org,2002:", 0) == 0) return;
    refuse(mark, "tag '" + tag.substr(0, 40) + "' means nothing here", "leave it out");
  }
  void count(const YAML::Mark& mark, std::size_t nodes) {
    if (nodes > limits_.max_nodes - nodes_)
      refuse(mark, "too many values", "at most " + std::to_string(limits_.max_nodes) + " are allowed");
    nodes_ += nodes;
  }
  void open(Node node, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (stack_.size() >= limits_.max_depth) refuse_depth(mark);
    count(mark, 1);
    if (!stack_.empty() && stack_.back().node.is_map() && !stack_.back().has_key) refuse_key(mark);
    stack_.push_back({std::move(node), mark, anchor});
  }
  void close() {
    Open done = std::move(stack_.back());
    stack_.pop_back();
    add(std::move(done.node), done.mark, done.anchor, done.nodes, done.depth);
  }
  [[noreturn]] void refuse_key(const YAML::Mark& mark) const { refuse(mark, "a key must be a plain word"); }

  void add(Node node, const YAML::Mark& mark, YAML::anchor_t anchor, std::size_t nodes,
           std::size_t depth = 0) {
    if (anchor != 0) {
      // The copy that an anchor keeps counts as well: it takes the same memory.
      count(mark, nodes);
      anchors_.insert_or_assign(anchor, Anchored{node, nodes, depth});
    }
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = stack_.back();
    parent.nodes += nodes;
    parent.depth = std::max(parent.depth, depth + 1);
    if (parent.node.is_sequence()) {
      parent.node.items().push_back(std::move(node));
    } else if (!parent.has_key) {
      if (!node.is_scalar()) refuse_key(mark);
      const auto [known, fresh] = parent.lines.emplace(node.text(), node.place().line);
      if (!fresh)
        refuse(mark, "key '" + node.text().substr(0, 60) + "' is given twice",
               "it is already in line " + std::to_string(known->second));
      parent.key = node.text();
      parent.key_place = node.place();
      parent.has_key = true;
    } else {
      parent.node.entries().push_back({std::move(parent.key), std::move(node), parent.key_place});
      parent.has_key = false;
    }
  }

  std::shared_ptr<const std::string> file_;
  TextLimits limits_;
  Node root_;
  std::vector<Open> stack_;
  std::unordered_map<YAML::anchor_t, Anchored> anchors_;
  std::size_t nodes_ = 0;
  int documents_ = 0;
};

}  // namespace

Result<Node> parse_yaml(std::string_view text, const std::string& file, const TextLimits& limits) {
  const auto name = std::make_shared<const std::string>(file);
  if (text.size() > limits.max_bytes)
    return Error{"is too large: " + std::to_string(text.size() >> 20) + " MiB",
                 "at most " + std::to_string(limits.max_bytes >> 20) + " MiB are read",
                 {name}};
  SL_TRY(check_text(text, file));
  SL_TRY(check_flow(text, limits, name));
  Builder builder(name, limits);
  const std::string hidden = hide_variables(text);
  ViewBuffer buffer(hidden);
  std::istream in(&buffer);
  try {
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(builder)) {}
  } catch (const Refused& refused) { return refused.error; } catch (const YAML::Exception& e) {
    const bool known = !e.mark.is_null();
    // What most likely happened: {when: a/laser.ranges[3] < 1}.
    const bool in_flow = e.msg.starts_with("end of map flow") || e.msg.starts_with("end of sequence flow");
    const bool in_block = e.msg == "end of sequence not found" || e.msg == "end of map not found" ||
                          e.msg.starts_with("illegal ");
    // What yaml-cpp says of a character that begins nothing: {when: a/laser.ranges[3] > 1}, seed: @x
    if (e.msg == "unknown token")
      return Error{
          "here begins nothing that YAML knows",
          "within {} and [], a text with brackets or commas needs quotes; everywhere one that begins "
          "with @, `, % or a closing bracket",
          {name, e.mark.line + 1, e.mark.column + 1}};
    if (e.msg.starts_with("the referenced anchor is not defined"))  // newer versions add the name
      return Error{"no anchor of that name stands before this alias",
                   "write &name at the value that *name shall repeat; a text that begins with * needs quotes",
                   {name, e.mark.line + 1, e.mark.column + 1}};
    return Error{show_variables(e.msg),
                 in_flow ? "close the bracket; within {} and [], a text with brackets or commas needs quotes"
                 : in_block ? "indent with blanks, not tabs, and the elements of a list or map equally far; "
                              "a text with ': ' needs quotes"
                            : "",
                 {name, known ? e.mark.line + 1 : 0, known ? e.mark.column + 1 : 0}};
  } catch (const std::exception& e) { return Error{std::string("is not YAML: ") + e.what(), "", {name}}; }
  return builder.take();
}

}  // namespace sandlot
