#include "messages/dynamic.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>
#include <set>

#include "base/text.h"
#include "base/time.h"
#include "messages/cdr.h"
#include "messages/registry.h"

namespace sandlot {
namespace {

using Count = MessageField::Count;
constexpr std::size_t max_text = 1'000'000;
constexpr std::size_t max_types = 1000;
constexpr std::size_t max_fields = 10'000;
constexpr int max_depth = 32;

bool is_name(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !text.empty() && letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}
/// pkg/Type
bool is_type_name(std::string_view text) {
  const auto slash = text.find('/');
  if (const auto rest = text.substr(slash + 1); slash != std::string_view::npos && starts_with(rest, "srv/"))
    return is_name(text.substr(0, slash)) && is_name(rest.substr(4));  // one side of a service
  return slash != std::string_view::npos && is_name(text.substr(0, slash)) && is_name(text.substr(slash + 1));
}

/// What a user may see of a text that may be anything.
std::string shown(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 60 ? "...'" : "'");
}

bool parse_size(std::string_view text, std::size_t& out) {
  const auto end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && stop == end && out <= 0xFFFF'FFFF;
}

/// The primitive of a name; `message` for everything else.
Wire wire_named(std::string_view name) {
  for (int i = 0; i < static_cast<int>(Wire::message); ++i)
    if (name == name_of(static_cast<Wire>(i))) return static_cast<Wire>(i);
  return Wire::message;
}

/// A field whose type is still a name.
struct Open {
  MessageInfo* owner;
  std::size_t field;
  std::string type;
  int line;
};

class SchemaParser {
 public:
  SchemaParser(std::deque<MessageInfo>& types, std::string_view type) : types_(types) {
    types_.emplace_back().name = long_name(type);
    by_name_[short_name(type)] = &types_.front();
  }

  Status run(std::string_view text) {
    if (text.size() > max_text) return error("is longer than 1 MB");
    while (!text.empty()) {
      const auto end = text.find('\n');
      const std::string_view all = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      SL_TRY(line(all));
    }
    if (between_) return error("ends where 'MSG: pkg/Type' should be");
    for (const Open& open : open_) SL_TRY(resolve(open));
    for (MessageInfo& info : types_) SL_TRY(finish(info));
    return {};
  }

 private:
  Error error(std::string what) const {
    return {"schema, line " + std::to_string(line_) + ": " + std::move(what)};
  }

  Status line(std::string_view all) {
    const std::string_view bare = trim(all);
    if (bare.size() >= 3 && bare.find_first_not_of('=') == std::string_view::npos) {
      between_ = true;
      return {};
    }
    if (between_) {
      if (bare.empty()) return {};
      if (!starts_with(bare, "MSG:")) return error(shown(bare) + " where 'MSG: pkg/Type' should be");
      const std::string name = short_name(trim(bare.substr(4)));
      if (!is_type_name(name)) return error(shown(name) + " is not a name of a type");
      if (types_.size() >= max_types) return error("more than 1000 types");
      types_.emplace_back().name = long_name(name);
      repeated_ = !by_name_.emplace(name, &types_.back())
                       .second;  // some writers repeat a type: the first counts
      between_ = false;
      return {};
    }
    // A '#' within the quotes of a constant begins no comment; nothing else that we keep may have one.
    const auto hash = bare.find('#');
    const auto quote = bare.find_first_of("\"'");
    const std::string_view code = hash < quote ? trim(bare.substr(0, hash)) : bare;
    if (code.empty() || repeated_) return {};
    const auto gap = code.find_first_of(" \t");
    if (gap == std::string_view::npos) return error(shown(code) + " is not a field");
    return declaration(code.substr(0, gap), trim(code.substr(gap)));
  }

