/// Services of simulation_interfaces that make entities.
#include <algorithm>

#include "base/text.h"
#include "console/command.h"
#include "server/services/frames.h"
#include "server/services/result.h"
#include "sim/load/load.h"

namespace sandlot::server::service {
namespace {

using msg::simulation::GetSpawnables;
using msg::simulation::Spawnable;
using msg::simulation::SpawnEntities;
using msg::simulation::SpawnOneEntity;
using msg::simulation::SpawnResult;
using Code = SpawnOneEntity::Response;
using WantedEntity = msg::simulation::SpawnEntity;

constexpr std::size_t longest_name = 100, most_entities = 1000;

struct Prepared {
  SpawnResult result;
  model::Instance instance;  ///< where the result is ok
};

Prepared refused(std::uint8_t code, const std::string& why) {
  Prepared out;
  out.result.result = make_result(code, why);
  return out;
}

/// The model, loaded and nothing else.
Prepared load_model(const Console::Options& options, const msg::simulation::Resource& resource) {
  if (resource.uri.empty() && resource.resource_string.empty())
    return refused(Code::no_resource, "uri and resource_string are empty");
  std::string file;
  if (!resource.uri.empty()) {
    const auto found = console::resource_file(options, resource.uri, console::model_files(options));
    if (!found) return refused(SimResult::not_found, found.error().text());
    file = *found;
    const auto has = [&](const char* extension) { return file.ends_with(extension); };
    if (!starts_with(file, "builder:") && !has(".sdf") && !has(".world") && !has(".urdf") && !has(".xacro"))
      return refused(Code::unsupported_format,
                     "'" + resource.uri.substr(0, 200) + "' is neither SDF nor URDF");
  } else if (format_of_text(resource.resource_string).empty()) {
    return refused(Code::unsupported_format, "resource_string is neither SDF (<sdf>) nor URDF (<robot>)");
  }
  const auto load = [&](bool skip_missing) {
    Diagnostics ignored;
    return resource.uri.empty() ? load_instance_text(resource.resource_string, options.folder, "", ignored,
                                                     options.paths, skip_missing)
                                : load_instance(file, "", {}, ignored, options.paths, skip_missing);
  };
  auto loaded = load(false);
  if (!loaded) {
    // If it can be read without them, its assets are what is wrong.
    const bool by_assets = static_cast<bool>(load(true));
    return refused(by_assets ? Code::missing_assets : Code::resource_parse_error, loaded.error().text());
  }
  Prepared out;
  out.result.result = make_result(SimResult::ok);
  out.instance = std::move(*loaded);
  return out;
}

/// The pose in the world, or why there is none.
Prepared place(const Simulation& simulation, const msg::PoseStamped& wanted) {
  constexpr double most_m = 1e6;
  const auto frame = find_frame(simulation, wanted.header.frame_id);
  if (!frame)
    return refused(Code::invalid_pose, "there is no frame '" + wanted.header.frame_id.substr(0, 100) + "'");
  if (!is_finite(wanted.pose) || norm(wanted.pose.q) < 1e-6)
    return refused(Code::invalid_pose, "the pose is not finite, or its quaternion is zero");
  Prepared out;
  out.result.result = make_result(SimResult::ok);
  out.instance.X_WM = frame->X_WF * Pose{wanted.pose.p, normalised(wanted.pose.q)};
  if (!(norm(out.instance.X_WM.p) <= most_m))
    return refused(Code::invalid_pose, "the pose is farther away than 1000 km");
  return out;
}

/// Checks a request and makes what it asks for.
/// @param names  of those that the same call has made before
Prepared prepare(const Session& session, const Console::Options& options, const WantedEntity& wanted,
                 std::vector<std::string>& names) {
  const Simulation& simulation = session.simulation();
  const Prepared placed = place(simulation, wanted.initial_pose);
  if (placed.result.result.result != SimResult::ok) return placed;
  const std::string& name = wanted.name;
  if (!wanted.allow_renaming && !name.empty() && (sanitised(name) != name || name.size() > longest_name))
    return refused(Code::name_invalid, "names have letters, digits, _ and -, and at most 100 of them");
  Prepared out = load_model(options, wanted.entity_resource);
  if (out.result.result.result != SimResult::ok) return out;
  const auto taken = [&](const std::string& each) {
    return simulation.is_taken(each) || std::find(names.begin(), names.end(), each) != names.end();
  };
  const std::string given = (name.empty() ? out.instance.model->name : name).substr(0, longest_name);
  if (given.empty() && !wanted.allow_renaming) return refused(Code::name_invalid, "the entity has no name");
  std::string chosen = given.empty() ? "entity" : sanitised(given);
  if (taken(chosen)) {
    if (!wanted.allow_renaming) return refused(Code::name_not_unique, "there is a '" + chosen + "' already");
    for (int i = 2;; ++i)
      if (std::string other = chosen + std::to_string(i); !taken(other)) {
        chosen = std::move(other);
        break;
      }
  }
  // An entity's topics begin with its name, and with nothing else.
  std::string_view space = wanted.entity_namespace;
  if (starts_with(space, "/")) space.remove_prefix(1);
  if (!space.empty() && space != chosen) {
    for (const std::string_view part : split(space, '/'))
      if (part.empty() || sanitised(part) != part || part.find('-') != std::string_view::npos ||
          (part.front() >= '0' && part.front() <= '9'))
        return refused(Code::namespace_invalid,
                       "'" + std::string(space.substr(0, 100)) + "' is not a namespace");
    return refused(SimResult::feature_unsupported,
                   "topics of an entity begin with its name; leave the namespace out");
  }
  names.push_back(chosen);
  out.instance.name = out.instance.original_name = chosen;
  out.instance.X_WM = placed.instance.X_WM;
  out.result.entity_name = chosen;
  return out;
}

/// Makes entities one after the other; `done` gets a result for each, when all have been carried out, or at once while the
/// run is paused.
void spawn(Session& session, ClientId client, const Console::Options& options,
           std::span<const WantedEntity> wanted, std::function<void(const std::vector<SpawnResult>&)> done) {
  struct Call {
    std::vector<SpawnResult> results;
    std::function<void(const std::vector<SpawnResult>&)> done;
    ~Call() { done(results); }
  };
  const auto call = std::make_shared<Call>();
  call->done = std::move(done);
  call->results.resize(wanted.size());
  const bool waits = session.report().state == Session::State::paused;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    Prepared made = prepare(session, options, wanted[i], names);
    SpawnResult& result = call->results[i];
    result = made.result;
    if (result.result.result != SimResult::ok) continue;
    if (waits) result.result.error_message = "with the next tick";
    const auto fail = [](SpawnResult& of, const Error& why) {
      of.result = make_result(SimResult::operation_failed, why.text());
      of.entity_name.clear();
    };
    Session::Done outcome;
    if (!waits)
      outcome = [call, i, fail](const Status& status) {
        if (!status) fail(call->results[i], status.error());
      };
    const auto submitted = session.submit(SpawnRequest{std::move(made.instance)},
                                          {Source::Kind::admin, client}, std::move(outcome));
    if (!submitted) fail(result, submitted.error());
  }
}

}  // namespace

