/// Teams that bring their robots: `software: FOLDER` of a team adds the robots of FOLDER/team.yaml to the scenario.
///
/// A robot is what the scenario gives for the team's robots (key `robot`) with the keys of team.yaml laid over it, both after their variables
/// are replaced: those of the scenario, of team.yaml and of the team, and `number`, `team` and `start`. So one device of team.yaml changes
/// that device only, also where the scenario gives all devices by one variable. Keys of team.yaml keep their place, so that errors name
/// team.yaml, and programs start in the team's folder.
#include <algorithm>

#include "base/read.h"
#include "base/text.h"
#include "files/yaml.h"
#include "formats/scenario/team_spec.h"
#include "formats/scenario/tree.h"

namespace sandlot::formats {
namespace {

using scenario_spec::Team;
using scenario_spec::TeamFile;

struct Read {
  std::string file;
  Node root;
  TeamFile keys;
};

Result<Read> read_team(const std::string& folder) {
  Read out{.file = beside(folder, "team.yaml"), .root = {}, .keys = {}};
  auto text = read_text_file(out.file, TextLimits{}.max_bytes);
  if (!text)
    return Error{"there is no team in '" + folder + "': " + text.error().what,
                 "the folder of a team has a team.yaml"};
  SL_ASSIGN(out.root, parse_yaml(*text, out.file));
  if (!out.root.is_map())
    return out.root.error("the file of a team is a map of keys, found " + describe(out.root),
                          "begin with version: 1");
  SL_ASSIGN(out.keys, read_spec<TeamFile>(out.root));
  const Node& robots = out.keys.robots;
  if (!robots.is_sequence() || robots.items().empty())
    return robots.error("expected a list of robots", "write robots: [{controller: {kind: soccer_player}}]",
                        "/robots");
  for (std::size_t i = 0; i < robots.items().size(); ++i) {
    const Node& robot = robots.items()[i];
    const std::string path = "/robots/" + std::to_string(i);
    if (!robot.is_map()) return robot.error("a robot is a map of keys, found " + describe(robot), "", path);
    for (const char* const key : {"name", "team", "pose", "distribution", "count"})
      if (const Node* const given = robot.find(key))
        return given->error("'" + std::string(key) + "' of a team's robot is given by the scenario",
                            "leave it out", path + "/" + key);
  }
  if (!out.keys.vars.is_null() && !out.keys.vars.is_map())
    return out.keys.vars.error("expected a map: name: value", "", "/vars");
  return out;
}

class TeamRobots {
 public:
  TeamRobots(Node& root, const Node& outer, const Node& team, Team keys, std::string path)
      : root_(root), outer_(outer), team_(team), keys_(std::move(keys)), path_(std::move(path)) {}

  /// @param used  out: names of the scenario's variables that the team uses
  Status add(const Read& software, std::vector<std::string>& used) {
    if (keys_.players > 0 && keys_.starts.items().size() < static_cast<std::size_t>(keys_.players))
      return place_of("starts").error("there are " + std::to_string(keys_.starts.items().size()) +
                                          " poses for " + std::to_string(keys_.players) + " players",
                                      "give one pose for each", path_ + "/starts");
    const std::vector<Node>& given = software.keys.robots.items();
    const int listed = static_cast<int>(given.size());
    int count = keys_.players > 0 ? keys_.players : std::max(software.keys.players, listed);
    if (software.keys.players > 0) count = std::min(count, software.keys.players);
    if (keys_.players > 0 && std::max(listed, software.keys.players) > keys_.players) {
      const Node& at = listed > keys_.players ? given[static_cast<std::size_t>(keys_.players)]
                                              : software.root;
      return at.error("the team brings " + std::to_string(std::max(listed, software.keys.players)) +
                          " robots, and " + std::to_string(keys_.players) + " may play",
                      "leave the others out, or give the match more players", "/robots");
    }
    for (int number = 1; number <= count; ++number) {
      const Node& mine = given[static_cast<std::size_t>(std::min(number, listed) - 1)];
      SL_TRY(add_robot(number, software, mine, used));
    }
    return {};
  }

