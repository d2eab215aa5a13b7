// The clearing law of src/controllers/clearing as a client in lockstep: one process drives one pusher, on whatever machine.
//
//   sandlot run scenarios/clearing.yaml --set robots.pusher.controller=remote --port 8765 --rate max &
//   clearing pusher1 & clearing pusher2
//
// The run ends in the state of the built-in law, but for what the programs themselves keep: exact.h is the same file, and numbers are
// combined in the same order.
#include <sandlot_client/client.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "exact.h"

namespace {

using exact::Motion;
using exact::Vec;
using sandlot::client::Json;

enum class Phase { choose, approach, push, back_off };

constexpr std::uint64_t to_send = 1, to_wait = 2;  // uses of random numbers
constexpr std::size_t most_claims = 64;

constexpr std::int64_t ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9 + 0.5); }

/// A thing in the picture of the camera.
struct Thing {
  std::string name, label;
  exact::Place place;
};

std::vector<Thing> things_of(const Json& picture) {
  std::vector<Thing> out;
  for (const Json& each : picture.at("objects")) {
    const Json &p = each.at("pose").at("position"), &q = each.at("pose").at("orientation");
    const auto of = [](const Json& from, const char* key) { return from.at(key).get<double>(); };
    out.push_back({each.at("name").get<std::string>(), each.at("label").get<std::string>(),
                   exact::place(of(p, "x"), of(p, "y"), of(q, "x"), of(q, "y"), of(q, "z"), of(q, "w"))});
  }
  return out;
}

/// What the robot knows in one step.
struct View {
  std::int64_t now_ns;
  std::uint64_t random;
  const std::vector<Thing>& world;
  exact::Place here;
};

const Thing* find(const std::vector<Thing>& world, std::string_view name) {
  const auto found = std::find_if(world.begin(), world.end(),
                                  [&](const Thing& each) { return each.name == name; });
  return found == world.end() ? nullptr : &*found;
}

/// The five steps of the paper, see src/controllers/clearing/clearing.h, which also says what the numbers mean.
class Clearing {
 public:
  Clearing(std::string name, Vec destination, double radius_m)
      : name_(std::move(name)), destination_(destination), radius_m_(radius_m) {}

  int delivered() const { return delivered_; }

  /// @param packets  of the radio, where some came since the step before
  /// @param text     out: what to send, if anything
  Motion step(std::int64_t now_ns, std::uint64_t random, const std::vector<Thing>& world, const Json& packets,
              std::optional<std::string>& text) {
    const Thing* const me = find(world, name_);
    if (!me) return {};
    const View view{now_ns, random, world, me->place};
    receive(packets, view);
    const Motion motion = decide(view);
    text = claim(view);
    return motion;
  }

 private:
  struct Claim {
    std::string object;
    std::uint32_t bid_mm = 0;
    std::int64_t received_ns = 0;
  };

  /// Claims such as "box3 1250"; what bit errors have made something else of is left out.
  void receive(const Json& packets, const View& view) {
    for (const Json& each : packets) {
      const std::string from = each.at("from").get<std::string>(), data = sandlot::client::data_of(each);
      const std::size_t blank = data.find(' ');
      if (from == name_ || blank == std::string::npos) continue;
      Claim claim{data.substr(0, blank), 0, view.now_ns};
      const char* const end = data.data() + data.size();
      const auto [last, error] = std::from_chars(data.data() + blank + 1, end, claim.bid_mm);
      if (error != std::errc() || last != end) continue;
      if (!claim.object.empty() && !find(view.world, claim.object)) continue;
      if (claims_.count(from) > 0 || claims_.size() < most_claims) claims_[from] = claim;
    }
  }

  std::optional<std::string> claim(const View& view) {
    if (object_ == sent_object_ && view.now_ns < resend_ns_) return {};
    const Thing* const thing = find(view.world, object_);
    sent_object_ = object_;
    resend_ns_ = view.now_ns + ns(0.2 + (0.6 - 0.2) * exact::draw(view.random, to_send));
    return object_ + " " + std::to_string(thing ? bid_mm(*thing, view) : 0u);
  }

