/// place: puts an object to a pose whenever a condition begins to hold.
#include "rules/rule.h"

namespace sandlot::rules::place {
namespace {

struct Spec {
  std::string object;
  std::string when;
  std::array<double, 3> place_m{};
  double yaw_rad = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"object", "", "Name of the object or robot.", 0, 0, Field::required, 100}, s.object);
    visit(Field{"when", "", "Condition: an expression that is other than 0.", 0, 0, Field::required, 2000},
          s.when);
    visit(Field{"place", "m", "Position of the object: x y z.", -max_distance_m, max_distance_m}, s.place_m);
    visit(Field{"yaw", "rad", "Heading of the object.", -1e4, 1e4}, s.yaw_rad);
  }
};

struct State {
  bool holds = false;
  std::uint64_t count = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"holds", "", "Whether the condition held in the latest tick."}, s.holds);
    visit(Field{"count", "1", "Times that the object was put there."}, s.count);
  }
};

struct PlaceRule {
  using Spec = place::Spec;
  using State = place::State;
  Spec spec;
  State state;
  std::uint32_t when = 0;

  Status init(const ElementBuild& build) {
    SL_TRY(build.expect_entity(spec.object, "object"));
    SL_ASSIGN(when, build.watch(spec.when, "when"));
    return {};
  }

  void judge(const RuleContext& context, RuleActions& actions) {
    const std::optional<double> value = context.world.value(when);
    const bool holds = value && *value != 0;
    const bool begins = holds && !state.holds;
    state.holds = holds;
    if (!begins || !context.world.find_entity(spec.object)) return;
    ++state.count;
    actions.request(PoseRequest{
        spec.object,
        pose_from_rpy({spec.place_m[0], spec.place_m[1], spec.place_m[2]}, {0, 0, spec.yaw_rad})});
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<PlaceRule>({
    .name = "place",
    .help = "Puts an object to a pose whenever a condition begins to hold.",
});

}  // namespace sandlot::rules::place
