/// impact: damage of robots by hard contacts.
///
/// Damage     of a robot grows by the part of each sub-step's impulse over the threshold. Above the limit its actuators fail,
///            as if each had the failure `dead`.
/// Property   with `property: health` the damage of a tick times `per_damage` is taken from that property of the robot, as far as
///            its least value; robots without it keep theirs. At the least value their actuators fail, too.
/// Impulse    of all contacts of two bodies in one sub-step together; so a blow that the engine spreads over several sub-steps
///            counts less than one blow of the same sum, and the threshold belongs to the length of a sub-step.
/// Limits     contacts within one robot count for nothing.
#include <algorithm>

#include "base/text.h"
#include "rules/rule.h"

namespace sandlot::rules::impact {
namespace {

struct Spec {
  double threshold_Ns = 1;
  double limit_Ns = 0;
  std::string property;
  double per_damage = 1;
  std::vector<std::string> robots;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"threshold", "Ns", "Impulse in one sub-step from which on a contact does damage.", 0, 1e6,
                Field::tunable},
          s.threshold_Ns);
    visit(Field{"limit", "Ns", "Damage at which the actuators of a robot fail; 0: never.", 0, 1e9,
                Field::tunable},
          s.limit_Ns);
    visit(Field{"property", "", "Property of the robots that damage lowers, such as health.", 0, 0,
                Field::none, 100},
          s.property);
    visit(Field{"per_damage", "1", "Loss of the property [its unit per Ns] per damage.", 0, 1e9},
          s.per_damage);
    visit(Field{"robots", "", "Names of the robots that take damage; all if left out.", 0, 0, Field::none,
                10'000},
          s.robots);
  }
};

/// Damage of one robot.
struct Damage {
  std::uint64_t robot = 0;  ///< its serial
  double sum_Ns = 0, hardest_Ns = 0;
  std::uint64_t blows = 0;
  bool broken = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"robot", "1", "Number of the robot in the order of creation."}, s.robot);
    visit(Field{"sum", "Ns", "Damage so far."}, s.sum_Ns);
    visit(Field{"hardest", "Ns", "Greatest impulse in one sub-step."}, s.hardest_Ns);
    visit(Field{"blows", "1", "Sub-steps with damage."}, s.blows);
    visit(Field{"broken", "", "Whether its actuators have failed."}, s.broken);
  }
};

struct State {
  std::vector<Damage> robots;  ///< those with damage, by serial

  static void fields(auto& s, auto&& visit) { visit(Field{"robots", "", "Robots with damage."}, s.robots); }
};

struct Impact {
  using Spec = impact::Spec;
  using State = impact::State;
  Spec spec;
  State state;
  struct Blow {
    std::uint64_t robot;
    std::uint32_t substep, other;
    Vec3 impulse;
  };
  std::vector<Blow> blows;  ///< of this tick
  struct Loss {
    std::uint64_t robot;
    double damage_Ns;
  };
  std::vector<Loss> losses;  ///< of this tick

  Status init(const ElementBuild& build) {
    for (const std::string& name : spec.robots) SL_TRY(build.expect_entity(name, "robots"));
    if (!spec.property.empty()) return build.expect_property(spec.property, "property");
    return {};
  }
  bool fits() const {
    return std::is_sorted(state.robots.begin(), state.robots.end(),
                          [](const Damage& a, const Damage& b) { return a.robot <= b.robot; });
  }

  const EntityView* robot_of(const WorldView& world, std::string_view name) const {
    const EntityView* const entity = world.find_entity(name);
    if (!entity || !entity->instance->is_robot) return nullptr;
    const bool all = spec.robots.empty();
    return all || std::find(spec.robots.begin(), spec.robots.end(), name) != spec.robots.end() ? entity
                                                                                               : nullptr;
  }

  Damage& damage_of(std::uint64_t robot) {
    const auto place = std::lower_bound(
        state.robots.begin(), state.robots.end(), robot,
        [](const Damage& a, std::uint64_t serial) { return a.robot < serial; });
    if (place != state.robots.end() && place->robot == robot) return *place;
    return *state.robots.insert(place, Damage{.robot = robot});
  }

  void collect(const RuleContext& context) {
    blows.clear();
    const Engine& engine = context.world.engine();
    for (const BodyTouch& touch : context.touches) {
      const BodyName a = engine.name(touch.a), b = engine.name(touch.b);
      if (a.instance == b.instance) continue;
      if (const EntityView* robot = robot_of(context.world, a.instance))
        blows.push_back({robot->serial, touch.substep, touch.b.index, touch.impulse_W_Ns});
      if (const EntityView* robot = robot_of(context.world, b.instance))
        blows.push_back({robot->serial, touch.substep, touch.a.index, touch.impulse_W_Ns});
    }
    std::stable_sort(blows.begin(), blows.end(), [](const Blow& a, const Blow& b) {
      return std::tuple(a.robot, a.substep, a.other) < std::tuple(b.robot, b.substep, b.other);
    });
  }

  void judge(const RuleContext& context, RuleActions& actions) {
    collect(context);
    losses.clear();
    for (std::size_t i = 0; i < blows.size();) {
      const Blow& first = blows[i];
      Vec3 sum;
      for (; i < blows.size() && blows[i].robot == first.robot && blows[i].substep == first.substep &&
             blows[i].other == first.other;
           ++i)
        sum = sum + blows[i].impulse;
      const double impulse = norm(sum);
      if (!(impulse > spec.threshold_Ns)) continue;
      Damage& damage = damage_of(first.robot);
      note_loss(first.robot, impulse - spec.threshold_Ns);
      damage.sum_Ns += impulse - spec.threshold_Ns;
      damage.hardest_Ns = std::max(damage.hardest_Ns, impulse);
      ++damage.blows;
    }
    for (const Loss& loss : losses) take_from_property(context, loss, actions);
    if (spec.limit_Ns <= 0) return;
    for (Damage& damage : state.robots)
      if (!damage.broken && damage.sum_Ns >= spec.limit_Ns)
        damage.broken = break_down(context, damage.robot, actions);
  }

  void note_loss(std::uint64_t robot, double damage_Ns) {
    if (spec.property.empty()) return;
    if (losses.empty() || losses.back().robot != robot) losses.push_back({robot, 0});
    losses.back().damage_Ns += damage_Ns;
  }

  void take_from_property(const RuleContext& context, const Loss& loss, RuleActions& actions) {
    for (const EntityView& entity : context.world.entities()) {
      if (entity.serial != loss.robot) continue;
      const model::PropertyDecl* const property = entity.instance->find_property(spec.property);
      if (!property) return;
      const double left = std::max(property->min, property->value - spec.per_damage * loss.damage_Ns);
      if (left == property->value) return;
      actions.request(
          ParameterRequest{entity.instance->name, spec.property, Node::scalar(number_text(left))});
      Damage& damage = damage_of(loss.robot);
      if (left == property->min && !damage.broken) damage.broken = break_down(context, loss.robot, actions);
    }
  }

  static bool break_down(const RuleContext& context, std::uint64_t serial, RuleActions& actions) {
    for (const EntityView& entity : context.world.entities()) {
      if (entity.serial != serial) continue;
      for (const std::string& device : context.world.actuators(entity))
        actions.request(ParameterRequest{device, "failure", Node::scalar("dead")});
      return true;
    }
    return false;  // it was deleted
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Impact>({
    .name = "impact",
    .help = "Damage of robots by hard contacts; above a limit their actuators fail.",
    .touches = RuleKind::Touches::impulses,
});

}  // namespace sandlot::rules::impact
