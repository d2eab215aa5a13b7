/// energy: what a robot does whose battery is empty.
///
/// Empty      of a robot's battery: nothing is left in it. With `empty: stop` the robot is put to rest where it is, once, as by
///            brakes that lock, and its actuators fail, as if each had the failure `dead`, from the next tick on. With `coast`
///            they fail alone: wheels without friction roll on. With `nothing` it is only counted.
/// Restart    when the charge of a robot that was stopped is `restart` or more, its actuators follow their planned failures
///            again, which are mostly none.
/// Limits     a robot that is put to rest lets go of what it grips; pushed, it rolls. An actuator that something else made fail while the robot was stopped works again, too.
#include <algorithm>

#include "rules/rule.h"

namespace sandlot::rules::energy {

enum class Empty : std::uint8_t { stop, coast, nothing };
inline std::span<const EnumName<Empty>> enum_names(Empty) {
  static constexpr EnumName<Empty> names[] = {
      {"stop", Empty::stop}, {"coast", Empty::coast}, {"nothing", Empty::nothing}};
  return names;
}

namespace {

struct Spec {
  Empty empty = Empty::stop;
  double restart = 0.05;
  std::vector<std::string> robots;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"empty", "",
                "Behaviour of a robot without energy: it stands and its actuators fail, they fail alone, or "
                "nothing."},
          s.empty);
    visit(Field{"restart", "1", "Charge from which on a robot that was stopped works again.", 0, 1,
                Field::tunable},
          s.restart);
    visit(Field{"robots", "", "Names of the robots; all if left out.", 0, 0, Field::none, 10'000}, s.robots);
  }
};

struct State {
  std::vector<std::uint64_t> empty;    ///< serials of the robots that are empty, ascending
  std::vector<std::uint64_t> stopped;  ///< of those whose actuators have failed, ascending
  std::uint64_t count = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"empty_robots", "1", "Robots without energy, by the order of creation."}, s.empty);
    visit(Field{"stopped", "1", "Robots whose actuators have failed, by the order of creation."}, s.stopped);
    visit(Field{"count", "1", "Times that a battery became empty."}, s.count);
  }
};

bool holds(const std::vector<std::uint64_t>& list, std::uint64_t robot) {
  return std::binary_search(list.begin(), list.end(), robot);
}
void set(std::vector<std::uint64_t>& list, std::uint64_t robot, bool in) {
  const auto at = std::lower_bound(list.begin(), list.end(), robot);
  const bool is = at != list.end() && *at == robot;
  if (in && !is) list.insert(at, robot);
  if (!in && is) list.erase(at);
}

struct Energy {
  using Spec = energy::Spec;
  using State = energy::State;
  Spec spec;
  State state;

  Status init(const ElementBuild& build) {
    for (const std::string& name : spec.robots) SL_TRY(build.expect_entity(name, "robots"));
    return {};
  }
  bool fits() const {
    const auto ascending = [](const std::vector<std::uint64_t>& list) {
      return std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) == list.end();
    };
    return ascending(state.empty) && ascending(state.stopped);
  }

  static void order(const RuleContext& context, const EntityView& robot, const char* failure,
                    RuleActions& actions) {
    for (const std::string& device : context.world.actuators(robot))
      actions.request(ParameterRequest{device, "failure", Node::scalar(failure)});
  }

  void judge(const RuleContext& context, RuleActions& actions) {
    for (const EntityView& robot : context.world.entities()) {
      const auto battery = context.world.battery(robot);
      if (!battery) continue;
      if (!spec.robots.empty() &&
          std::find(spec.robots.begin(), spec.robots.end(), robot.instance->name) == spec.robots.end())
        continue;
      if (battery->empty && !holds(state.empty, robot.serial)) ++state.count;
      set(state.empty, robot.serial, battery->empty);
      const bool stopped = holds(state.stopped, robot.serial);
      if (!stopped && battery->empty && spec.empty != Empty::nothing) {
        if (spec.empty == Empty::stop)
          actions.request(PoseRequest{robot.instance->name, context.world.pose(robot)});
        order(context, robot, "dead", actions);
        set(state.stopped, robot.serial, true);
      } else if (stopped && !battery->empty && battery->fraction >= spec.restart) {
        order(context, robot, "planned", actions);
        set(state.stopped, robot.serial, false);
      }
    }
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Energy>({
    .name = "energy",
    .help = "Behaviour of robots whose battery is empty.",
});

}  // namespace sandlot::rules::energy
