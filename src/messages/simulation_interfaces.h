#pragma once
/// simulation_interfaces 2.1.0: a common interface of simulators. Its services: messages/services.h.
/// long file: one list of messages
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"

namespace sandlot::msg::simulation {

/// How a request ended.
struct Result {
  static constexpr const char* ros_type = "simulation_interfaces/msg/Result";
  static constexpr std::uint8_t feature_unsupported = 0;
  static constexpr std::uint8_t ok = 1;
  static constexpr std::uint8_t not_found = 2;
  static constexpr std::uint8_t incorrect_state = 3;
  static constexpr std::uint8_t operation_failed = 4;
  std::uint8_t result = 0;
  std::string error_message;
  static void constants(auto&& visit) {
    visit("RESULT_FEATURE_UNSUPPORTED", feature_unsupported);
    visit("RESULT_OK", ok);
    visit("RESULT_NOT_FOUND", not_found);
    visit("RESULT_INCORRECT_STATE", incorrect_state);
    visit("RESULT_OPERATION_FAILED", operation_failed);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"result", "1", "Code of the result: RESULT_..., or above 100 a number of the service."},
          s.result);
    visit(Field{"error_message", "", "Description of the failure."}, s.error_message);
  }
};

/// The space something takes.
struct Bounds {
  static constexpr const char* ros_type = "simulation_interfaces/msg/Bounds";
  static constexpr std::uint8_t empty = 0;
  static constexpr std::uint8_t box = 1;
  static constexpr std::uint8_t convex_hull = 2;
  static constexpr std::uint8_t sphere = 3;
  std::uint8_t type = 0;
  std::vector<Vec3> points;
  static void constants(auto&& visit) {
    visit("TYPE_EMPTY", empty);
    visit("TYPE_BOX", box);
    visit("TYPE_CONVEX_HULL", convex_hull);
    visit("TYPE_SPHERE", sphere);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"type", "1", "Meaning of `points`."}, s.type);
    visit(Field{"points", "m", "Two corners of a box, points of a hull, or centre and (radius, 0, 0)."},
          s.points);
  }
};

/// What an entity is.
struct EntityCategory {
  static constexpr const char* ros_type = "simulation_interfaces/msg/EntityCategory";
  static constexpr std::uint8_t object = 0;
  static constexpr std::uint8_t robot = 1;
  static constexpr std::uint8_t human = 2;
  static constexpr std::uint8_t dynamic_object = 4;
  static constexpr std::uint8_t static_object = 5;
  std::uint8_t category = 0;
  static void constants(auto&& visit) {
    visit("CATEGORY_OBJECT", object);
    visit("CATEGORY_ROBOT", robot);
    visit("CATEGORY_HUMAN", human);
    visit("CATEGORY_DYNAMIC_OBJECT", dynamic_object);
    visit("CATEGORY_STATIC_OBJECT", static_object);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"category", "1", "Category of the entity, CATEGORY_..."}, s.category);
  }
};

/// Chooses by tags.
struct TagsFilter {
  static constexpr const char* ros_type = "simulation_interfaces/msg/TagsFilter";
  static constexpr std::uint8_t any = 0;
  static constexpr std::uint8_t all = 1;
  std::vector<std::string> tags;
  std::uint8_t filter_mode = 0;
  static void constants(auto&& visit) {
    visit("FILTER_MODE_ANY", any);
    visit("FILTER_MODE_ALL", all);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"tags", "", "Tags to look for; none: everything fits."}, s.tags);
    visit(
        Field{"filter_mode", "1", "Way the tags are combined. 0: one of them is enough, 1: all are needed."},
        s.filter_mode);
  }
};

/// Chooses entities.
struct EntityFilters {
  static constexpr const char* ros_type = "simulation_interfaces/msg/EntityFilters";
  std::string filter;
  std::vector<EntityCategory> categories;
  TagsFilter tags;
  Bounds bounds;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"filter", "", "POSIX extended regular expression on the name; empty: every name fits."},
          s.filter);
    visit(Field{"categories", "", "Categories of the entities; none: every category fits."}, s.categories);
    visit(Field{"tags", "", "Filter on the tags."}, s.tags);
    visit(Field{"bounds", "", "Bounds that the entities overlap; empty: no limit."}, s.bounds);
  }
};

