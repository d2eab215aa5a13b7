#include "wire/refbox.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/json_writer.h"
#include "wire/bounded_json.h"

namespace sandlot::refbox {
namespace {

using Json = nlohmann::json;

// The bytes are those that base stations of 2009 know; the box of 2015 writes U and u for the test mode, which they do not.
// clang-format off
constexpr WordInfo all_words[] = {
    {"START",                's', 0,   false, false},
    {"STOP",                 'S', 0,   false, false},
    {"DROP_BALL",            'N', 0,   false, false},
    {"HALF_TIME",            'h', 0,   false, false},
    {"END_PART",             0,   0,   false, false},
    {"END_GAME",             'e', 0,   false, false},
    {"GAMEOVER",             'z', 0,   false, false},
    {"PARK",                 'L', 0,   false, false},
    {"FIRST_HALF",           '1', 0,   false, false},
    {"SECOND_HALF",          '2', 0,   false, false},
    {"FIRST_HALF_OVERTIME",  '3', 0,   false, false},
    {"SECOND_HALF_OVERTIME", '4', 0,   false, false},
    {"RESET",                'Z', 0,   false, false},
    {"WELCOME",              'W', 0,   false, false},
    {"TESTMODE_ON",          'V', 0,   false, false},
    {"TESTMODE_OFF",         'v', 0,   false, false},
    {"KICKOFF",              'K', 'k', false, true},
    {"FREEKICK",             'F', 'f', false, true},
    {"GOALKICK",             'G', 'g', false, true},
    {"THROWIN",              'T', 't', false, true},
    {"CORNER",               'C', 'c', false, true},
    {"PENALTY",              'P', 'p', false, true},
    {"GOAL",                 'A', 'a', false, true},
    {"SUBGOAL",              'D', 'd', false, true},
    {"REPAIR",               'O', 'o', false, true},
    {"REPAIR_END",           'I', 'i', false, true},
    {"YELLOW_CARD",          'Y', 'y', false, true},
    {"DOUBLE_YELLOW",        'B', 'b', false, true},
    {"RED_CARD",             'R', 'r', false, true},
    {"SUBSTITUTION",         0,   0,   true,  true},
    {"IS_ALIVE",             0,   0,   true,  true},
};
// clang-format on

/// The word in the league's list. Errors: it has none such, or not for those it is for.
Result<const WordInfo*> judge(const Word& word) {
  const WordInfo* const info = find_word(word.command);
  if (!info)
    return Error{"the league's referee box has no word " + wire::shown(word.command),
                 "such as STOP, KICKOFF, START"};
  if (info->of_team && word.side == Side::both)
    return Error{word.command + " is said of one team, but none is named"};
  if (word.robot < 0 || word.robot > most_robot)
    return Error{word.command + " names robot " + std::to_string(word.robot),
                 "a number from 1 to " + std::to_string(most_robot)};
  return info;
}

/// Writes null for numbers that JSON does not have: NaN, Infinity, -Infinity, as some languages write them, and those beyond the
/// range of double. @return whether there were any
bool replace_wrong_numbers(std::string& text) {
  std::string out;
  bool quoted = false, found = false;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (quoted) {
      const std::size_t taken = c == '\\' && i + 1 < text.size() ? 2 : 1;
      if (c == '"') quoted = false;
      out.append(text, i, taken);
      i += taken;
      continue;
    }
    if (c == '"') quoted = true;
    const bool begins = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
                        (c >= '0' && c <= '9');
    if (!begins) {
      out += c;
      ++i;
      continue;
    }
    std::size_t end = i;
    const auto belongs = [](char d) {
      return (d >= 'a' && d <= 'z') || (d >= 'A' && d <= 'Z') || (d >= '0' && d <= '9') || d == '+' ||
             d == '-' || d == '.';
    };
    while (end < text.size() && belongs(text[end])) ++end;
    const std::string token = text.substr(i, end - i);
    std::string lower;
    for (const char d : token) lower += static_cast<char>(d >= 'A' && d <= 'Z' ? d - 'A' + 'a' : d);
    const std::string_view word = lower.front() == '-' ? std::string_view(lower).substr(1) : lower;
    const bool infinite = word == "nan" || word == "inf" || word == "infinity" || word == "1.#inf" ||
                          word == "1.#qnan";
    const bool too_large = !word.empty() && word.front() >= '0' && word.front() <= '9' &&
                           Json::parse(token, nullptr, false).is_discarded() &&
                           word.find('e') != std::string_view::npos &&
                           word.find_first_not_of("0123456789.e+-") == std::string_view::npos;
    if (infinite || too_large) found = true;
    out += infinite || too_large ? "null" : token;
    i = end;
  }
  text = std::move(out);
  return found;
}

/// A number of a list or entry. @param where  "robots[2].pose[0]"
Status read_count(const Json& value, const std::string& where, double& out) {
  constexpr double most = 1e6;
  if (value.is_null()) return Error{where + " is not a finite number", "leave out what is not known"};
  if (!value.is_number()) return Error{where + " is not a number"};
  out = value.get<double>();
  if (!std::isfinite(out) || std::abs(out) > most)
    return Error{where + " is not within a million", "metres, radians and their like"};
  return {};
}

/// A list of at most three numbers; none where the key is not there.
Status read_three(const Json& entry, const char* key, const std::string& where, std::array<double, 3>& out) {
  const auto found = entry.find(key);
  if (found == entry.end() || found->is_null()) return {};
  const std::string at = where + "." + key;
  if (!found->is_array() || found->size() > out.size())
    return Error{at + " is not a list of at most three numbers"};
  for (std::size_t i = 0; i < found->size(); ++i)
    SL_TRY(read_count((*found)[i], at + "[" + std::to_string(i) + "]", out[i]));
  return {};
}

Result<const Json*> list_of(const Json& document, const char* key) {
  const auto found = document.find(key);
  if (found == document.end() || !found->is_array())
    return Error{"a world state without a list '" + std::string(key) + "'"};
  if (found->size() > most_entries)
    return Error{"'" + std::string(key) + "' has " + std::to_string(found->size()) + " entries",
                 "at most " + std::to_string(most_entries)};
  for (std::size_t i = 0; i < found->size(); ++i)
    if (!(*found)[i].is_object())
      return Error{std::string(key) + "[" + std::to_string(i) + "] is not an object"};
  return &*found;
}

Result<std::string> text_of(const Json& document, const char* key) {
  constexpr std::size_t most = 1000;
  const auto found = document.find(key);
  if (found == document.end() || !found->is_string())
    return Error{"a world state without a text '" + std::string(key) + "'"};
  auto text = found->get<std::string>();
  if (text.size() > most)
    return Error{"'" + std::string(key) + "' has " + std::to_string(text.size()) + " bytes",
                 "at most " + std::to_string(most)};
  return text;
}

Status read_points(const Json& document, const char* key, std::vector<PointReport>& out) {
  SL_ASSIGN(const Json* const list, list_of(document, key));
  for (const Json& entry : *list) {
    const std::string where = std::string(key) + "[" + std::to_string(out.size()) + "]";
    PointReport point;
    std::array<double, 3> velocity{};
    SL_TRY(read_three(entry, "position", where, point.position));
    SL_TRY(read_three(entry, "velocity", where, velocity));
    out.push_back(point);
  }
  return {};
}

Status read_robots(const Json& document, std::vector<RobotReport>& out) {
  SL_ASSIGN(const Json* const list, list_of(document, "robots"));
  for (const Json& entry : *list) {
    const std::string where = "robots[" + std::to_string(out.size()) + "]";
    RobotReport robot;
    std::array<double, 3> target{};
    if (const auto id = entry.find("id"); id != entry.end()) {
      double number = 0;
      SL_TRY(read_count(*id, where + ".id", number));
      robot.id = static_cast<std::int32_t>(number);
    }
    SL_TRY(read_three(entry, "pose", where, robot.pose));
    SL_TRY(read_three(entry, "targetPose", where, target));
    SL_TRY(read_three(entry, "velocity", where, robot.velocity));
    if (const auto engaged = entry.find("ballEngaged"); engaged != entry.end())
      robot.ball_engaged = (engaged->is_boolean() && engaged->get<bool>()) ||
                           (engaged->is_number() && engaged->get<double>() > 0);
    out.push_back(robot);
  }
  return {};
}

}  // namespace