  double outside_m(const Thing& thing) const {
    return exact::norm(thing.place.at - destination_) - std::max(0.0, radius_m_ - margin_m);
  }
  std::uint32_t bid_mm(const Thing& thing, const View& view) const {
    if (phase_ == Phase::push) return 0;
    return 1 + static_cast<std::uint32_t>(1000 * std::min(exact::norm(thing.place.at - view.here.at), 1e6));
  }
  bool taken(const std::string& object, std::uint32_t bid_mm, const View& view) const {
    return std::any_of(claims_.begin(), claims_.end(), [&](const auto& each) {
      const auto& [robot, claim] = each;
      return claim.object == object && view.now_ns - claim.received_ns < ns(2) &&
             (claim.bid_mm < bid_mm || (claim.bid_mm == bid_mm && robot < name_));
    });
  }
  bool in_zone(const Thing& thing, const View& view) const {
    const Vec seen = exact::seen_from(view.here, thing.place.at);
    const double turn = exact::turn_between(view.here.heading, destination_ - thing.place.at);
    return seen.x > 0 && seen.x < reach_m && std::abs(seen.y) < zone_m && std::abs(turn) < zone_angle_rad;
  }

  const Thing* choose(const View& view) {
    const Thing* best = nullptr;
    std::uint32_t best_mm = 0;
    for (const Thing& thing : view.world) {
      if (thing.label != objects || thing.name.empty() || outside_m(thing) <= 0) continue;
      if (thing.name == left_alone_ && view.now_ns < left_alone_until_ns_) continue;
      const std::uint32_t bid = bid_mm(thing, view);
      if ((best && bid >= best_mm) || taken(thing.name, bid, view)) continue;
      best = &thing, best_mm = bid;
    }
    if (!best) return nullptr;
    object_ = best->name;
    phase_ = Phase::approach;
    nearest_m_ = outside_m(*best);
    progress_ns_ = view.now_ns;
    patience_now_s_ = patience_s * (0.75 + 0.5 * exact::draw(view.random, to_wait));
    return best;
  }

  Motion back_off(const View& view) {
    phase_ = Phase::back_off;
    backing_until_ns_ = stood_since_ns_ = view.now_ns + ns(0.9);
    return {};
  }

  bool jammed(const View& view) {
    const double heading = exact::angle_of(view.here.heading);
    const bool moved = exact::norm(view.here.at - stood_) > 0.06 ||
                       std::abs(exact::angle_between(stood_rad_, heading)) > 0.35;
    if (moved || phase_ == Phase::choose || phase_ == Phase::back_off) {
      stood_ = view.here.at;
      stood_rad_ = heading;
      stood_since_ns_ = view.now_ns;
    }
    return view.now_ns - stood_since_ns_ > ns(3);
  }

  Motion approach(const Thing& thing, const View& view) {
    const exact::Place& here = view.here;
    const Vec along = exact::unit(destination_ - thing.place.at);
    const Vec off = thing.place.at - here.at;
    const double ahead = exact::dot(off, along), beside = std::abs(exact::cross(along, off));
    if (ahead > 0 && beside < 0.05 && ahead < standoff_m + 2 * 0.05) {
      if (std::abs(exact::turn_between(here.heading, along)) > 0.12)
        return exact::turn_to(here, along, limits);
      phase_ = Phase::push;
      return push(thing, view);
    }
    std::vector<exact::Disc> discs;
    for (const Thing& each : view.world)
      if (each.name != name_)
        discs.push_back({each.place.at, each.label == objects ? object_clearance_m : robot_clearance_m});
    const Vec behind = thing.place.at - standoff_m * along;
    return exact::drive_to(here, exact::way_around(here.at, behind, discs), limits);
  }

  Motion push(const Thing& thing, const View& view) const {
    const double goal = exact::turn_between(view.here.heading, destination_ - view.here.at);
    const double side = exact::angle_of(exact::seen_from(view.here, thing.place.at));
    const double widest = push_speed_mps / 0.35;
    return {push_speed_mps, std::max(-widest, std::min(1.5 * goal + 2.5 * side, widest))};
  }