 private:
  const Node& place_of(const char* key) const {
    const Node* const found = team_.find(key);
    return found ? *found : team_;
  }

  Status add_robot(int number, const Read& software, const Node& mine, std::vector<std::string>& used) {
    const auto index = static_cast<std::size_t>(number - 1);
    const Place& place = mine.place();
    Node vars = Node::map(place);
    if (outer_.is_map()) merge(vars, outer_);
    if (software.keys.vars.is_map()) merge(vars, software.keys.vars);
    if (keys_.vars.is_map()) merge(vars, keys_.vars);
    vars.set("number", Node::scalar(std::to_string(number), place));
    vars.set("team", Node::scalar(keys_.name, place));
    if (index < keys_.starts.items().size()) vars.set("start", keys_.starts.items()[index]);
    Node holder = Node::map(place);
    holder.set("vars", std::move(vars));
    holder.set("robot", keys_.robot.is_map() ? keys_.robot : Node::map(place));
    holder.set("mine", mine);
    std::vector<std::pair<std::string, Place>> unused;
    SL_TRY(substitute_variables(holder, unused));
    for (const Node::Entry& entry : outer_.entries())
      if (std::none_of(unused.begin(), unused.end(),
                       [&](const auto& each) { return each.first == entry.key; }))
        used.push_back(entry.key);

    Node whole = std::move(*holder.find("robot"));
    merge(whole, *holder.find("mine"));
    whole.set_place(place);
    whole.set("name", Node::scalar(keys_.name + std::to_string(number), place));
    whole.set("team", Node::scalar(keys_.name, place));
    if (index < keys_.starts.items().size()) whole.set("pose", keys_.starts.items()[index]);
    Node* robots = root_.find("robots");
    if (!robots || robots->is_null()) robots = &root_.set("robots", Node::sequence(root_.place()));
    if (!robots->is_sequence()) return robots->error("expected a list of robots", "", "/robots");
    robots->push(std::move(whole));
    return {};
  }

  Node& root_;
  const Node& outer_;  ///< variables of the scenario
  const Node& team_;
  Team keys_;
  std::string path_;
};

}  // namespace

Result<TeamSoftware> read_team_software(const std::string& folder) {
  SL_ASSIGN(const Read software, read_team(folder));
  return TeamSoftware{software.file, software.keys.name, software.keys.description};
}

Status add_team_robots(Node& root, const Node& vars, const std::string& file,
                       std::vector<std::pair<std::string, Place>>& unused) {
  const Node* const found = root.is_map() ? root.find("teams") : nullptr;
  if (!found || !found->is_sequence()) return {};
  const Node teams = *found;  // the root is changed below
  for (std::size_t i = 0; i < teams.items().size(); ++i) {
    const Node& team = teams.items()[i];
    const Node* const written = team.is_map() ? team.find("software") : nullptr;
    if (!written) continue;
    const std::string path = "/teams/" + std::to_string(i);
    SL_ASSIGN(Team keys, read_spec<Team>(team, path));
    if (keys.software.empty()) continue;
    const Place& place = written->place();
    const bool in_file = place.file && !starts_with(*place.file, override_place);
    auto software = read_team(beside(folder_of(in_file ? *place.file : file), keys.software));
    if (!software) {
      if (!software.error().place.file) {
        software.error().place = place;
        software.error().path = path + "/software";
      }
      return std::move(software.error());
    }
    std::vector<std::string> used;
    SL_TRY(TeamRobots(root, vars, team, std::move(keys), path).add(*software, used));
    std::erase_if(unused, [&](const auto& each) {
      return std::find(used.begin(), used.end(), each.first) != used.end();
    });
  }
  return {};
}

}  // namespace sandlot::formats
