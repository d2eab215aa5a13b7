#include "sim/world/pull.h"

#include <algorithm>

#include "base/math.h"
#include "base/text.h"

namespace sandlot {

double mass_kg(const model::Model& model) {
  double sum = 0;
  for (const model::Link& link : model.links) sum += link.inertial.mass_kg;
  return sum;
}

Wrench wrench_of(const Pull& pull, BodyId body, const BodyState& state, const model::Link& link,
                 double mass_kg) {
  constexpr double w = 2 * math::pi, most_mps2 = 50;
  const Vec3 arm_W = rotate(state.X_WB.q, pull.point_L);
  const Vec3 v = state.V_WB.linear + cross(state.V_WB.angular, arm_W);
  Vec3 a = (pull.target_W - (state.X_WB.p + arm_W)) * (w * w) - v * (2 * w);
  if (const double size = norm(a); size > most_mps2) a = a * (most_mps2 / size);
  const Vec3 force = a * mass_kg;
  return {body, force, cross(arm_W - rotate(state.X_WB.q, link.inertial.X_LCo.p), force)};
}

Status Pulls::start(const Entity& entity, const PullRequest& request, Time now) {
  const model::Model& model = *entity.instance.model;
  remove(entity);
  if (request.hold <= Time{}) return {};
  if (model.is_static || entity.instance.motion)
    return Error{"'" + request.name + "' cannot be moved by forces"};
  const auto link = request.link.empty() ? std::optional<std::uint32_t>(0) : model.find_link(request.link);
  if (!link) {
    std::vector<std::string> known;
    for (const model::Link& each : model.links) known.push_back(each.name);
    return Error{"'" + request.name + "' has no link '" + request.link + "'",
                 suggestion(request.link, known)};
  }
  if (!is_finite(request.point_L) || !is_finite(request.target_W) || norm(request.point_L) > 1e6 ||
      norm(request.target_W) > 1e6)
    return Error{"the pull is not finite"};
  if (request.hold > Time::from_s(longest_pull_s))
    return Error{"a pull lasts " + number_text(longest_pull_s) + " s at most", "ask again before it ends"};
  pulls_.push_back({entity.serial, *link, request.point_L, request.target_W, now + request.hold});
  return {};
}

void Pulls::remove(const Entity& entity) {
  std::erase_if(pulls_, [&](const Pull& pull) { return pull.serial == entity.serial; });
}

void Pulls::add_wrenches(std::span<const Owned<Entity>> entities, const Engine& engine, Time begin,
                         Actuation& actuation) {
  std::erase_if(pulls_, [&](const Pull& pull) { return pull.until <= begin; });
  for (const Pull& pull : pulls_)
    for (const auto& entity : entities) {
      if (entity->serial != pull.serial) continue;
      const model::Model& model = *entity->instance.model;
      const BodyId body = engine.bodies(entity->id)[pull.link];
      actuation.wrenches.push_back(
          wrench_of(pull, body, engine.states()[body.index], model.links[pull.link], mass_kg(model)));
    }
}

void Pulls::save(ByteWriter& w) const {
  for (const Pull& pull : pulls_) Pull::state(pull, [&](const auto& member) { write(w, member); });
}

bool Pulls::load(std::span<const Owned<Entity>> entities, ByteReader& r) {
  while (r.ok() && r.remaining() > 0) {
    Pull pull;
    Pull::state(pull, [&](auto& member) { read(r, member); });
    const auto entity = std::find_if(entities.begin(), entities.end(),
                                     [&](const auto& each) { return each->serial == pull.serial; });
    if (!r.ok() || entity == entities.end() || pull.link >= (*entity)->instance.model->links.size() ||
        !is_finite(pull.point_L) || !is_finite(pull.target_W))
      return false;
    pulls_.push_back(pull);
  }
  return r.ok();
}

}  // namespace sandlot
