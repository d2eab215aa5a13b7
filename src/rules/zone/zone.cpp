/// zone: counts over time what goes into and out of a marker: for each robot or object how often, and how long it was inside.
///
/// Inside     its origin lies in the area; with `overlaps`, a part of its collisions (markers/footprint.h).
/// Counting   an entry when it is inside and was not in the tick before, or was not in the world; an exit likewise. What is
///            removed while it is inside leaves. A name that comes back goes on counting.
/// Time       the whole tick counts for those inside at its end.
/// Limits     the first 10,000 names that fit are followed, the others are counted in `ignored`. Who is inside now needs no rule:
///            values such as count(box*.in.area), docs/values.md.
#include <algorithm>

#include "base/text.h"
#include "markers/footprint.h"
#include "rules/rule.h"

namespace sandlot::rules::zone {
namespace {

constexpr std::size_t most_visitors = 10'000;

enum class Stop : std::uint8_t { never, any, all, none };
std::span<const EnumName<Stop>> enum_names(Stop) {
  static constexpr EnumName<Stop> names[] = {
      {"never", Stop::never}, {"any", Stop::any}, {"all", Stop::all}, {"none", Stop::none}};
  return names;
}

struct Spec {
  std::string marker;
  std::vector<std::string> objects{"*"};
  bool overlaps = false;
  Stop stop_when = Stop::never;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"marker", "", "Marker whose area is watched.", 0, 0, Field::required, 100}, s.marker);
    visit(
        Field{"objects", "",
              "Names of the robots and objects that count, * for any letters; without it all that can move.",
              0, 0, Field::none, 1000, 1},
        s.objects);
    visit(Field{"overlaps", "",
                "Whether an object is inside as soon as a part of it is, not only with its origin."},
          s.overlaps);
    visit(
        Field{
            "stop_when", "",
            "Number of objects inside at which the run ends: never, any, all, or none after one was there."},
        s.stop_when);
  }
};

struct Visitor {
  std::string name;
  bool inside = false;
  std::uint64_t entered = 0, left = 0;
  Time time;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the robot or object."}, s.name);
    visit(Field{"inside", "", "Whether it is in the area."}, s.inside);
    visit(Field{"entered", "1", "Times that it came in."}, s.entered);
    visit(Field{"left", "1", "Times that it went out."}, s.left);
    visit(Field{"time", "s", "Time that it has been inside."}, s.time);
  }
};

struct State {
  std::uint64_t inside = 0, entered = 0, left = 0, ignored = 0;
  std::vector<Visitor> visitors;  ///< in the order in which they were first seen

  static void fields(auto& s, auto&& visit) {
    visit(Field{"inside", "1", "Number of objects in the area."}, s.inside);
    visit(Field{"entered", "1", "Times that an object came in."}, s.entered);
    visit(Field{"left", "1", "Times that an object went out."}, s.left);
    visit(Field{"ignored", "1", "Objects in the latest tick that are not followed, beyond the limit."},
          s.ignored);
    visit(
        Field{"visitors", "", "Objects with what each did, in the order in which they came into the world."},
        s.visitors);
  }
};

struct Zone {
  using Spec = zone::Spec;
  using State = zone::State;
  Spec spec;
  State state;
  /// Places in `state.visitors` of the entities of a world, by their serials; not State.
  struct Known {
    std::uint64_t serial;
    std::size_t visitor;
  };
  std::vector<Known> known;
  std::vector<std::uint8_t> present;  ///< per visitor, in this tick

  Status init(const ElementBuild& build) {
    SL_TRY(build.expect_marker(spec.marker, "marker"));
    for (const std::string& pattern : spec.objects)
      if (pattern.find('*') == std::string::npos) SL_TRY(build.expect_entity(pattern, "objects"));
    return {};
  }
  bool fits() const {
    if (state.visitors.size() > most_visitors) return false;
    std::vector<std::string_view> names;
    std::uint64_t inside = 0;
    for (const Visitor& visitor : state.visitors) {
      names.push_back(visitor.name);
      if (visitor.inside) ++inside;
      if (visitor.time < Time{} || visitor.time > Time::from_s(1e9)) return false;
    }
    if (inside != state.inside) return false;
    std::sort(names.begin(), names.end());
    return std::adjacent_find(names.begin(), names.end()) == names.end();
  }