void spawn_entity(const ServiceContext& context, const SpawnOneEntity::Request& request,
                  const Reply<SpawnOneEntity>& reply) {
  WantedEntity wanted;
  wanted.name = request.name;
  wanted.allow_renaming = request.allow_renaming;
  wanted.entity_resource = request.entity_resource;
  wanted.entity_namespace = request.entity_namespace;
  wanted.initial_pose = request.initial_pose;
  context.host.post([client = context.client, &console = context.host.console(), reply,
                     wanted](Session& session) {
    spawn(session, client, console.options(), {&wanted, 1}, [reply](const std::vector<SpawnResult>& results) {
      reply({results.front().result, results.front().entity_name});
    });
  });
}

void spawn_entities(const ServiceContext& context, const SpawnEntities::Request& request,
                    const Reply<SpawnEntities>& reply) {
  if (request.spawn_requests.size() > most_entities)
    return reply_result(reply, SimResult::operation_failed, "more than 1000 entities are asked for at once");
  context.host.post([client = context.client, &console = context.host.console(), reply,
                     wanted = request.spawn_requests](Session& session) {
    spawn(session, client, console.options(), wanted, [reply](const std::vector<SpawnResult>& results) {
      SpawnEntities::Response response;
      response.results = results;
      const auto failed = std::count_if(results.begin(), results.end(), [](const SpawnResult& each) {
        return each.result.result != SimResult::ok;
      });
      response.result = failed == 0
                            ? make_result(SimResult::ok)
                            : make_result(SpawnEntities::Response::entities_spawn_failed,
                                          std::to_string(failed) + " of " + std::to_string(results.size()) +
                                              " entities were not made");
      reply(response);
    });
  });
}

void get_spawnables(const ServiceContext& context, const GetSpawnables::Request& request,
                    const Reply<GetSpawnables>& reply) {
  GetSpawnables::Response response;
  const auto add = [&](std::string uri, std::string help) {
    Spawnable& made = response.spawnables.emplace_back();
    made.entity_resource.uri = std::move(uri);
    made.description = std::move(help);
  };
  for (const console::ModelFile& each : console::model_files(context.host.console().options()))
    add("model://" + each.name.substr(each.name.find('/') + 1), each.help);
  for (auto& [uri, help] : built_models()) add(uri, help);
  std::string unknown;
  for (const std::string& each : request.sources)
    unknown += (unknown.empty() ? "sources that are not known here: '" : "', '") + each.substr(0, 100);
  response.result = make_result(SimResult::ok, unknown.empty() ? "" : unknown + "'");
  reply(response);
}

}  // namespace sandlot::server::service