  Status declaration(std::string_view type, std::string_view rest) {
    if (++fields_ > max_fields) return error("more than 10000 fields");
    MessageInfo& owner = types_.back();
    const auto end = std::min(rest.find_first_of(" \t="), rest.size());
    const std::string_view name = rest.substr(0, end);
    if (!is_name(name)) return error(shown(name) + " is not a name of a field");
    const std::string_view after = trim(rest.substr(end));
    if (!after.empty() && after[0] == '=') {
      const Wire wire = wire_named(type.substr(0, type.find('<')));
      if (wire == Wire::message) return error(shown(type) + " is not a type of a constant");
      owner.constants.push_back({std::string(name), wire, std::string(trim(after.substr(1)))});
      return {};
    }
    if (!names_[&owner].insert(std::string(name)).second) return error("two fields " + shown(name));

    MessageField field;
    field.name = name;
    if (const auto bracket = type.find('['); bracket != std::string_view::npos) {
      std::string_view size = type.substr(bracket + 1);
      type = type.substr(0, bracket);
      if (size.empty() || size.back() != ']') return error("a list without ']'");
      size.remove_suffix(1);
      field.count = size.empty() || starts_with(size, "<=") ? Count::sequence : Count::array;
      if (starts_with(size, "<=")) size.remove_prefix(2);
      if (!size.empty() && (!parse_size(size, field.length) || field.length == 0))
        return error(shown(size) + " is not a length of a list");
    }
    if (const auto bound = type.find("<="); bound != std::string_view::npos) {
      std::size_t length = 0;
      if (type.substr(0, bound) != "string" || !parse_size(type.substr(bound + 2), length))
        return error(shown(type) + " is not a bounded string");
      type = type.substr(0, bound);
    }
    if (type == "wstring" || type == "wchar") return error("wide strings are not supported");
    field.type = wire_named(type);
    owner.fields.push_back(std::move(field));
    if (owner.fields.back().type == Wire::message)
      open_.push_back({&owner, owner.fields.size() - 1, full_name(type, owner), line_});
    return {};
  }

  /// pkg/Type of what a field calls its type.
  static std::string full_name(std::string_view type, const MessageInfo& owner) {
    if (type == "time" || type == "builtin_interfaces/Time") return "builtin_interfaces/Time";
    if (type == "duration") return "builtin_interfaces/Duration";
    if (type == "Header") return "std_msgs/Header";
    if (type.find('/') != std::string_view::npos) return short_name(type);
    return std::string(first_part(owner.name)) + "/" + std::string(type);
  }

  Status resolve(const Open& open) {
    line_ = open.line;
    MessageField& field = open.owner->fields[open.field];
    const auto found = by_name_.find(open.type);
    if (found != by_name_.end()) {
      field.message = found->second;
      return {};
    }
    const auto ours = is_type_name(open.type) ? find_message(open.type) : Result<const MessageInfo*>(nullptr);
    if (!ours || !*ours) return error("type " + shown(open.type) + " is not in the schema");
    field.message = *ours;
    return {};
  }

  /// Works out `least` from the innermost type outwards; an error when there is none, as types contain themselves.
  Status finish(MessageInfo& info) {
    int& height = heights_[&info];
    if (height > 0) return {};
    if (height < 0) return Error{"schema: " + shown(info.name) + " contains itself"};
    height = -1;
    int below = 0;
    for (const MessageField& field : info.fields) {
      const auto own = field.message ? by_name_.find(short_name(field.message->name)) : by_name_.end();
      if (own == by_name_.end() || own->second != field.message) continue;
      SL_TRY(finish(*own->second));
      below = std::max(below, heights_[own->second]);
    }
    if (below >= max_depth) return Error{"schema: types nest deeper than 32 in " + shown(info.name)};
    set_derived(info);
    height = below + 1;
    return {};
  }

