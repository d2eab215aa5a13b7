#pragma once
/// Track of a match so far: places of the ball and of the teams' robots while it was in play, and who touched the ball. Whoever
/// begins to look makes the same maps from it as those who have looked all the time.
///
/// Threads   the simulation's. It begins with the server, whether somebody looks or not.
/// Time      places every 0.2 s; touches at the tick. The track follows jumps as the log of decisions does (decision_log.h).
/// Frame     the world's: the field lies in its x-y plane.
/// Limits    one referee, the first of the scenario; the latest `most_places` times, in play more than an hour; 64 robots.
/// Cost      without a referee nothing is observed; with one, a comparison per tick, and five times a second two numbers per robot.
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "messages/services.h"
#include "sim/session/session.h"

namespace sandlot::server {

inline constexpr std::size_t most_places = 20'000;

class MatchTrack final : public Observer {
 public:
  explicit MatchTrack(Session& session) : session_(session) { attach(); }
  /// Observes the run if there is something to observe; between two ticks, whenever the world may be another one.
  void attach();
  /// Ends it: the run is no longer observed.
  void detach();

  Wants wants() const override { return {.instances = false}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override;

  /// From the beginning of the run until now.
  msg::MatchTrack::Response track();

  /// The referee's state after a tick: notes who has touched the ball, and places if they are due.
  void take(Time now, const msg::RefereeState& state);

 private:
  struct Places {
    Time at;
    std::vector<std::int32_t> values;  ///< [mm] x and y of the ball, then of each robot known by then
  };
  struct Touch {
    Time at;
    std::string robot;
  };
  void find_topic();
  void forget_other_courses();
  std::vector<std::int32_t> places();

  Session& session_;
  bool watching_ = false;
  std::uint64_t epoch_ = 0, revision_ = 0;  ///< that it follows
  const TopicBase* topic_ = nullptr;
  std::vector<std::string> robots_, teams_;
  std::deque<Places> places_;
  std::deque<Touch> touches_;
  Time known_until_ = Time::from_ns(-1);  ///< of the present course
};

}  // namespace sandlot::server
