#pragma once
/// Decisions of referees so far, so that who begins to look has those from before: a topic keeps its latest message alone.
///
/// Threads   the simulation's. It begins with the server, whether somebody looks or not.
/// Time      the log follows jumps: it holds what happened between the beginning of the run and the latest time that is known of
///           its present course: now, and in a replay whatever has been seen. A decision that comes again is known; one that comes
///           in place of another, by its number, puts an end to all that followed.
/// Limits    the latest `most_decisions`; older ones go.
/// Cost      without a topic of that type nothing is observed; with one, two comparisons per tick.
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "messages/sandlot_soccer.h"
#include "sim/session/session.h"

namespace sandlot::server {

inline constexpr std::size_t most_decisions = 2000;

class DecisionLog final : public Observer {
 public:
  explicit DecisionLog(Session& session) : session_(session) { attach(); }
  /// Observes the run if there is something to observe; between two ticks, whenever the world may be another one.
  void attach();
  /// Ends it: the run is no longer observed.
  void detach();

  Wants wants() const override { return {.instances = false}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override;

  /// @param topic  "": that of the first decision that there is
  /// @return oldest first
  std::vector<msg::RefereeDecision> decisions(const std::string& topic);

  void take(const std::string& topic, const msg::RefereeDecision& decision);
  /// Forgets what happened before `begin` or after `end`.
  void keep_between(Time begin, Time end);

 private:
  struct Entry {
    std::string topic;
    msg::RefereeDecision decision;
  };
  struct Source {
    const TopicBase* topic = nullptr;
    std::uint64_t count = 0;  ///< of the message that was taken last
  };
  /// Looks for topics of decisions in a world that is another one or has changed.
  void find_topics();
  void forget_other_courses();

  Session& session_;
  bool watching_ = false;
  std::uint64_t epoch_ = 0, revision_ = 0;  ///< that it follows
  std::vector<Source> sources_;
  std::deque<Entry> entries_;
};

}  // namespace sandlot::server
