#pragma once
/// Services of simulation_interfaces 2.1.0 about entities, named poses and worlds; those about the run: messages/services.h.
/// long file: one list of messages
#include <cstdint>
#include <string>
#include <vector>

#include "messages/simulation_interfaces.h"

namespace sandlot::msg::simulation {

/// States of all entities that filters let through.
struct GetEntitiesStates {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntitiesStates";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntitiesStates_Request";
    EntityFilters filters;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"filters", "", "Filters of the entities; empty ones let all through."}, s.filters);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntitiesStates_Response";
    Result result;
    std::vector<std::string> entities;
    std::vector<EntityState> states;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"entities", "", "Names of the entities."}, s.entities);
      visit(Field{"states", "", "States of these entities."}, s.states);
    }
  };
};

/// Kind and description of an entity.
struct GetEntityInfo {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityInfo";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityInfo_Request";
    std::string entity;
    static void fields(auto& s, auto&& visit) { visit(Field{"entity", "", "Name of the entity."}, s.entity); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityInfo_Response";
    Result result;
    EntityInfo info;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"info", "", "Information about the entity."}, s.info);
    }
  };
};

/// Replaces the kind and description of an entity.
struct SetEntityInfo {
  static constexpr const char* ros_type = "simulation_interfaces/srv/SetEntityInfo";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SetEntityInfo_Request";
    std::string entity;
    EntityInfo info;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"entity", "", "Name of the entity."}, s.entity);
      visit(Field{"info", "", "New information about the entity."}, s.info);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SetEntityInfo_Response";
    Result result;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

/// Space that an entity takes.
struct GetEntityBounds {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityBounds";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityBounds_Request";
    std::string entity;
    static void fields(auto& s, auto&& visit) { visit(Field{"entity", "", "Name of the entity."}, s.entity); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityBounds_Response";
    Result result;
    Bounds bounds;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"bounds", "", "Bounds in the frame of the entity's canonical link."}, s.bounds);
    }
  };
};

/// Poses that the scenario names.
struct GetNamedPoses {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetNamedPoses";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetNamedPoses_Request";
    TagsFilter tags;
    static void fields(auto& s, auto&& visit) { visit(Field{"tags", "", "Filter on the tags."}, s.tags); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetNamedPoses_Response";
    Result result;
    std::vector<NamedPose> poses;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"poses", "", "Named poses."}, s.poses);
    }
  };
};

/// Free space about a named pose.
struct GetNamedPoseBounds {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetNamedPoseBounds";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetNamedPoseBounds_Request";
    std::string name;
    static void fields(auto& s, auto&& visit) { visit(Field{"name", "", "Name of the pose."}, s.name); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetNamedPoseBounds_Response";
    Result result;
    Bounds bounds;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"bounds", "", "Bounds in the frame of the pose."}, s.bounds);
    }
  };
};

/// Models that entities can be made of.
struct GetSpawnables {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetSpawnables";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetSpawnables_Request";
    std::vector<std::string> sources;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"sources", "", "Further sources to look in."}, s.sources);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetSpawnables_Response";
    Result result;
    std::vector<Spawnable> spawnables;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"spawnables", "", "Models by their addresses."}, s.spawnables);
    }
  };
};

/// Makes an entity.
struct SpawnOneEntity {
  static constexpr const char* ros_type = "simulation_interfaces/srv/SpawnEntity";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SpawnEntity_Request";
    std::string name;
    bool allow_renaming = false;
    Resource entity_resource;
    std::string entity_namespace;
    PoseStamped initial_pose;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"name", "", "Name of the new entity."}, s.name);
      visit(Field{"allow_renaming", "", "Whether another name may be given."}, s.allow_renaming);
      visit(Field{"entity_resource", "", "Model of the entity."}, s.entity_resource);
      visit(Field{"entity_namespace", "", "Prefix of the entity's topics."}, s.entity_namespace);
      visit(Field{"initial_pose", "", "Pose at the start."}, s.initial_pose);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SpawnEntity_Response";
    static constexpr std::uint8_t name_not_unique = 101;
    static constexpr std::uint8_t name_invalid = 102;
    static constexpr std::uint8_t unsupported_format = 103;
    static constexpr std::uint8_t no_resource = 104;
    static constexpr std::uint8_t namespace_invalid = 105;
    static constexpr std::uint8_t resource_parse_error = 106;
    static constexpr std::uint8_t missing_assets = 107;
    static constexpr std::uint8_t unsupported_assets = 108;
    static constexpr std::uint8_t invalid_pose = 109;
    Result result;
    std::string entity_name;
    static void constants(auto&& visit) {
      visit("NAME_NOT_UNIQUE", name_not_unique);
      visit("NAME_INVALID", name_invalid);
      visit("UNSUPPORTED_FORMAT", unsupported_format);
      visit("NO_RESOURCE", no_resource);
      visit("NAMESPACE_INVALID", namespace_invalid);
      visit("RESOURCE_PARSE_ERROR", resource_parse_error);
      visit("MISSING_ASSETS", missing_assets);
      visit("UNSUPPORTED_ASSETS", unsupported_assets);
      visit("INVALID_POSE", invalid_pose);
    }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"entity_name", "", "Name of the new entity."}, s.entity_name);
    }
  };
};

