#include "server/refbox/teams.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "base/text.h"

namespace sandlot::server {
namespace {

using refbox::Side;

constexpr const char* teams_option = "--refbox-teams: ";
constexpr const char* teams_example = "write cyan=127.0.0.2,magenta=172.16.39.*";

/// One part of an address: a number up to 255. Nothing: it is none.
std::optional<int> part_of(std::string_view text) {
  int out = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, out);
  if (read.ec != std::errc() || read.ptr != end || out < 0 || out > 255) return std::nullopt;
  return out;
}

/// Four numbers with points between them, or such a beginning with `*` for the rest.
bool is_pattern(std::string_view text) {
  if (text == "*" || text == "::1") return true;
  const auto parts = split(text, '.');
  if (parts.size() != 4) return false;
  bool open = false;
  for (const std::string_view part : parts) {
    if (part == "*") open = true;
    else if (open || !part_of(part)) return false;
  }
  return true;
}

/// The address by which the league names a team: of 172.16.39.* it is 224.16.32.39. Nothing: there is none.
std::optional<std::string> league_id(std::string_view pattern) {
  const auto parts = split(pattern, '.');
  if (parts.size() != 4 || parts[0] != "172" || parts[1] != "16" || parts[2] == "*") return std::nullopt;
  return "224.16.32." + std::string(parts[2]);
}

Status read_team(std::string_view entry, RefboxTeams& out, std::array<bool, 2>& named) {
  const auto equals = entry.find('=');
  if (equals == std::string_view::npos)
    return Error{teams_option + ("'" + std::string(entry)) + "' names no address", teams_example};
  const auto side = refbox::side_of(trim(entry.substr(0, equals)));
  if (!side || *side == Side::both)
    return Error{teams_option + ("'" + std::string(entry)) + "' begins with no team", teams_example};
  const std::size_t index = *side == Side::cyan ? 0 : 1;
  if (std::exchange(named[index], true))
    return Error{teams_option + std::string(name_of(*side)) + " is there twice", teams_example};
  std::string_view pattern = trim(entry.substr(equals + 1));
  std::string& id = index == 0 ? out.ids.cyan : out.ids.magenta;
  if (const auto at = pattern.find('@'); at != std::string_view::npos) {
    id = std::string(trim(pattern.substr(at + 1)));
    pattern = trim(pattern.substr(0, at));
    if (!is_pattern(id) || id.find('*') != std::string::npos)
      return Error{teams_option + ("'" + id) + "' is not a multicast address", "such as 224.16.32.39"};
  } else if (const auto of_league = league_id(pattern)) {
    id = *of_league;
  }
  if (!is_pattern(pattern))
    return Error{teams_option + ("'" + std::string(pattern)) + "' is neither an address nor a pattern",
                 teams_example};
  out.all[index].pattern = std::string(pattern);
  return {};
}

Status read_protocol(std::string_view text, refbox::Protocol& out) {
  for (const auto each : {refbox::Protocol::json, refbox::Protocol::bytes_2009})
    if (text == name_of(each)) {
      out = each;
      return {};
    }
  return Error{"--refbox-protocol: '" + std::string(text) + "' is neither json nor 2009",
               "write json, 2009 or cyan=2009,magenta=json"};
}

}  // namespace

bool address_matches(std::string_view address, std::string_view pattern) {
  if (pattern == "*" || address == pattern) return true;
  const auto wanted = split(pattern, '.'), given = split(address, '.');
  if (wanted.size() != given.size()) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i] != "*" && wanted[i] != given[i]) return false;
  return true;
}

Result<RefboxTeams> read_refbox_teams(std::string_view teams, std::string_view protocols) {
  RefboxTeams out;
  std::array<bool, 2> named{};
  if (!trim(teams).empty()) {
    for (const std::string_view entry : split(teams, ',')) SL_TRY(read_team(trim(entry), out, named));
    // A team of which nothing is said is whoever comes, unless he is the other one's.
    if (!named[0] || !named[1])
      return Error{teams_option + std::string(named[0] ? "magenta" : "cyan") + " is missing", teams_example};
  }
  // A team that plays against itself: the league's box adds a mark to the name of the left one.
  if (out.ids.cyan == out.ids.magenta) out.ids.cyan += ":1";
  for (const std::string_view entry : split(trim(protocols), ',')) {
    if (trim(entry).empty()) continue;
    const auto equals = entry.find('=');
    if (equals == std::string_view::npos) {
      for (RefboxTeam& team : out.all) SL_TRY(read_protocol(trim(entry), team.protocol));
      continue;
    }
    const auto side = refbox::side_of(trim(entry.substr(0, equals)));
    if (!side || *side == Side::both)
      return Error{"--refbox-protocol: '" + std::string(entry) + "' begins with no team",
                   "write json, 2009 or cyan=2009,magenta=json"};
    SL_TRY(read_protocol(trim(entry.substr(equals + 1)), out.all[*side == Side::cyan ? 0 : 1].protocol));
  }
  return out;
}

}  // namespace sandlot::server
