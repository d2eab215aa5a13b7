#include "controllers/carrier/carrier.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::carrier {
namespace {

using namespace carrying;

constexpr Time forget = Time::from_s(1);
constexpr double soonest_s = 0.1,
                 latest_s = 0.3;  // from one message to the next: at random, lest two robots keep colliding

/// The next number of a text of numbers with blanks between them.
bool next(std::string_view& text, std::int64_t& number) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(last - text.data()));
  return true;
}

void append(std::vector<std::uint8_t>& data, double number) {
  std::array<char, 24> digits{};
  // A State that was forged may hold anything.
  const double safe = number >= -1 && number <= 1e15 ? number : 0;
  const auto rounded = static_cast<std::int64_t>(std::floor(safe + 0.5));
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), rounded);
  if (error != std::errc()) return;
  if (!data.empty()) data.push_back(' ');
  data.insert(data.end(), digits.data(), end);
}

/// What append() wrote; false for anything else, such as what bit errors have made of it.
bool parse(const std::vector<std::uint8_t>& data, std::size_t post_count, Member& out) {
  std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  std::int64_t charge = 0, health = 0, load = 0, post = 0, ready = 0;
  for (std::int64_t* const number : {&charge, &health, &load, &post, &ready})
    if (!next(text, *number)) return false;
  const auto percent = [](std::int64_t number) { return number >= 0 && number <= 100; };
  if (!percent(charge) || !percent(health) || !percent(load) || post < no_post ||
      post >= static_cast<std::int64_t>(post_count))
    return false;
  out.charge = static_cast<double>(charge) / 100;
  out.health = static_cast<double>(health) / 100;
  out.load = static_cast<double>(load) / 100;
  out.post = static_cast<std::int32_t>(post);
  out.ready = ready == 1;
  out.bids.clear();
  for (std::size_t k = 0; k < post_count; ++k) {
    std::int64_t mm = 0;
    if (!next(text, mm) || mm < 0 || mm > 1'000'000'000'000) return false;
    out.bids.push_back(static_cast<double>(mm) / 1000);
  }
  return text.empty();
}

}  // namespace

Status Carrier::init(const Description& robot) {
  name = robot.robot;
  state.own.robot = name;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.keys.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.keys.drive));
  SL_ASSIGN(receiver, robot.reading<msg::RadioReceptionArray>(spec.radio));
  SL_ASSIGN(sender, robot.actuator<msg::RadioPacket>(spec.radio));
  if (!spec.keys.battery.empty()) { SL_ASSIGN(battery, robot.reading<msg::BatteryState>(spec.keys.battery)); }
  if (!spec.keys.health.empty()) { SL_ASSIGN(health, robot.reading<msg::PropertyStamped>(spec.keys.health)); }
  return {};
}

bool Carrier::fits() const {
  const auto post_count = static_cast<std::int32_t>(spec.keys.posts_m.size());
  return state.others.size() <= most_robots && state.own.bids.size() <= most_posts &&
         state.own.post >= no_post && state.own.post < post_count;
}

void Carrier::receive(const Observation& obs) {
  const auto heard = obs.get(receiver);
  if (!heard.valid || !heard.fresh) return;
  for (const msg::RadioReception& packet : heard.message.packets) {
    if (packet.from == name) continue;
    auto known = std::find_if(state.others.begin(), state.others.end(),
                              [&](const Member& other) { return other.robot == packet.from; });
    Member sent;
    if (!parse(packet.data, spec.keys.posts_m.size(), sent)) continue;
    if (known == state.others.end()) {
      if (state.others.size() >= most_robots) continue;
      state.others.emplace_back();
      known = state.others.end() - 1;
    }
    sent.robot = packet.from;
    sent.received = obs.now();
    *known = std::move(sent);
  }
}

void Carrier::send(const Observation& obs, Command& cmd) {
  if (obs.now() < state.resend) return;
  msg::RadioPacket packet;
  const Member& own = state.own;
  append(packet.data, 100 * own.charge);
  append(packet.data, 100 * own.health);
  append(packet.data, 100 * own.load);
  append(packet.data, own.post);
  append(packet.data, own.ready ? 1 : 0);
  for (const double each : own.bids) append(packet.data, 1000 * each);
  cmd.set(sender, packet);
  Stream random = obs.random();
  state.resend = obs.now() + Time::from_s(random.uniform(soonest_s, latest_s));
}

void Carrier::step(const Observation& obs, Command& cmd) {
  receive(obs);
  const auto seen = obs.get(camera);
  const msg::ObjectPose* const self = seen.valid ? steering::find(seen.message, name) : nullptr;
  const msg::ObjectPose* const beam = seen.valid ? steering::find(seen.message, spec.keys.load) : nullptr;
  if (!self || !beam) return cmd.set(drive, msg::Twist());
  const Load load = look_at(spec.keys, beam->pose);
  Member& own = state.own;
  if (!spec.keys.battery.empty()) own.charge = charge_of(obs.get(battery), own.charge);
  if (!spec.keys.health.empty()) own.health = health_of(obs.get(health), own.health);
  if (seen.fresh) state.effort.follow(steering::flat(self->pose.p), seen.stamp);
  own.load = state.effort.load;
  bid(spec.keys, load, self->pose, own);

  members.clear();
  members.push_back(&own);
  for (const Member& other : state.others)
    if (obs.now() - other.received <= forget) members.push_back(&other);
  settle(members, spec.keys.posts_m.size(), posts);
  // Who has just got a post is not there yet, even while the others push.
  const bool stays = state.pushing && own.ready && posts[0] == own.post;
  if (posts[0] != own.post) ++state.settled;
  own.post = posts[0];
  own.ready = own.post != no_post &&
              (stays || at_post(spec.keys, load, self->pose, static_cast<std::size_t>(own.post)));
  // All posts are manned: as their robots report.
  std::size_t manned = 0;
  for (std::size_t k = 0; k < spec.keys.posts_m.size(); ++k)
    manned += std::any_of(members.begin(), members.end(), [&](const Member* member) {
      return member->post == static_cast<std::int32_t>(k) && member->ready;
    });
  state.pushing = own.post != no_post && manned == spec.keys.posts_m.size();
  const msg::Twist order = carrying::drive(spec.keys, load, seen.message, *self, own.post, state.pushing,
                                           discs);
  state.effort.ordered_mps = order.linear.x;
  cmd.set(drive, order);
  send(obs, cmd);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Carrier>({
    .name = "carrier",
    .help = "Pushes a long load with team-mates, with roles that they settle by bids over the radio.",
});

}  // namespace sandlot::controllers::carrier
