#pragma once
/// Keys of a team in a scenario.
#include <string>

#include "base/fields.h"
#include "base/node.h"

namespace sandlot::formats::scenario_spec {

struct Team {
  std::string name;
  Node controller;
  Node controllers;
  Node criterion;
  std::string software;
  int players = 0;
  Node robot;
  Node starts;
  Node vars;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the team; robots name it as their team.", 0, 0, Field::required, 100},
          s.name);
    visit(
        Field{"controller", "",
              "Kind of the team's controller, which drives all its robots, or a map with kind and the kind's "
              "keys."},
        s.controller);
    visit(Field{"controllers", "",
                "Several controllers of the team: a list of maps with name, kind and the kind's keys."},
          s.controllers);
    visit(Field{"criterion", "",
                "What the team is judged by: an expression over addresses, or a map with value and success."},
          s.criterion);
    visit(
        Field{
            "software", "",
            "Folder with a team.yaml that brings the team's robots and their controllers; none if left out."},
        s.software);
    visit(Field{"players", "1",
                "Number of robots that the team's software may bring; 0: as many as it has in its list.", 0,
                100},
          s.players);
    visit(
        Field{"robot", "",
              "Keys of each robot that the team's software brings; the keys of its team.yaml lie upon them."},
        s.robot);
    visit(Field{"starts", "", "Poses of the robots that the team's software brings, by number."}, s.starts);
    visit(Field{"vars", "",
                "Variables of the team's software and of the key robot, written as $${name} there."},
          s.vars);
  }
};

/// A team.yaml: the software of a team.
struct TeamFile {
  int version = 1;
  std::string name, description;
  Node vars, robots;
  int players = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"version", "", "Version of the format.", 1, 1}, s.version);
    visit(Field{"name", "", "Name of the team's software, as results show it.", 0, 0, Field::required, 100},
          s.name);
    visit(Field{"description", "", "Description of the team in a sentence."}, s.description);
    visit(Field{"vars", "", "Variables of this file: name: value, used as ${name}."}, s.vars);
    visit(
        Field{
            "robots", "",
            "Robots by number: what a scenario says of a robot, but for name, team and pose. The last one of "
            "the list stands for all further numbers.",
            0, 0, Field::required},
        s.robots);
    visit(
        Field{"players", "1", "Number of robots that the team brings at most; 0: as many as it may.", 0, 100},
        s.players);
  }
};

}  // namespace sandlot::formats::scenario_spec