const char* name_of(Protocol protocol) { return protocol == Protocol::json ? "json" : "2009"; }

const char* name_of(Side side) {
  return side == Side::cyan ? "cyan" : side == Side::magenta ? "magenta" : "";
}

Result<Side> side_of(std::string_view team) {
  for (const Side side : {Side::both, Side::cyan, Side::magenta})
    if (team == name_of(side)) return side;
  return Error{"no team " + wire::shown(team), "cyan or magenta"};
}

std::span<const WordInfo> words() { return all_words; }

const WordInfo* find_word(std::string_view command) {
  const auto* const found = std::find_if(std::begin(all_words), std::end(all_words),
                                         [&](const WordInfo& each) { return each.command == command; });
  return found == std::end(all_words) ? nullptr : found;
}

Result<char> byte_of(const Word& word) {
  SL_ASSIGN(const WordInfo* const info, judge(word));
  if (info->cyan == 0) return Error{"the protocol of 2009 has no byte for " + word.command};
  return word.side == Side::magenta && info->magenta != 0 ? info->magenta : info->cyan;
}

std::optional<Word> word_of(char byte) {
  if (byte == 0) return std::nullopt;
  for (const WordInfo& each : all_words) {
    if (each.cyan == byte) return Word{std::string(each.command), each.of_team ? Side::cyan : Side::both, 0};
    if (each.magenta == byte) return Word{std::string(each.command), Side::magenta, 0};
  }
  return std::nullopt;
}