  Motion wait(const View& view) const {
    const Thing* nearest = nullptr;
    double nearest_m = 0.6;
    for (const Thing& other : view.world) {
      const double apart = exact::norm(other.place.at - view.here.at);
      if (other.name == name_ || other.label == objects || apart >= nearest_m) continue;
      nearest = &other, nearest_m = apart;
    }
    if (!nearest) return {};
    return exact::drive_along(view.here, exact::unit(view.here.at - nearest->place.at),
                              {0.5 * limits.speed_mps, limits.turn_speed_radps});
  }

  Motion decide(const View& view) {
    if (phase_ == Phase::back_off) {
      if (view.now_ns < backing_until_ns_) return {-0.25, 0};
      phase_ = object_.empty() ? Phase::choose : Phase::approach;
    }
    if (jammed(view)) return back_off(view);
    const Thing* thing = object_.empty() ? nullptr : find(view.world, object_);
    const bool yields = thing && taken(object_, bid_mm(*thing, view), view);
    if (thing && (yields || outside_m(*thing) <= 0)) {
      const bool pushed = phase_ == Phase::push;
      delivered_ += pushed && !yields;
      object_.clear();
      phase_ = Phase::choose;
      thing = nullptr;
      if (pushed) return back_off(view);
    }
    if (thing && outside_m(*thing) < nearest_m_ - 0.05) {
      nearest_m_ = outside_m(*thing);
      progress_ns_ = view.now_ns;
    }
    const bool patient = view.now_ns - progress_ns_ <= ns(patience_now_s_);
    if (thing && !patient) {
      left_alone_ = object_;
      left_alone_until_ns_ = view.now_ns + ns(patience_now_s_);
      object_.clear();
      return back_off(view);
    }
    if (!thing && !object_.empty() && patient) return {};  // it is not in this picture
    if (!thing) {
      object_.clear();
      phase_ = Phase::choose;
      thing = choose(view);
    }
    if (!thing) return wait(view);
    if (phase_ == Phase::push && !in_zone(*thing, view)) return back_off(view);
    return phase_ == Phase::push ? push(*thing, view) : approach(*thing, view);
  }

  static constexpr const char* objects = "box";
  static constexpr double margin_m = 0.1, push_speed_mps = 0.25, standoff_m = 0.34, reach_m = 0.48,
                          zone_m = 0.09, zone_angle_rad = 0.7, object_clearance_m = 0.26,
                          robot_clearance_m = 0.36, patience_s = 20;
  static constexpr exact::Limits limits{0.4, 2.5};

  const std::string name_;
  const Vec destination_;
  const double radius_m_;
  Phase phase_ = Phase::choose;
  std::string object_, left_alone_, sent_object_;
  double nearest_m_ = 0, patience_now_s_ = 0, stood_rad_ = 0;
  std::int64_t progress_ns_ = 0, backing_until_ns_ = 0, stood_since_ns_ = 0, left_alone_until_ns_ = 0,
               resend_ns_ = 0;
  Vec stood_;
  std::map<std::string, Claim> claims_;
  int delivered_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 5) {
    std::fprintf(stderr, "usage: clearing ROBOT [X Y RADIUS]      the destination [m]\n");
    return 2;
  }
  const std::string name = argv[1];
  const Vec destination = argc == 5 ? Vec{std::atof(argv[2]), std::atof(argv[3])} : Vec{1.6, 0};
  Clearing law(name, destination, argc == 5 ? std::atof(argv[4]) : 0.6);
  try {
    sandlot::client::Options options;
    options.lockstep = true;
    options.deadline_s = 5;
    sandlot::client::Robot robot(name, options);
    auto &camera = robot.subscribe("camera"), &radio = robot.subscribe("radio");
    std::vector<Thing> world;
    while (const auto step = robot.next_step()) {
      if (camera.fresh()) world = things_of(camera.message);
      std::optional<std::string> text;
      const Motion motion = law.step(step->time_ns, step->random, world,
                                     radio.fresh() ? radio.message.at("packets") : Json::array(), text);
      robot.command("drive",
                    {{"linear", {{"x", motion.forward_mps}}}, {"angular", {{"z", motion.turn_radps}}}});
      if (text) robot.command("radio", sandlot::client::packet(*text));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "clearing: %s\n", error.what());
    return 1;
  }
  std::printf("%s has brought %d boxes\n", name.c_str(), law.delivered());
}
