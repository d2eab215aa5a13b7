#include "app/tokens.h"

#include <sys/stat.h>

#include <algorithm>

#include "base/log.h"
#include "base/read.h"
#include "files/text.h"
#include "files/yaml.h"

namespace sandlot::app {
namespace {

constexpr std::size_t most_bytes = 1u << 20;

enum class Level : std::uint8_t { none, admin, spectator };
inline std::span<const EnumName<Level>> enum_names(Level) {
  static constexpr EnumName<Level> names[] = {{"admin", Level::admin}, {"spectator", Level::spectator}};
  return names;
}

struct Entry {
  std::string token, robot, team;
  std::optional<Level> role;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"token", "", "Secret word; left out for spectators: everybody may look on.", 0, 0,
                Field::none, 1000},
          s.token);
    visit(Field{"role", "", "What it opens, where that is neither a robot nor a team."}, s.role);
    visit(Field{"robot", "", "Robot that its bearer drives.", 0, 0, Field::none, 1000}, s.robot);
    visit(Field{"team", "", "Team whose robots its bearer drives.", 0, 0, Field::none, 1000}, s.team);
  }
};

}  // namespace

Result<std::vector<server::Token>> read_tokens(const std::string& text, const std::string& file) {
  SL_ASSIGN(const Node root, parse_yaml(text, file, {.max_bytes = most_bytes, .max_nodes = 100'000}));
  if (!root.is_sequence())
    return root.error("expected a list of tokens", "write - {token: WORD, team: red}, an entry per line");
  std::vector<server::Token> out;
  for (const Node& node : root.items()) {
    SL_ASSIGN(const Entry entry, read_spec<Entry>(node));
    const int opened = static_cast<int>(entry.role.has_value()) + !entry.robot.empty() + !entry.team.empty();
    if (opened != 1)
      return node.error(opened == 0 ? "the token opens nothing" : "the token opens several things",
                        "give one of role, robot, team");
    const bool everybody = entry.token.empty() && entry.role == Level::spectator;
    if (entry.token.size() < least_token && !everybody)
      return node.error("the token is shorter than " + std::to_string(least_token) + " characters",
                        "openssl rand -hex 16 makes a good one");
    if (std::any_of(out.begin(), out.end(), [&](const auto& each) { return each.secret == entry.token; }))
      return node.error("the token is given twice", "give each bearer one of its own");
    server::Token& made = out.emplace_back();
    made.secret = entry.token;
    if (entry.role)
      made.access.role = *entry.role == Level::admin ? server::Role::admin : server::Role::spectator;
    else made.access.role = entry.robot.empty() ? server::Role::team : server::Role::robot;
    made.access.name = entry.robot.empty() ? entry.team : entry.robot;
  }
  return out;
}

Result<std::vector<server::Token>> load_tokens(const std::string& file) {
  SL_ASSIGN(const std::string text, read_text_file(file, most_bytes));
  struct stat info {};
  if (stat(file.c_str(), &info) == 0 && (info.st_mode & (S_IRGRP | S_IROTH)) != 0)
    log::warning(file + ": other users can read the tokens; chmod 600 keeps them secret");
  return read_tokens(text, file);
}

}  // namespace sandlot::app
