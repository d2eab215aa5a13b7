/// Services of simulation_interfaces about what stands in the world.
#include <algorithm>

#include "server/services/name_filter.h"
#include "server/services/result.h"
#include "sim/world/lookup.h"

namespace sandlot::server::service {
namespace {

using msg::simulation::Bounds;
using msg::simulation::DeleteEntity;
using msg::simulation::EntityCategory;
using msg::simulation::GetEntities;
using msg::simulation::GetEntityState;
using msg::simulation::SetEntityState;

std::uint8_t category_of(const Simulation::Entity& entity) {
  if (entity.instance.is_robot) return EntityCategory::robot;
  return entity.instance.model->is_static ? EntityCategory::static_object : EntityCategory::dynamic_object;
}

/// Submits a request about an entity and answers when it has been carried out; while the run is paused at once, since the
/// next tick may be far away.
template <class S>
void submit_request(Session& session, ClientId client, const Reply<S>& reply, const std::string& name,
                    Request request) {
  if (!session.simulation().find_instance(name))
    return reply_result(reply, SimResult::not_found, no_entity(name).what);
  const bool waits = session.report().state == Session::State::paused;
  const auto submitted = session.submit(std::move(request), {Source::Kind::admin, client},
                                        [reply](const Status& status) { reply_status(reply, status); });
  if (!submitted) reply_result(reply, SimResult::operation_failed, submitted.error().text());
  else if (waits) reply_result(reply, SimResult::ok, "with the next tick");
}

}  // namespace

void get_entities(const ServiceContext& context, const GetEntities::Request& request,
                  const Reply<GetEntities>& reply) {
  const auto& filters = request.filters;
  GetEntities::Response no;
  const auto filter = NameFilter::compile(filters.filter);
  if (!filter) no.result = make_result(SimResult::operation_failed, filter.error().text());
  if (!filters.tags.tags.empty())
    no.result = make_result(SimResult::feature_unsupported, "entities have no tags");
  if (filters.bounds.type != Bounds::empty)
    no.result = make_result(SimResult::feature_unsupported, "bounds are not a filter here");
  if (!no.result.error_message.empty()) return reply(no);
  std::vector<std::uint8_t> categories;
  for (const EntityCategory& each : filters.categories) categories.push_back(each.category);
  context.host.post([reply, filter = *filter, categories](Session& session) {
    GetEntities::Response response;
    response.result = make_result(SimResult::ok);
    for (const auto& entity : session.simulation().entities()) {
      if (!filter.matches(entity->instance.name)) continue;
      if (!categories.empty() &&
          std::find(categories.begin(), categories.end(), category_of(*entity)) == categories.end())
        continue;
      response.entities.push_back(entity->instance.name);
    }
    reply(response);
  });
}

void get_entity_state(const ServiceContext& context, const GetEntityState::Request& request,
                      const Reply<GetEntityState>& reply) {
  context.host.post([reply, name = request.entity](Session& session) {
    GetEntityState::Response response;
    const Simulation& simulation = session.simulation();
    const Simulation::Entity* const entity = simulation.find_entity(name);
    if (!entity || entity->instance.name != name) {
      response.result = make_result(SimResult::not_found, no_entity(name).what);
      return reply(response);
    }
    response.result = make_result(SimResult::ok);
    response.state.header.stamp = simulation.now();
    response.state.header.frame_id = "world";
    response.state.pose = simulation.engine().pose(entity->id);
    const auto body = simulation.engine().bodies(entity->id).front();
    const Velocity& velocity = simulation.engine().states()[body.index].V_WB;
    response.state.twist.linear = velocity.linear;
    response.state.twist.angular = velocity.angular;
    reply(response);
  });
}

void set_entity_state(const ServiceContext& context, const SetEntityState::Request& request,
                      const Reply<SetEntityState>& reply) {
  using Response = SetEntityState::Response;
  if (request.set_twist || request.set_acceleration)
    return reply_result(reply, SimResult::feature_unsupported, "only poses can be set");
  const std::string& frame = request.state.header.frame_id;
  if (!frame.empty() && frame != "world")
    return reply_result(reply, Response::invalid_pose, "poses are in the frame 'world'");
  const Pose pose = request.state.pose;
  if (!is_finite(pose) || norm(pose.q) < 1e-6)
    return reply_result(reply, Response::invalid_pose, "the pose is not finite");
  context.host.post([client = context.client, reply, name = request.entity, set = request.set_pose,
                     pose](Session& session) {
    if (!set) return reply_result(reply, SimResult::ok);
    submit_request(session, client, reply, name, PoseRequest{name, pose});
  });
}

void delete_entity(const ServiceContext& context, const DeleteEntity::Request& request,
                   const Reply<DeleteEntity>& reply) {
  context.host.post([client = context.client, reply, name = request.entity](Session& session) {
    submit_request(session, client, reply, name, DeleteRequest{name});
  });
}

}  // namespace sandlot::server::service