  bool counts(const model::Instance& instance) const {
    if (instance.model->is_static && !instance.motion) return false;
    return std::any_of(spec.objects.begin(), spec.objects.end(),
                       [&](const std::string& pattern) { return fits_pattern(instance.name, pattern); });
  }
  bool is(std::size_t visitor, const std::string& name) const {
    return visitor < state.visitors.size() && state.visitors[visitor].name == name;
  }
  /// Place among the visitors; nothing beyond the limit.
  std::optional<std::size_t> visitor_of(const EntityView& entity) {
    const auto place = std::lower_bound(
        known.begin(), known.end(), entity.serial,
        [](const Known& each, std::uint64_t serial) { return each.serial < serial; });
    const bool is_known = place != known.end() && place->serial == entity.serial;
    if (is_known && is(place->visitor, entity.instance->name)) return place->visitor;
    const auto found = std::find_if(
        state.visitors.begin(), state.visitors.end(),
        [&](const Visitor& visitor) { return visitor.name == entity.instance->name; });
    if (found == state.visitors.end() && state.visitors.size() == most_visitors) return std::nullopt;
    const auto visitor = static_cast<std::size_t>(found - state.visitors.begin());
    if (found == state.visitors.end()) state.visitors.push_back({entity.instance->name, false, 0, 0, {}});
    if (is_known) place->visitor = visitor;
    else known.insert(place, {entity.serial, visitor});
    return visitor;
  }
  void enter(Visitor& visitor) {
    visitor.inside = true;
    ++visitor.entered;
    ++state.entered;
    ++state.inside;
  }
  void leave(Visitor& visitor) {
    visitor.inside = false;
    ++visitor.left;
    ++state.left;
    --state.inside;
  }

  void judge(const RuleContext& context, RuleActions& actions) {
    const Marker* const marker = context.world.find_marker(spec.marker);
    present.assign(state.visitors.size(), 0);
    state.ignored = 0;
    std::size_t all = 0;
    for (const EntityView& entity : context.world.entities()) {
      if (!counts(*entity.instance)) continue;
      const auto place = visitor_of(entity);
      if (!place) {
        ++state.ignored;
        continue;
      }
      ++all;
      present.resize(state.visitors.size(), 0);
      present[*place] = 1;
      Visitor& visitor = state.visitors[*place];
      const Engine& engine = context.world.engine();
      const bool inside = spec.overlaps ? overlaps(*marker, engine, *entity.instance->model, entity.id)
                                        : marker->contains(context.world.pose(entity).p);
      if (inside && !visitor.inside) enter(visitor);
      if (!inside && visitor.inside) leave(visitor);
      // At tick 0 no time has passed.
      if (inside && context.tick_index > 0) visitor.time = visitor.time + context.step;
    }
    for (std::size_t i = 0; i < state.visitors.size(); ++i)
      if (!present[i] && state.visitors[i].inside) leave(state.visitors[i]);
    if (known.size() > 2 * all + 16) known.clear();  // most are gone; those that are there are found again
    stop(all, actions);
  }

  void stop(std::size_t all, RuleActions& actions) const {
    const std::string where = " in '" + spec.marker + "'";
    switch (spec.stop_when) {
      case Stop::never: break;
      case Stop::any:
        if (state.inside > 0) actions.stop("an object is" + where);
        break;
      case Stop::all:
        if (all > 0 && state.inside == all && state.ignored == 0) actions.stop("all objects are" + where);
        break;
      case Stop::none:
        if (state.entered > 0 && state.inside == 0) actions.stop("no object is left" + where);
        break;
    }
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Zone>({
    .name = "zone",
    .help = "Counts for each object how often and how long it is in a marker, and ends the run when any, all "
            "or none is.",
});

}  // namespace sandlot::rules::zone
