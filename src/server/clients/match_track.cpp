#include "server/clients/match_track.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandlot::server {
namespace {

constexpr Time period = Time::from_ns(200'000'000);
constexpr std::size_t most_robots = 64;
constexpr std::int32_t absent = std::numeric_limits<std::int32_t>::min();

std::int32_t millimetres(double m) {
  constexpr double most = 2e9;
  return static_cast<std::int32_t>(std::floor(std::clamp(1000 * m, -most, most) + 0.5));
}

/// The ball of a world: the page looks for it in the same way (web/src/app/game.ts).
bool may_be_ball(const std::string& name) {
  const auto same = [](char a, char b) { return (a | 0x20) == b; };
  constexpr std::string_view word = "ball";
  return std::search(name.begin(), name.end(), word.begin(), word.end(), same) != name.end();
}

}  // namespace

void MatchTrack::find_topic() {
  const Simulation& simulation = session_.simulation();
  if (epoch_ == session_.epoch() && revision_ == simulation.revision()) return;
  epoch_ = session_.epoch();
  revision_ = simulation.revision();
  topic_ = nullptr;
  // A rule's own comes before those of robots, which repeat what they were sent.
  simulation.for_each_topic([&](const TopicBase& topic, const std::string&) {
    if (!topic_cast<msg::RefereeState>(&topic)) return;
    const bool rules = topic.name().starts_with("/rules/");
    if (!topic_ || (rules && !topic_->name().starts_with("/rules/"))) topic_ = &topic;
  });
}

void MatchTrack::attach() {
  find_topic();
  if (watching_ || !topic_) return;
  watching_ = true;
  session_.add_observer(this);
}

void MatchTrack::detach() {
  if (watching_) session_.remove_observer(this);
  watching_ = false;
}

void MatchTrack::on_frame(const std::shared_ptr<const Frame>& frame) {
  find_topic();
  if (!topic_ || topic_->count == 0 || session_.rerunning()) return;
  forget_other_courses();
  take(frame->now, topic_cast<msg::RefereeState>(topic_)->message);
}

/// A run that has gone back forgets what it would have come to; a recording comes to it again.
void MatchTrack::forget_other_courses() {
  const Time now = session_.simulation().now();
  if (known_until_ <= now || session_.report().replay) return;
  known_until_ = now;
  while (!places_.empty() && now < places_.back().at) places_.pop_back();
  while (!touches_.empty() && now < touches_.back().at) touches_.pop_back();
}

void MatchTrack::take(Time now, const msg::RefereeState& state) {
  if (now <= known_until_) return;
  known_until_ = now;
  const std::string& robot = state.in_play ? state.last_touch : std::string();
  if (touches_.empty() ? !robot.empty() : touches_.back().robot != robot) touches_.push_back({now, robot});
  if (touches_.size() > most_places) touches_.pop_front();
  if (!state.in_play || (!places_.empty() && now < places_.back().at + period)) return;
  if (places_.size() >= most_places) places_.pop_front();
  places_.push_back({now, places()});
}

std::vector<std::int32_t> MatchTrack::places() {
  const Simulation& simulation = session_.simulation();
  std::vector<std::int32_t> out(2 + 2 * robots_.size(), absent);
  const auto put = [&](std::size_t column, const SimulationParts::Entity& entity) {
    const Pose X_WM = simulation.engine().pose(entity.id);
    out[2 * column] = millimetres(X_WM.p.x);
    out[2 * column + 1] = millimetres(X_WM.p.y);
  };
  const SimulationParts::Entity* ball = simulation.find_entity("ball");
  for (const auto& each : simulation.entities()) {
    const model::Instance& instance = each->instance;
    if (!instance.is_robot && !ball && may_be_ball(instance.name)) ball = each.get();
    if (!instance.is_robot || instance.team.empty()) continue;
    const auto known = static_cast<std::size_t>(std::find(robots_.begin(), robots_.end(), instance.name) -
                                                robots_.begin());
    if (known == robots_.size()) {
      if (known == most_robots) continue;
      robots_.push_back(instance.name);
      teams_.push_back(instance.team);
      out.resize(out.size() + 2, absent);
    }
    put(1 + known, *each);
  }
  if (ball) put(0, *ball);
  return out;
}

msg::MatchTrack::Response MatchTrack::track() {
  if (!session_.rerunning()) forget_other_courses();
  const Time now = session_.simulation().now();
  msg::MatchTrack::Response out;
  out.robots = robots_;
  out.teams = teams_;
  const std::size_t width = 2 + 2 * robots_.size();
  for (const Places& each : places_) {
    if (now < each.at) break;
    out.times.push_back(each.at.s());
    out.places.insert(out.places.end(), each.values.begin(), each.values.end());
    out.places.resize(width * out.times.size(), absent);
  }
  for (const Touch& each : touches_) {
    if (now < each.at) break;
    out.touch_times.push_back(each.at.s());
    out.touches.push_back(each.robot);
  }
  return out;
}

}  // namespace sandlot::server