/// Makes several entities.
struct SpawnEntities {
  static constexpr const char* ros_type = "simulation_interfaces/srv/SpawnEntities";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SpawnEntities_Request";
    std::vector<SpawnEntity> spawn_requests;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"spawn_requests", "", "Entities to be made."}, s.spawn_requests);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SpawnEntities_Response";
    static constexpr std::uint8_t entities_spawn_failed = 150;
    Result result;
    std::vector<SpawnResult> results;
    static void constants(auto&& visit) { visit("ENTITIES_SPAWN_FAILED", entities_spawn_failed); }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"results", "", "Results, one per entity."}, s.results);
    }
  };
};

/// World that is loaded.
struct GetCurrentWorld {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetCurrentWorld";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetCurrentWorld_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetCurrentWorld_Response";
    static constexpr std::uint8_t no_world_loaded = 101;
    Result result;
    WorldResource world;
    static void constants(auto&& visit) { visit("NO_WORLD_LOADED", no_world_loaded); }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"world", "", "Present world."}, s.world);
    }
  };
};

/// Worlds that can be loaded.
struct GetAvailableWorlds {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetAvailableWorlds";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetAvailableWorlds_Request";
    std::vector<std::string> additional_sources;
    TagsFilter filter;
    bool offline_only = false;
    bool continue_on_error = false;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"additional_sources", "", "Further sources to look in."}, s.additional_sources);
      visit(Field{"filter", "", "Filter on the tags."}, s.filter);
      visit(Field{"offline_only", "", "Whether only this machine is searched."}, s.offline_only);
      visit(Field{"continue_on_error", "", "Whether sources that fail are passed over."},
            s.continue_on_error);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetAvailableWorlds_Response";
    static constexpr std::uint8_t default_sources_failed = 101;
    Result result;
    std::vector<WorldResource> worlds;
    static void constants(auto&& visit) { visit("DEFAULT_SOURCES_FAILED", default_sources_failed); }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"worlds", "", "Worlds by their addresses."}, s.worlds);
    }
  };
};

/// Replaces the world by another one.
struct LoadWorld {
  static constexpr const char* ros_type = "simulation_interfaces/srv/LoadWorld";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/LoadWorld_Request";
    Resource world_resource;
    bool fail_on_unsupported_element = false;
    bool ignore_missing_or_unsupported_assets = false;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"world_resource", "", "Scenario or world to be loaded."}, s.world_resource);
      visit(Field{"fail_on_unsupported_element", "", "Whether elements that are not supported are errors."},
            s.fail_on_unsupported_element);
      visit(Field{"ignore_missing_or_unsupported_assets", "",
                  "Whether assets that are missing or not supported are passed over."},
            s.ignore_missing_or_unsupported_assets);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/LoadWorld_Response";
    static constexpr std::uint8_t unsupported_format = 101;
    static constexpr std::uint8_t no_resource = 102;
    static constexpr std::uint8_t resource_parse_error = 103;
    static constexpr std::uint8_t missing_assets = 104;
    static constexpr std::uint8_t unsupported_assets = 105;
    static constexpr std::uint8_t unsupported_elements = 106;
    Result result;
    WorldResource world;
    static void constants(auto&& visit) {
      visit("UNSUPPORTED_FORMAT", unsupported_format);
      visit("NO_RESOURCE", no_resource);
      visit("RESOURCE_PARSE_ERROR", resource_parse_error);
      visit("MISSING_ASSETS", missing_assets);
      visit("UNSUPPORTED_ASSETS", unsupported_assets);
      visit("UNSUPPORTED_ELEMENTS", unsupported_elements);
    }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"world", "", "World that was loaded."}, s.world);
    }
  };
};

/// Removes the world.
struct UnloadWorld {
  static constexpr const char* ros_type = "simulation_interfaces/srv/UnloadWorld";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/UnloadWorld_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/UnloadWorld_Response";
    static constexpr std::uint8_t no_world_loaded = 101;
    Result result;
    static void constants(auto&& visit) { visit("NO_WORLD_LOADED", no_world_loaded); }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

}  // namespace sandlot::msg::simulation
