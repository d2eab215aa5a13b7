#pragma once
/// What a scenario says about its world to people and remote programs: kinds of entities, named poses, shared topics. Neither
/// devices nor programs read it, so that it changes no run.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "geometry/pose.h"

namespace sandlot::model {

/// What an entity is to people; categories of simulation_interfaces.
enum class Category : std::uint8_t { automatic, object, robot, human, dynamic_object, static_object };
inline std::span<const EnumName<Category>> enum_names(Category) {
  static constexpr EnumName<Category> names[] = {{"automatic", Category::automatic},
                                                 {"object", Category::object},
                                                 {"robot", Category::robot},
                                                 {"human", Category::human},
                                                 {"dynamic", Category::dynamic_object},
                                                 {"static", Category::static_object}};
  return names;
}

struct EntityInfo {
  Category category = Category::automatic;  ///< automatic: robot, static or dynamic, as it is built
  std::string description;
  std::vector<std::string> tags;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"category", "",
                "Category for other programs: object, robot, human, dynamic or static; automatic: as it is "
                "built."},
          s.category);
    visit(Field{"description", "", "Description for people.", 0, 0, Field::none, 1000}, s.description);
    visit(Field{"tags", "", "Tags, by which other programs find it.", 0, 0, Field::none, 100}, s.tags);
  }
};

/// A pose of the world that has a name: a starting place, a parking place, a goal.
struct NamedPose {
  std::string name;
  Pose X_WP;
  std::string description;
  std::vector<std::string> tags;
  std::optional<Vec3> size_m;  ///< free box about the pose, along its axes

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the pose; unique."}, s.name);
    visit(Field{"pose", "", "Pose in the world."}, s.X_WP);
    visit(Field{"description", "", "Description for people."}, s.description);
    visit(Field{"tags", "", "Tags, by which other programs find it."}, s.tags);
    visit(Field{"size", "m", "Size of the free box about the pose."}, s.size_m);
  }
};

/// Topics of the server that no device publishes.
inline constexpr std::string_view world_topics[] = {"/tf",
                                                    "/tf_static",
                                                    "/clock",
                                                    "/sandlot/step_times",
                                                    "/rosout",
                                                    "/sandlot/world",
                                                    "/sandlot/poses",
                                                    "/sandlot/status",
                                                    "/sandlot/contacts",
                                                    "/sandlot/deliveries",
                                                    "/sandlot/batteries",
                                                    "/sandlot/clients"};
/// Of the server, and never shared: what others command is theirs.
inline constexpr std::string_view commands_topic = "/sandlot/commands";

/// A topic, or all that begin with the letters before a `*`.
struct SharedTopic {
  std::string pattern;
  Place place;

  bool fits(std::string_view topic) const {
    if (topic == commands_topic) return false;
    const std::string_view text = pattern;
    if (text.empty() || text.back() != '*') return topic == text;
    return topic.substr(0, text.size() - 1) == text.substr(0, text.size() - 1);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"pattern", "", "Name of a topic, or its beginning and *."}, s.pattern);
  }
};

/// What clients see that are no administrators, besides what is theirs.
struct Sharing {
  enum class Spectators : std::uint8_t { world, topics } spectators = Spectators::world;
  std::vector<SharedTopic> topics;

  bool has(std::string_view topic) const {
    return std::any_of(topics.begin(), topics.end(),
                       [&](const SharedTopic& each) { return each.fits(topic); });
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"spectators", "", "Sight of spectators."}, s.spectators);
    visit(Field{"topics", "", "Topics that all clients see."}, s.topics);
  }
};
inline std::span<const EnumName<Sharing::Spectators>> enum_names(Sharing::Spectators) {
  using Spectators = Sharing::Spectators;
  static constexpr EnumName<Spectators> names[] = {{"world", Spectators::world},
                                                   {"topics", Spectators::topics}};
  return names;
}

}  // namespace sandlot::model
