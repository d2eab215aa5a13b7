/// Services of simulation_interfaces about worlds and their named poses.
#include <algorithm>
#include <filesystem>

#include "base/text.h"
#include "console/command.h"
#include "server/services/entity_filter.h"
#include "sim/load/load.h"

namespace sandlot::server::service {
namespace {

using msg::simulation::GetAvailableWorlds;
using msg::simulation::GetCurrentWorld;
using msg::simulation::GetNamedPoseBounds;
using msg::simulation::GetNamedPoses;
using msg::simulation::LoadWorld;
using msg::simulation::UnloadWorld;
using msg::simulation::WorldResource;

WorldResource world_of(const std::string& name, const std::string& file) {
  WorldResource out;
  out.name = name;
  if (!file.empty())
    out.world_resource.uri = "file://" + std::filesystem::absolute(file).lexically_normal().string();
  return out;
}

/// What a request to load a world comes to.
struct Loaded {
  std::uint8_t code = SimResult::ok;
  std::string why;
  std::string name, file;
  std::vector<std::byte> snapshot;  ///< of its first state
};
Loaded refused_load(std::uint8_t code, const std::string& why) { return {code, why, "", "", {}}; }

/// Reads and builds a world. It starts no process, and brings no plugin along that was not on this machine's disk.
Loaded loaded_world(const Session& session, const Console::Options& console,
                    const LoadWorld::Request& request) {
  using Code = LoadWorld::Response;
  const auto& resource = request.world_resource;
  const bool by_text = resource.uri.empty();
  if (by_text && resource.resource_string.empty())
    return refused_load(Code::no_resource, "uri and resource_string are empty");
  std::string file;
  if (by_text) {
    std::string format = format_of_text(resource.resource_string);
    const std::size_t begin = resource.resource_string.find_first_not_of(" \t\r\n");
    const bool xml = begin != std::string::npos && resource.resource_string[begin] == '<';
    if (format.empty() && xml)
      return refused_load(Code::unsupported_format,
                          "resource_string is neither SDF, nor URDF, nor a scenario");
    file = (console.folder.empty() ? "." : console.folder) + "/resource_string." +
           (format.empty() ? "yaml" : format);
  } else {
    const auto found = console::resource_file(console, resource.uri, console::world_files(console));
    if (!found) return refused_load(SimResult::not_found, found.error().text());
    file = *found;
  }
  LoadOptions options;
  options.paths = console.paths;
  if (by_text) options.text = resource.resource_string;
  options.skip_missing = request.ignore_missing_or_unsupported_assets;
  Diagnostics diagnostics;
  auto setup = sandlot::load(file, options, diagnostics);
  if (!setup) {
    Diagnostics ignored;
    options.skip_missing = true;
    const bool by_assets = static_cast<bool>(sandlot::load(file, options, ignored));
    return refused_load(by_assets ? Code::missing_assets : Code::resource_parse_error, setup.error().text());
  }
  if (request.fail_on_unsupported_element && !diagnostics.warnings.empty())
    return refused_load(Code::unsupported_elements, diagnostics.warnings.front().text());
  if (by_text && !setup->plugins.empty())
    return refused_load(SimResult::operation_failed, "a text loads no plugins: they are code");
  SimulationOptions how = session.simulation_options();
  how.start_programs = false;
  Diagnostics ignored;
  Loaded out;
  out.name = setup->name;
  if (!by_text) out.file = file;
  auto made = Simulation::create(std::move(*setup), how, ignored);
  if (!made) return refused_load(Code::resource_parse_error, made.error().text());
  out.snapshot = (*made)->snapshot();
  return out;
}

}  // namespace

void get_named_poses(const ServiceContext& context, const GetNamedPoses::Request& request,
                     const Reply<GetNamedPoses>& reply) {
  GetNamedPoses::Response response;
  response.result = check(request.tags);
  if (response.result.result != SimResult::ok) return reply(response);
  context.host.post([reply, filter = request.tags, response](Session& session) mutable {
    for (const model::NamedPose& each : session.simulation().setup().poses) {
      if (!fits(filter, each.tags)) continue;
      auto& made = response.poses.emplace_back();
      made.name = each.name;
      made.description = each.description;
      made.tags = each.tags;
      made.pose = each.X_WP;
    }
    reply(response);
  });
}

void get_named_pose_bounds(const ServiceContext& context, const GetNamedPoseBounds::Request& request,
                           const Reply<GetNamedPoseBounds>& reply) {
  context.host.post([reply, name = request.name](Session& session) {
    GetNamedPoseBounds::Response response;
    std::vector<std::string> known;
    for (const model::NamedPose& each : session.simulation().setup().poses) {
      known.push_back(each.name);
      if (each.name != name) continue;
      Bounds box;
      if (each.size_m) {
        box.include(0.5 * *each.size_m);
        box.include(-0.5 * *each.size_m);
      }
      response.bounds = bounds_message(box);
      response.result = make_result(SimResult::ok);
      return reply(response);
    }
    const std::string hint = known.empty() ? "the scenario names none" : suggestion(name, known);
    response.result = make_result(SimResult::not_found,
                                  "there is no pose '" + name.substr(0, 100) + "'; " + hint);
    reply(response);
  });
}

void get_current_world(const ServiceContext& context, const GetCurrentWorld::Request&,
                       const Reply<GetCurrentWorld>& reply) {
  context.host.post([reply, file = context.host.memory().world](Session& session) {
    GetCurrentWorld::Response response;
    response.result = make_result(SimResult::ok);
    response.world = world_of(session.simulation().setup().name, file);
    reply(response);
  });
}

void get_available_worlds(const ServiceContext& context, const GetAvailableWorlds::Request& request,
                          const Reply<GetAvailableWorlds>& reply) {
  GetAvailableWorlds::Response response;
  if (!request.filter.tags.empty()) {
    response.result = make_result(SimResult::feature_unsupported, "worlds have no tags");
    return reply(response);
  }
  if (!request.additional_sources.empty() && !request.continue_on_error) {
    response.result = make_result(
        SimResult::operation_failed,
        "'" + request.additional_sources.front().substr(0, 100) +
            "' is not a source here: worlds are Sandlot's own and those in the run's folder");
    return reply(response);
  }
  for (const console::ModelFile& each : console::world_files(context.host.console().options())) {
    response.worlds.push_back(world_of(each.name, each.file));
    response.worlds.back().description = each.help;
  }
  response.result = make_result(SimResult::ok);
  reply(response);
}

void load_world(const ServiceContext& context, const LoadWorld::Request& request,
                const Reply<LoadWorld>& reply) {
  ServiceHost& host = context.host;
  host.post([reply, request, &console = host.console(), &memory = host.memory(),
             back = host.way_back()](Session& session) {
    auto loaded = std::make_shared<Loaded>(loaded_world(session, console.options(), request));
    if (loaded->code != SimResult::ok) return reply_result(reply, loaded->code, loaded->why);
    session.pause();
    session.load(std::move(loaded->snapshot), [reply, loaded, back, &memory, &session](const Status& status) {
      if (!status) return reply_status(reply, status);
      // The session counts the epoch before it says that it is done.
      back([reply, loaded, &memory, epoch = session.epoch()] {
        memory.world = loaded->file;
        memory.stopped_at = epoch;
        LoadWorld::Response response;
        response.result = make_result(SimResult::ok);
        response.world = world_of(loaded->name, loaded->file);
        reply(response);
      });
    });
  });
}

void unload_world(const ServiceContext&, const UnloadWorld::Request&, const Reply<UnloadWorld>& reply) {
  reply_result(reply, SimResult::feature_unsupported, "a run always has a world: load another one");
}

}  // namespace sandlot::server::service
