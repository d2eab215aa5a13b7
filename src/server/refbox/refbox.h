#pragma once
/// Referee box: tells base stations of the league what the referee of the run says. docs/referee_box.md.
///
/// Words     the commands sandlot_msgs/RefereeCommand that rules give to robots, once each, in their order. What others send to
///           robots, and what is run again on the way to an earlier time, is not passed on.
/// Teams     are recognised by address (server/refbox/teams.h), one connection each; the first message is the welcome of its protocol.
/// World states  of teams are judged and counted; the latest of each is kept. Nothing that a base station sends reaches the run.
/// Limits    a message without NUL of more than 100 kB ends its connection; beyond 100 messages a second those of a team are dropped,
///           beyond 1 MiB/s it is read later; who does not read is disconnected.
/// Threads   one of its own; words are noted on the simulation's.
/// Cost      a look at each tick's log.
/// Not here  the score feed of port 12345; commands from base stations (SUBSTITUTION is the referee's to say).
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/refbox/teams.h"
#include "sim/world/frame.h"

namespace sandlot {
class Session;
}

namespace sandlot::server {

struct RefboxOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = refbox::league_port;  ///< 0: any that is free
  RefboxTeams teams;
  std::size_t queue_bytes = 64u << 10;  ///< that may wait for a base station
  int send_buffer_bytes = 64 << 10;     ///< of the kernel
};

/// Finds the referee's words in the log of ticks.
class RefereeWords {
 public:
  /// Words of a tick that were not given before. Errors in a command are the world's: it is left out, and counted.
  /// @param new_world  the numbers of commands begin again
  std::vector<refbox::Word> take(const Frame& frame, bool new_world);
  std::uint64_t wrong() const { return wrong_; }

 private:
  std::uint64_t latest_ = 0, wrong_ = 0;
};

/// Figures of a team.
struct RefboxReport {
  refbox::Side side = refbox::Side::cyan;
  refbox::Protocol protocol = refbox::Protocol::json;
  std::string id;       ///< by which JSON names it
  std::string address;  ///< of its base station; "": not connected
  std::uint64_t connections = 0;
  std::uint64_t words = 0;         ///< sent
  std::uint64_t unsent = 0;        ///< words for which the protocol has nothing
  std::uint64_t world_states = 0;  ///< that were right
  std::uint64_t wrong = 0;         ///< messages that were none
  std::uint64_t dropped = 0;       ///< messages beyond the rate
  std::string error;               ///< of the latest wrong message
  refbox::WorldState latest;
  double latest_age_s = 0;  ///< of it, by the wall clock, with the age that it gives itself
};

class Refbox {
 public:
  /// @pre the session outlives it; called before session.run()
  /// Errors   the address cannot be bound.
  static Result<std::unique_ptr<Refbox>> start(const RefboxOptions& options, Session& session);
  ~Refbox();
  std::uint16_t port() const;
  /// "127.0.0.1:28097"
  std::string address() const;
  /// On any thread.
  std::vector<RefboxReport> teams() const;
  /// Connections that were sent away: of no team, or of one that is there already.
  std::uint64_t refused() const;
  /// Passes words on as if the referee had said them; on any thread.
  void say(std::vector<refbox::Word> words);
  /// @pre session.run() has returned, or this is its thread
  void stop();

 private:
  struct Impl;
  explicit Refbox(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot::server
