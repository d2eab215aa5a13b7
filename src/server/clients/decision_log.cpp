#include "server/clients/decision_log.h"

#include <algorithm>
#include <limits>

namespace sandlot::server {

void DecisionLog::find_topics() {
  const Simulation& simulation = session_.simulation();
  if (epoch_ == session_.epoch() && revision_ == simulation.revision()) return;
  epoch_ = session_.epoch();
  revision_ = simulation.revision();
  sources_.clear();
  simulation.for_each_topic([&](const TopicBase& topic, const std::string&) {
    if (topic_cast<msg::RefereeDecision>(&topic)) sources_.push_back({&topic, 0});
  });
}

void DecisionLog::attach() {
  find_topics();
  if (watching_ || sources_.empty()) return;
  watching_ = true;
  session_.add_observer(this);
}

void DecisionLog::detach() {
  if (watching_) session_.remove_observer(this);
  watching_ = false;
}

void DecisionLog::on_frame(const std::shared_ptr<const Frame>& /*frame*/) {
  find_topics();
  for (Source& each : sources_) {
    if (each.topic->count == each.count) continue;
    each.count = each.topic->count;
    if (each.count == 0) continue;
    if (!session_.rerunning()) forget_other_courses();
    take(each.topic->name(), topic_cast<msg::RefereeDecision>(each.topic)->message);
  }
}

/// A run that has gone back forgets what it would have come to; a recording comes to it again.
void DecisionLog::forget_other_courses() {
  const Session::Report report = session_.report();
  constexpr Time never = Time::from_ns(std::numeric_limits<std::int64_t>::max());
  keep_between(report.begin, report.replay ? never : session_.simulation().now());
}

void DecisionLog::take(const std::string& topic, const msg::RefereeDecision& decision) {
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& each) {
    return each.topic == topic && each.decision.sequence == decision.sequence;
  });
  if (known != entries_.end() && known->decision.tick == decision.tick &&
      known->decision.rule == decision.rule && known->decision.robot == decision.robot)
    return;
  std::erase_if(entries_, [&](const Entry& each) {
    return each.topic == topic && each.decision.sequence >= decision.sequence;
  });
  if (entries_.size() >= most_decisions) entries_.pop_front();
  entries_.push_back({topic, decision});
}

void DecisionLog::keep_between(Time begin, Time end) {
  std::erase_if(entries_, [&](const Entry& each) {
    return each.decision.header.stamp < begin || end < each.decision.header.stamp;
  });
}

std::vector<msg::RefereeDecision> DecisionLog::decisions(const std::string& topic) {
  if (!session_.rerunning()) forget_other_courses();
  std::vector<msg::RefereeDecision> out;
  for (const Entry& each : entries_)
    if (each.topic == (topic.empty() ? entries_.front().topic : topic)) out.push_back(each.decision);
  return out;
}

}  // namespace sandlot::server