  std::deque<MessageInfo>& types_;
  std::map<std::string, MessageInfo*, std::less<>> by_name_;
  std::map<const MessageInfo*, std::set<std::string>> names_;  // of the fields of each type
  std::map<const MessageInfo*, int>
      heights_;  // levels of a type; -1: being worked out. References to values stay
  std::vector<Open> open_;
  std::size_t fields_ = 0;
  int line_ = 0;
  bool between_ = false;   ///< after a line of '='
  bool repeated_ = false;  ///< within a type that was there before
};

template <class T>
T value_as(const std::byte* value) {
  T number;
  std::memcpy(&number, value, sizeof number);
  return number;
}

MessageValue to_value(Wire type, const std::byte* value) {
  switch (type) {
    case Wire::boolean: return *value != std::byte{0};
    case Wire::int8: return static_cast<std::int64_t>(value_as<std::int8_t>(value));
    case Wire::int16: return static_cast<std::int64_t>(value_as<std::int16_t>(value));
    case Wire::int32: return static_cast<std::int64_t>(value_as<std::int32_t>(value));
    case Wire::int64: return value_as<std::int64_t>(value);
    case Wire::byte:
    case Wire::character:
    case Wire::uint8: return static_cast<std::uint64_t>(value_as<std::uint8_t>(value));
    case Wire::uint16: return static_cast<std::uint64_t>(value_as<std::uint16_t>(value));
    case Wire::uint32: return static_cast<std::uint64_t>(value_as<std::uint32_t>(value));
    case Wire::uint64: return value_as<std::uint64_t>(value);
    case Wire::float32: return static_cast<double>(value_as<float>(value));
    default: return value_as<double>(value);
  }
}

/// Keeps the path of what is visited; a level is a message or a list.
class PathVisitor : public CdrVisitor {
 public:
  using Visit = std::function<void(std::string_view, const MessageValue&)>;
  explicit PathVisitor(const Visit& visit) : visit_(visit) {}
  void open(const MessageInfo& info) override {
    element();
    in_time_ = !levels_.empty() && is_time(info);
    levels_.push_back({path_.size(), false, 0});
  }
  void close() override {
    leave();
    if (in_time_) visit_(path_, Time{sec_ * Time::per_s + nanosec_}.s());
    in_time_ = false;
  }
  void field(const MessageField& field) override {
    path_.resize(levels_.back().size);
    if (!path_.empty()) path_ += '.';
    path_ += field.name;
  }
  void open_list(std::size_t) override { levels_.push_back({path_.size(), true, 0}); }
  void close_list() override { leave(); }
  void text(std::string_view text) override {
    element();
    visit_(path_, text);
  }
  void number(Wire type, const std::byte* value) override {
    if (!in_time_) return visit_(path_, to_value(type, value));
    if (type == Wire::int32) sec_ = value_as<std::int32_t>(value);
    else nanosec_ = value_as<std::uint32_t>(value);
  }
  void numbers(Wire type, std::span<const std::byte> bytes) override {
    open_list(0);
    for (std::size_t i = 0; i < bytes.size(); i += size_of(type)) {
      element();
      visit_(path_, to_value(type, &bytes[i]));
    }
    leave();
  }

 private:
  struct Level {
    std::size_t size;  ///< of the path to it
    bool list;
    std::size_t next;  ///< element of a list
  };
  /// In a list: the path of its next element.
  void element() {
    if (levels_.empty() || !levels_.back().list) return;
    path_.resize(levels_.back().size);
    path_ += "[" + std::to_string(levels_.back().next++) + "]";
  }
  void leave() {
    path_.resize(levels_.back().size);
    levels_.pop_back();
  }
  /// One value to its readers, here as among the addresses of a run. A schema may call anything so: it must look so.
  static bool is_time(const MessageInfo& info) {
    return (info.name == "builtin_interfaces/msg/Time" || info.name == "builtin_interfaces/msg/Duration") &&
           info.fields.size() == 2 && info.fields[0].type == Wire::int32 &&
           info.fields[1].type == Wire::uint32 && info.fields[0].count == Count::one &&
           info.fields[1].count == Count::one;
  }
  const Visit& visit_;
  bool in_time_ = false;
  std::int64_t sec_ = 0, nanosec_ = 0;
  std::string path_;
  std::vector<Level> levels_;
};

}  // namespace

Result<DynamicSchema> DynamicSchema::parse(std::string_view type, std::string_view text) {
  if (!is_type_name(short_name(type))) return Error{shown(type) + " is not a name of a message type"};
  DynamicSchema schema;
  SL_TRY(SchemaParser(schema.types_, type).run(text));
  schema.types_.front().schema = text;
  return schema;
}

Status visit_values(const MessageInfo& info, std::span<const std::byte> cdr,
                    const std::function<void(std::string_view, const MessageValue&)>& visit) {
  PathVisitor visitor(visit);
  return walk_cdr(info, cdr, visitor);
}

}  // namespace sandlot