Result<std::string> json_of(const Word& word, const TeamIds& ids) {
  SL_ASSIGN(const WordInfo* const info, judge(word));
  std::string out;
  JsonWriter w(out);
  w.object([&] {
    w.key("command").text(word.command);
    w.key("targetTeam")
        .text(word.side == Side::cyan      ? ids.cyan
              : word.side == Side::magenta ? ids.magenta
                                           : "");
    if (info->names_robot && word.robot > 0) w.key("robotID").integer(word.robot);
  });
  out += '\0';
  return out;
}

Result<Word> read_json(std::string_view text, const TeamIds& ids) {
  SL_ASSIGN(const Json document, wire::read_object(text, {.bytes = 4096, .depth = 4, .values = 64}));
  const auto command = document.find("command"), target = document.find("targetTeam"),
             robot = document.find("robotID");
  if (command == document.end() || !command->is_string()) return Error{"a command without a text 'command'"};
  if (target == document.end() || !target->is_string()) return Error{"a command without a text 'targetTeam'"};
  Word out{.command = command->get<std::string>()};
  const auto team = target->get<std::string>();
  if (team == ids.cyan) out.side = Side::cyan;
  else if (team == ids.magenta) out.side = Side::magenta;
  else if (!team.empty()) return Error{"no team has the address " + wire::shown(team)};
  if (robot != document.end()) {
    double number = 0;
    SL_TRY(read_count(*robot, "robotID", number));
    out.robot = static_cast<std::int32_t>(number);
  }
  SL_TRY(judge(out));
  return out;
}

Result<std::string> encode(const Word& word, Protocol protocol, const TeamIds& ids) {
  if (protocol == Protocol::json) return json_of(word, ids);
  SL_ASSIGN(const char byte, byte_of(word));
  return std::string(1, byte);
}

Result<WorldState> read_world_state(std::string_view text) {
  const wire::JsonLimits limits{.bytes = most_bytes, .depth = 8, .values = 20'000};
  Result<Json> document = wire::read_object(text, limits);
  bool wrong_numbers = false;
  if (!document && text.size() <= limits.bytes) {
    // Languages that write NaN into JSON are common. The message is refused, by the name of the number.
    std::string replaced(text);
    wrong_numbers = replace_wrong_numbers(replaced);
    if (wrong_numbers) document = wire::read_object(replaced, limits);
  }
  if (!document) return document.error();
  const auto type = document->find("type");
  if (type == document->end() || !type->is_string()) return Error{"a message without a text 'type'"};
  if (*type != "worldstate")
    return Error{"a message of type " + wire::shown(type->get<std::string>()), "worldstate"};
  WorldState out;
  SL_ASSIGN(out.team, text_of(*document, "teamName"));
  SL_ASSIGN(out.intention, text_of(*document, "intention"));
  const auto age = document->find("ageMs");
  double age_ms = 0;
  if (age == document->end()) return Error{"a world state without a number 'ageMs'"};
  SL_TRY(read_count(*age, "ageMs", age_ms));
  out.age_ms = static_cast<std::int32_t>(age_ms);
  SL_TRY(read_robots(*document, out.robots));
  SL_TRY(read_points(*document, "balls", out.balls));
  SL_TRY(read_points(*document, "obstacles", out.obstacles));
  if (wrong_numbers) return Error{"a number that is NaN or infinite", "leave out what is not known"};
  return out;
}

Result<std::optional<std::string_view>> MessageStream::next() {
  while (true) {
    const std::size_t end = buffer_.find('\0', searched_);
    if (end == std::string::npos) {
      buffer_.erase(
          0, taken_);  // once for all messages of a piece: a flood of short ones costs no more than its bytes
      taken_ = 0;
      searched_ = buffer_.size();
      if (buffer_.size() > most_bytes)
        return Error{"more than " + std::to_string(most_bytes) + " bytes without a NUL",
                     "end each message with a NUL"};
      return std::optional<std::string_view>();
    }
    const std::size_t begin = std::exchange(taken_, end + 1);
    searched_ = end + 1;
    if (end - begin > most_bytes)
      return Error{"more than " + std::to_string(most_bytes) + " bytes without a NUL",
                   "end each message with a NUL"};
    if (end > begin) return std::optional(std::string_view(buffer_).substr(begin, end - begin));
  }
}

}  // namespace sandlot::refbox
