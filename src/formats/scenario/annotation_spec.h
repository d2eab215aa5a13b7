#pragma once
/// Keys of what a scenario says to remote programs: named poses and shared topics.
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "model/annotations.h"

namespace sandlot::formats::scenario_spec {

struct NamedPose {
  std::string name;
  Node pose;
  std::string description;
  std::vector<std::string> tags;
  std::optional<Vec3> size_m;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the pose; unique.", 0, 0, Field::required, 100}, s.name);
    visit(
        Field{"pose", "m", "Pose in the world, in the same forms as that of a robot.", 0, 0, Field::required},
        s.pose);
    visit(Field{"description", "", "Description for people.", 0, 0, Field::none, 1000}, s.description);
    visit(Field{"tags", "", "Tags, by which other programs find it: spawn, parking, goal.", 0, 0, Field::none,
                100},
          s.tags);
    visit(Field{"size", "m", "Free box about the pose, along its axes: x y z.", 1e-3, 1e4}, s.size_m);
  }
};

struct Share {
  model::Sharing sharing;  ///< spectators
  std::vector<std::string> topics;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"topics", "",
                "Topics that robots' and teams' clients see, too: names, or beginnings with a * behind.", 0,
                0, Field::none, 1000},
          s.topics);
    visit(
        Field{"spectators", "",
              "What spectators see. world: everything that the page shows; topics: the shared topics alone."},
        s.sharing.spectators);
  }
};

}  // namespace sandlot::formats::scenario_spec