/// What is known of an entity.
struct EntityInfo {
  static constexpr const char* ros_type = "simulation_interfaces/msg/EntityInfo";
  EntityCategory category;
  std::string description;
  std::vector<std::string> tags;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"category", "", "Category of the entity."}, s.category);
    visit(Field{"description", "", "Description of the entity."}, s.description);
    visit(Field{"tags", "", "Tags of the entity."}, s.tags);
  }
};

/// Where an entity is and how it moves.
struct EntityState {
  static constexpr const char* ros_type = "simulation_interfaces/msg/EntityState";
  Header header;
  Pose pose;
  Twist twist;
  Accel acceleration;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"pose", "", "Pose in header.frame_id."}, s.pose);
    visit(Field{"twist", "", "Velocity in header.frame_id."}, s.twist);
    visit(Field{"acceleration", "", "Acceleration in header.frame_id."}, s.acceleration);
  }
};

/// A pose of the world that has a name.
struct NamedPose {
  static constexpr const char* ros_type = "simulation_interfaces/msg/NamedPose";
  std::string name;
  std::string description;
  std::vector<std::string> tags;
  Pose pose;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the pose."}, s.name);
    visit(Field{"description", "", "Description of the pose."}, s.description);
    visit(Field{"tags", "", "Tags of the pose."}, s.tags);
    visit(Field{"pose", "", "Pose in the world."}, s.pose);
  }
};

/// A file, by name or as text.
struct Resource {
  static constexpr const char* ros_type = "simulation_interfaces/msg/Resource";
  std::string uri;
  std::string resource_string;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"uri", "", "Address of the resource."}, s.uri);
    visit(Field{"resource_string", "", "Text of the resource, instead of the address."}, s.resource_string);
  }
};

/// What the simulator is doing.
struct SimulationState {
  static constexpr const char* ros_type = "simulation_interfaces/msg/SimulationState";
  static constexpr std::uint8_t stopped = 0;
  static constexpr std::uint8_t playing = 1;
  static constexpr std::uint8_t paused = 2;
  static constexpr std::uint8_t quitting = 3;
  static constexpr std::uint8_t no_world = 4;
  static constexpr std::uint8_t loading_world = 5;
  std::uint8_t state = 0;
  static void constants(auto&& visit) {
    visit("STATE_STOPPED", stopped);
    visit("STATE_PLAYING", playing);
    visit("STATE_PAUSED", paused);
    visit("STATE_QUITTING", quitting);
    visit("STATE_NO_WORLD", no_world);
    visit("STATE_LOADING_WORLD", loading_world);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"state", "1", "State of the simulation, STATE_..."}, s.state);
  }
};

