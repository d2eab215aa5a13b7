#pragma once
/// Access: what a client may see and do.
///
///   admin      everything
///   spectator  sees everything that viewers see, or the shared topics alone, as the scenario has it; changes nothing
///   robot      sees the topics of its robot and those that are shared; commands its robot
///   team       the same for the robots of its team
///   guest      sees the time; may claim a robot or a team with its token
///
/// What robots and teams do not see: poses, /tf, contacts, the world, values, parameters, commands and topics of others; but
/// for topics that the scenario shares by name (model/annotations.h). Commands are never shared.
/// All decisions about sight and command are the functions here, asked by the hub.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "model/annotations.h"

namespace sandlot::server {

enum class Role : std::uint8_t { spectator, robot, team, admin, guest };
inline const char* name_of(Role role) {
  constexpr const char* names[] = {"spectator", "robot", "team", "admin", "guest"};
  return names[static_cast<std::size_t>(role)];
}

struct Access {
  Role role = Role::spectator;
  std::string name;                      ///< of the robot or the team
  std::vector<std::string> robots = {};  ///< those it drives

  bool is_admin() const { return role == Role::admin; }
  /// Whether it is for a part of the world only.
  bool is_scoped() const { return role == Role::robot || role == Role::team || role == Role::guest; }
  bool drives(std::string_view robot) const {
    for (const std::string& each : robots)
      if (each == robot) return true;
    return false;
  }
  /// @param address  of a device, a program, or a topic without its first slash: "red1/drive"
  bool may_command(std::string_view address) const {
    return is_admin() || (is_scoped() && drives(first_part(address)));
  }
};

/// Whether it sees the world as a whole: poses, parameters, the graph, services that only look.
inline bool sees_world(const Access& access, const model::Sharing& sharing) {
  if (access.is_admin()) return true;
  return access.role == Role::spectator && sharing.spectators == model::Sharing::Spectators::world;
}
/// Time and state of the run are everybody's.
inline bool sees_topic(const Access& access, const model::Sharing& sharing, std::string_view topic) {
  if (sees_world(access, sharing)) return true;
  if (topic == "/clock" || topic == "/sandlot/step_times" || topic == "/sandlot/status") return true;
  if (sharing.has(topic)) return true;
  // What devices and programs publish begins with the robot's name; a robot may be called tf.
  for (const std::string_view each : model::world_topics)
    if (topic == each) return false;
  return topic != model::commands_topic && access.is_scoped() &&
         access.drives(first_part(topic.substr(topic.empty() ? 0 : 1)));
}

/// A secret and what it opens. A spectator's may be empty: everybody may look on.
struct Token {
  std::string secret;
  Access access;
};

}  // namespace sandlot::server
