#include "server/services/entity_filter.h"

#include <algorithm>

#include "geometry/hull_overlap.h"

namespace sandlot::server {

using msg::simulation::EntityCategory;
using msg::simulation::EntityFilters;
using msg::simulation::TagsFilter;
using BoundsMessage = msg::simulation::Bounds;

std::uint8_t category_of(const Simulation::Entity& entity) {
  using model::Category;
  switch (entity.instance.info.category) {
    case Category::object: return EntityCategory::object;
    case Category::robot: return EntityCategory::robot;
    case Category::human: return EntityCategory::human;
    case Category::dynamic_object: return EntityCategory::dynamic_object;
    case Category::static_object: return EntityCategory::static_object;
    case Category::automatic: break;
  }
  if (entity.instance.is_robot) return EntityCategory::robot;
  return entity.instance.model->is_static ? EntityCategory::static_object : EntityCategory::dynamic_object;
}

SimResult check(const TagsFilter& filter) {
  if (filter.filter_mode <= TagsFilter::all) return make_result(SimResult::ok);
  return make_result(SimResult::operation_failed, "filter_mode is 0, any, or 1, all");
}

bool fits(const TagsFilter& filter, const std::vector<std::string>& tags) {
  if (filter.tags.empty()) return true;
  const auto has = [&](const std::string& tag) {
    return std::find(tags.begin(), tags.end(), tag) != tags.end();
  };
  return filter.filter_mode == TagsFilter::all ? std::all_of(filter.tags.begin(), filter.tags.end(), has)
                                               : std::any_of(filter.tags.begin(), filter.tags.end(), has);
}

Bounds bounds_in(const Simulation& simulation, const Simulation::Entity& entity, const Pose& X_WA) {
  Bounds solid, seen;
  bool endless = false;
  const Pose X_AW = inverse(X_WA);
  const auto bodies = simulation.engine().bodies(entity.id);
  const auto states = simulation.engine().states();
  const auto& links = entity.instance.model->links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Pose X_AL = X_AW * states[bodies[i].index].X_WB;
    for (const model::Collision& each : links[i].collisions) {
      endless = endless || std::holds_alternative<Plane>(each.shape);
      solid.include(bounds_of(each.shape, X_AL * each.X_LC));
    }
    for (const model::Visual& each : links[i].visuals) seen.include(bounds_of(each.shape, X_AL * each.X_LC));
  }
  if (endless) return {};
  return solid.empty() ? seen : solid;
}

BoundsMessage bounds_message(const Bounds& bounds) {
  BoundsMessage out;
  if (bounds.empty()) return out;
  out.type = BoundsMessage::box;
  out.points = {bounds.high, bounds.low};
  return out;
}

SimResult EntityFilter::compile(const EntityFilters& filters, EntityFilter& out) {
  const auto failed = [](const std::string& why) { return make_result(SimResult::operation_failed, why); };
  auto name = NameFilter::compile(filters.filter);
  if (!name) return failed(name.error().text());
  out.name_ = std::move(*name);
  for (const EntityCategory& each : filters.categories) out.categories_.push_back(each.category);
  if (SimResult tags = check(filters.tags); tags.result != SimResult::ok) return tags;
  out.tags_ = filters.tags;
  const auto& points = filters.bounds.points;
  out.bounds_ = filters.bounds.type;
  if (!std::all_of(points.begin(), points.end(), [](Vec3 p) { return is_finite(p); }))
    return failed("the points of the bounds are not finite");
  constexpr std::size_t most_points = 1000;
  switch (filters.bounds.type) {
    case BoundsMessage::empty: break;
    case BoundsMessage::sphere:
      if (points.size() != 2 || !(points[1].x >= 0))
        return failed("a sphere has two points: its centre, and its radius as x");
      out.ball_ = {points[0], points[1].x};
      break;
    case BoundsMessage::box: {
      if (points.size() != 2) return failed("a box has two points: its upper and its lower corner");
      Bounds box;
      for (const Vec3& each : points) box.include(each);
      for (unsigned i = 0; i < 8; ++i)
        out.hull_W_.push_back(
            {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z});
      break;
    }
    case BoundsMessage::convex_hull:
      if (points.size() < 3 || points.size() > most_points)
        return failed("a convex hull has 3 to 1000 points");
      out.hull_W_ = points;
      break;
    default:
      return make_result(SimResult::feature_unsupported, "bounds are a sphere, a box or a convex hull");
  }
  return make_result(SimResult::ok);
}

bool EntityFilter::overlaps(const Simulation& simulation, const Simulation::Entity& entity) const {
  const auto bodies = simulation.engine().bodies(entity.id);
  const auto states = simulation.engine().states();
  const auto& links = entity.instance.model->links;
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const model::Collision& each : links[i].collisions)
      if (meets(each.shape, states[bodies[i].index].X_WB * each.X_LC, hull_W_)) return true;
  return false;
}

std::vector<const Simulation::Entity*> EntityFilter::select(const Simulation& simulation) const {
  // A ball is the engine's own question.
  std::vector<std::string_view> in_ball;
  if (bounds_ == BoundsMessage::sphere) {
    std::vector<std::uint32_t> found, ends;
    simulation.engine().overlaps({&ball_, 1}, found, ends);
    for (const std::uint32_t index : found)
      in_ball.push_back(simulation.engine().name(simulation.engine().body_at(index)).instance);
    std::sort(in_ball.begin(), in_ball.end());
  }
  std::vector<const Simulation::Entity*> out;
  for (const auto& entity : simulation.entities()) {
    const model::Instance& instance = entity->instance;
    if (!name_.matches(instance.name) || !fits(tags_, instance.info.tags)) continue;
    if (!categories_.empty() &&
        std::find(categories_.begin(), categories_.end(), category_of(*entity)) == categories_.end())
      continue;
    if (bounds_ == BoundsMessage::sphere &&
        !std::binary_search(in_ball.begin(), in_ball.end(), instance.name))
      continue;
    if (!hull_W_.empty() && !overlaps(simulation, *entity)) continue;
    out.push_back(entity.get());
  }
  return out;
}

}  // namespace sandlot::server