/// What the simulator can do.
struct SimulatorFeatures {
  static constexpr const char* ros_type = "simulation_interfaces/msg/SimulatorFeatures";
  std::vector<std::uint16_t> features;
  std::vector<std::string> spawn_formats;
  std::string custom_info;
  static void constants(auto&& visit) {
    visit("SPAWNING", std::uint8_t{0});
    visit("DELETING", std::uint8_t{1});
    visit("NAMED_POSES", std::uint8_t{2});
    visit("POSE_BOUNDS", std::uint8_t{3});
    visit("ENTITY_TAGS", std::uint8_t{4});
    visit("ENTITY_BOUNDS", std::uint8_t{5});
    visit("ENTITY_BOUNDS_BOX", std::uint8_t{6});
    visit("ENTITY_BOUNDS_CONVEX", std::uint8_t{7});
    visit("ENTITY_CATEGORIES", std::uint8_t{8});
    visit("SPAWNING_RESOURCE_STRING", std::uint8_t{9});
    visit("ENTITY_STATE_GETTING", std::uint8_t{10});
    visit("ENTITY_STATE_SETTING", std::uint8_t{11});
    visit("ENTITY_INFO_GETTING", std::uint8_t{12});
    visit("ENTITY_INFO_SETTING", std::uint8_t{13});
    visit("SPAWNABLES", std::uint8_t{14});
    visit("SIMULATION_RESET", std::uint8_t{20});
    visit("SIMULATION_RESET_TIME", std::uint8_t{21});
    visit("SIMULATION_RESET_STATE", std::uint8_t{22});
    visit("SIMULATION_RESET_SPAWNED", std::uint8_t{23});
    visit("SIMULATION_STATE_GETTING", std::uint8_t{24});
    visit("SIMULATION_STATE_SETTING", std::uint8_t{25});
    visit("SIMULATION_STATE_PAUSE", std::uint8_t{26});
    visit("STEP_SIMULATION_SINGLE", std::uint8_t{31});
    visit("STEP_SIMULATION_MULTIPLE", std::uint8_t{32});
    visit("STEP_SIMULATION_ACTION", std::uint8_t{33});
    visit("WORLD_LOADING", std::uint8_t{40});
    visit("WORLD_RESOURCE_STRING", std::uint8_t{41});
    visit("WORLD_TAGS", std::uint8_t{42});
    visit("WORLD_UNLOADING", std::uint8_t{43});
    visit("WORLD_INFO_GETTING", std::uint8_t{44});
    visit("AVAILABLE_WORLDS", std::uint8_t{45});
    visit("SPAWNING_ENTITIES", std::uint8_t{50});
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"features", "1", "Features of the simulator."}, s.features);
    visit(Field{"spawn_formats", "", "Extensions of files it can spawn."}, s.spawn_formats);
    visit(Field{"custom_info", "", "Further information."}, s.custom_info);
  }
};

/// An entity to be made.
struct SpawnEntity {
  static constexpr const char* ros_type = "simulation_interfaces/msg/SpawnEntity";
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

/// How the making of an entity ended.
struct SpawnResult {
  static constexpr const char* ros_type = "simulation_interfaces/msg/SpawnResult";
  Result result;
  std::string entity_name;
  static void constants(auto&& visit) {
    visit("NAME_NOT_UNIQUE", std::uint8_t{101});
    visit("NAME_INVALID", std::uint8_t{102});
    visit("UNSUPPORTED_FORMAT", std::uint8_t{103});
    visit("NO_RESOURCE", std::uint8_t{104});
    visit("NAMESPACE_INVALID", std::uint8_t{105});
    visit("RESOURCE_PARSE_ERROR", std::uint8_t{106});
    visit("MISSING_ASSETS", std::uint8_t{107});
    visit("UNSUPPORTED_ASSETS", std::uint8_t{108});
    visit("INVALID_POSE", std::uint8_t{109});
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"result", "", "Result of the request."}, s.result);
    visit(Field{"entity_name", "", "Name of the new entity."}, s.entity_name);
  }
};

/// An entity that could be made.
struct Spawnable {
  static constexpr const char* ros_type = "simulation_interfaces/msg/Spawnable";
  Resource entity_resource;
  std::string description;
  Bounds spawn_bounds;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"entity_resource", "", "Model of the entity."}, s.entity_resource);
    visit(Field{"description", "", "Description of the model."}, s.description);
    visit(Field{"spawn_bounds", "", "Bounds of the space that the entity takes."}, s.spawn_bounds);
  }
};

/// A world that could be loaded.
struct WorldResource {
  static constexpr const char* ros_type = "simulation_interfaces/msg/WorldResource";
  std::string name;
  Resource world_resource;
  std::string description;
  std::vector<std::string> tags;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the world."}, s.name);
    visit(Field{"world_resource", "", "File of the world."}, s.world_resource);
    visit(Field{"description", "", "Description of the world."}, s.description);
    visit(Field{"tags", "", "Tags of the world."}, s.tags);
  }
};

}  // namespace sandlot::msg::simulation
