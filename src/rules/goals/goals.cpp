/// goals: counts how often an object comes into goals, and puts it back.
///
/// Counting   once per entry: the object's origin lies in the area and did not in the tick before.
/// Limits     an object faster than the area is deep, per tick, may pass through uncounted.
#include <algorithm>

#include "markers/marker.h"
#include "rules/rule.h"

namespace sandlot::rules::goals {
namespace {

struct Goal {
  std::string marker;
  std::string team;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"marker", "", "Marker whose area is the goal.", 0, 0, Field::required, 100}, s.marker);
    visit(Field{"team", "", "Team that scores there; the marker's name if left out.", 0, 0, Field::none, 100},
          s.team);
  }
};

struct Spec {
  std::string object;
  std::vector<Goal> goals;
  bool reset = true;
  std::array<double, 3> place_m{};
  int stop_at = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"object", "", "Name of the object, such as the ball.", 0, 0, Field::required, 100}, s.object);
    visit(Field{"goals", "", "Goals, with the team that scores in each.", 0, 0, Field::required, 100, 1},
          s.goals);
    visit(Field{"reset", "", "Whether the object is put to `place` after each goal."}, s.reset);
    visit(Field{"place", "m", "Position of the object after a goal: x y z.", -max_distance_m, max_distance_m},
          s.place_m);
    visit(Field{"stop_at", "1", "Number of goals of one team that ends the run; 0: none.", 0, 1e6},
          s.stop_at);
  }
};

struct State {
  std::vector<std::uint64_t> scored;  ///< per goal
  std::vector<std::uint8_t> inside;   ///< per goal
  Time last;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"scored", "1", "Times that the object came into each goal."}, s.scored);
    visit(Field{"inside", "", "Whether the object is in each goal."}, s.inside);
    visit(Field{"last", "s", "Time of the latest goal."}, s.last);
  }
};

struct Goals {
  using Spec = goals::Spec;
  using State = goals::State;
  Spec spec;
  State state;

  Status init(const ElementBuild& build) {
    SL_TRY(build.expect_entity(spec.object, "object"));
    for (Goal& goal : spec.goals) {
      SL_TRY(build.expect_marker(goal.marker, "goals"));
      if (goal.team.empty()) goal.team = goal.marker;
    }
    state.scored.resize(spec.goals.size(), 0);
    state.inside.resize(spec.goals.size(), 0);
    return {};
  }
  bool fits() const {
    return state.scored.size() == spec.goals.size() && state.inside.size() == spec.goals.size();
  }

  /// Goals of a team, which may score in several.
  std::uint64_t score(const std::string& team) const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < spec.goals.size(); ++i)
      if (spec.goals[i].team == team) sum += state.scored[i];
    return sum;
  }

  void judge(const RuleContext& context, RuleActions& actions) {
    const EntityView* const object = context.world.find_entity(spec.object);
    if (!object) return;
    const Pose X_WM = context.world.pose(*object);
    for (std::size_t i = 0; i < spec.goals.size(); ++i) {
      const Marker* const marker = context.world.find_marker(spec.goals[i].marker);
      const bool inside = marker && marker->contains(X_WM.p);
      const bool came = inside && !state.inside[i];
      state.inside[i] = inside;
      if (!came) continue;
      ++state.scored[i];
      state.last = context.now;
      const std::uint64_t score = this->score(spec.goals[i].team);
      if (spec.stop_at > 0 && score >= static_cast<std::uint64_t>(spec.stop_at))
        actions.stop(spec.goals[i].team + " has scored " + std::to_string(score));
      if (spec.reset)
        actions.request(PoseRequest{spec.object, {{spec.place_m[0], spec.place_m[1], spec.place_m[2]}, {}}});
    }
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Goals>({
    .name = "goals",
    .help = "Counts how often an object comes into goals, and puts it back.",
});

}  // namespace sandlot::rules::goals
