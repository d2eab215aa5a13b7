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
  }
};

}  // namespace sandlot::formats::scenario_spec
