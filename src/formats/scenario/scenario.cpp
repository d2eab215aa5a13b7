#include "formats/scenario/scenario.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/read.h"
#include "base/text.h"
#include "files/yaml.h"
#include "formats/scenario/spec.h"
#include "formats/scenario/tree.h"

namespace sandlot::formats {
namespace {

namespace spec = scenario_spec;

bool is_identifier(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  if (name.empty() || name.size() > 100 || !is_letter(name.front())) return false;
  return std::all_of(name.begin(), name.end(),
                     [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

Result<Placement> read_distribution(const Node& node, const spec::Distribution& read, int count,
                                    const std::string& path) {
  if (read.grid.has_value() == read.uniform.has_value())
    return node.error("expected one of 'grid' and 'uniform'", "`sandlot list distributions` shows their keys",
                      path);
  Placement placement;
  placement.place = node.place();
  if (read.grid) {
    placement.kind = Placement::Kind::grid;
    placement.centre_m = read.grid->centre_m;
    placement.spacing_m = read.grid->spacing_m;
  } else {
    placement.kind = Placement::Kind::uniform;
    placement.centre_m = read.uniform->centre_m;
    const spec::Uniform& uniform = *read.uniform;
    if (uniform.density_per_m2 ? uniform.width_m || uniform.height_m : !uniform.width_m || !uniform.height_m)
      return node.find("uniform")->error("the size of the area is not clear",
                                         "give width and height, or density alone", path + "/uniform");
    const double side_m = std::sqrt(count / uniform.density_per_m2.value_or(1));
    placement.width_m = uniform.width_m.value_or(side_m);
    placement.height_m = uniform.height_m.value_or(side_m);
    placement.clearance_m = uniform.clearance_m;
    placement.wall_height_m = uniform.wall_height_m;
  }
  return placement;
}

/// Text of a key of a kind's map, taken out of it.
Result<std::string> take_text(Node& map, const char* key, const std::string& otherwise,
                              const std::string& path) {
  const Node* const value = map.find(key);
  if (!value || value->is_null()) return otherwise;
  if (!value->is_scalar()) return wrong_type(*value, "text", path + "/" + key);
  std::string text = value->text();
  map.erase(key);
  return text;
}

Result<model::ControllerDecl> read_controller(const Node& node, const std::string& path) {
  model::ControllerDecl decl;
  decl.place = node.place();
  decl.name = "controller";
  if (node.is_scalar()) {
    decl.kind = node.text();
    decl.config = Node::map(node.place());
  } else if (node.is_map()) {
    decl.config = node;
    SL_ASSIGN(decl.name, take_text(decl.config, "name", decl.name, path));
    SL_ASSIGN(decl.kind, take_text(decl.config, "kind", "", path));
  } else {
    return wrong_type(node, "the name of a kind or a map with 'kind'", path);
  }
  if (decl.kind.empty()) return node.error("the kind of controller is missing", "write kind: wander", path);
  if (decl.name.empty()) return node.error("the controller's name is empty", "", path);
  return decl;
}

/// A list of elements of the world, each with its kind and a name.
Status read_elements(const Node& list, const char* key, std::vector<model::ElementDecl>& out) {
  if (list.is_null()) return {};
  const std::string path = std::string("/") + key;
  constexpr std::size_t most = 10'000;
  if (!list.is_sequence()) return wrong_type(list, "a list of maps with 'kind'", path);
  if (list.items().size() > most) return list.error("there are more than 10000 of them", "", path);
  std::map<std::string, Place> names;
  for (std::size_t i = 0; i < list.items().size(); ++i) {
    const Node& node = list.items()[i];
    const std::string here = path + "/" + std::to_string(i);
    model::ElementDecl decl;
    decl.place = node.place();
    if (node.is_scalar()) {
      decl.kind = node.text();
      decl.config = Node::map(node.place());
    } else if (node.is_map()) {
      decl.config = node;
      SL_ASSIGN(decl.kind, take_text(decl.config, "kind", "", here));
    } else {
      return wrong_type(node, "the name of a kind or a map with 'kind'", here);
    }
    if (decl.kind.empty())
      return node.error("the kind is missing", std::string("`sandlot list ") + key + "` shows them", here);
    SL_ASSIGN(decl.name, take_text(decl.config, "name", decl.kind, here));
    if (decl.name.empty()) return node.error("the name is empty", "", here + "/name");
    if (const auto [known, fresh] = names.emplace(sanitised(decl.name), decl.place); !fresh)
      return node.error("'" + decl.name + "' is given twice in " + key,
                        "the other one is at " + to_string(known->second) + "; give each a 'name'", here);
    out.push_back(std::move(decl));
  }
  return {};
}

/// The controllers of a robot or a team.
template <class Keys>
Result<std::vector<model::ControllerDecl>> read_controllers(const Keys& robot, const std::string& path) {
  std::vector<model::ControllerDecl> out;
  if (!robot.controller.is_null() && !robot.controllers.is_null())
    return robot.controllers.error("'controller' and 'controllers' are both given", "keep one of them", path);
  if (!robot.controller.is_null()) {
    SL_ASSIGN(model::ControllerDecl decl, read_controller(robot.controller, path + "/controller"));
    out.push_back(std::move(decl));
  }
  if (robot.controllers.is_null()) return out;
  if (!robot.controllers.is_sequence()) return wrong_type(robot.controllers, "a list", path + "/controllers");
  std::map<std::string, Place> names;
  for (std::size_t i = 0; i < robot.controllers.items().size(); ++i) {
    const Node& node = robot.controllers.items()[i];
    const std::string here = path + "/controllers/" + std::to_string(i);
    SL_ASSIGN(model::ControllerDecl decl, read_controller(node, here));
    if (const auto [known, fresh] = names.emplace(sanitised(decl.name), decl.place); !fresh)
      return node.error("two controllers are called '" + decl.name + "'",
                        "the other one is at " + to_string(known->second) + "; give each a 'name'", here);
    out.push_back(std::move(decl));
  }
  return out;
}

Status check_devices(const Node& devices, const std::string& path) {
  if (devices.is_null()) return {};
  if (!devices.is_map()) return wrong_type(devices, "a map of names to devices", path);
  std::map<std::string, Place> names;
  for (const Node::Entry& entry : devices.entries()) {
    if (!entry.value.is_map() && !entry.value.is_null())
      return wrong_type(entry.value, "a map of the device's keys", path + "/" + entry.key);
    if (const auto [known, fresh] = names.emplace(sanitised(entry.key), entry.key_place); !fresh)
      return Error{"two devices have the address '" + sanitised(entry.key) + "'",
                   "the other one is at " + to_string(known->second), entry.key_place, path};
  }
  return {};
}

Result<Module> read_module(const Node& node, spec::Module& keys, const std::string& path) {
  Module module;
  const auto place_of = [&](const char* key) {
    const Node* const value = node.find(key);
    return value ? value->place() : node.place();
  };
  module.place = place_of("id");
  module.model_place = place_of("model");
  module.link_place = place_of("link");
  if (keys.id.empty()) return node.error("the module's id is empty", "", path + "/id");
  if (keys.model.empty())
    return node.error("the module's model is empty", "name a model file", path + "/model");
  module.id = keys.id;
  module.model = keys.model;
  module.link = keys.link;
  if (!keys.pose.is_null()) { SL_ASSIGN(module.X_LM, read_pose(keys.pose, path + "/pose")); }
  SL_TRY(check_devices(keys.devices, path + "/devices"));
  module.devices = std::move(keys.devices);
  return module;
}

/// Properties of the user's own. Their names are addresses of the robot.
Result<std::vector<model::PropertyDecl>> read_properties(const Node& node, const std::string& path) {
  constexpr std::size_t most = 1000;
  std::vector<model::PropertyDecl> out;
  if (node.is_null()) return out;
  if (!node.is_map()) return wrong_type(node, "a map of names to values", path);
  if (node.entries().size() > most) return node.error("there are more than 1000 properties", "", path);
  for (const Node::Entry& entry : node.entries()) {
    const std::string at = path + "/" + entry.key;
    if (!is_identifier(entry.key) || entry.key.size() > 100)
      return Error{"'" + entry.key.substr(0, 60) + "' cannot be the name of a property",
                   "letters, digits and _, no digit first", entry.key_place, path};
    for (const char* taken : {"pose", "twist", "errors", "in", "overlaps", "links", "joints", "criterion"})
      if (entry.key == taken)
        return Error{"'" + entry.key + "' is an address of every robot", "give the property another name",
                     entry.key_place, path};
    spec::Property keys;
    if (entry.value.is_map()) SL_TRY(read_fields(entry.value, keys, at));
    else keys.value = entry.value;
    model::PropertyDecl property{.name = entry.key, .unit = keys.unit};
    const Field field{"value", property.unit.c_str(), ""};
    const auto number = [&](const Node& written, double& to, const char* key) -> Status {
      if (written.is_null()) return {};
      SL_ASSIGN(to, read_number(written, field, field.min, field.max, false, at + key));
      return {};
    };
    SL_TRY(number(keys.min, property.min, "/min"));
    SL_TRY(number(keys.max, property.max, "/max"));
    if (property.max < property.min) return keys.max.error("max is below min", "", at + "/max");
    SL_ASSIGN(property.value,
              read_number(keys.value, field, property.min, property.max, false, at + "/value"));
    out.push_back(std::move(property));
  }
  return out;
}

/// What robots and things have in common: name, model, number, place and properties.
template <class Keys>
Result<RobotGroup> read_group(const Node& node, const Keys& keys, const char* what, const std::string& path) {
  RobotGroup group;
  const Node* const name = node.find("name");
  group.instance = keys.instance;
  group.instance.place = name ? name->place() : node.place();
  SL_ASSIGN(group.instance.properties, read_properties(keys.properties, path + "/properties"));
  if (keys.name.empty())
    return node.error("the " + std::string(what) + "'s name is empty", "", path + "/name");
  group.name = keys.name;
  group.model_place = keys.model.place();
  if (keys.model.is_map()) {
    group.builder = keys.model;
  } else if (keys.model.is_scalar() && !keys.model.text().empty() && keys.model.text().size() <= 4096) {
    group.model = keys.model.text();
  } else {
    return keys.model.error("the " + std::string(what) + "'s model is " + describe(keys.model),
                            "name a model file, or write {builder: ...} or builder:NAME", path + "/model");
  }
  group.count = keys.count;
  if (!keys.pose.is_null() && keys.distribution)
    return keys.pose.error("'pose' and 'distribution' are both given", "keep one of them", path + "/pose");
  if (keys.distribution) {
    SL_ASSIGN(group.placement, read_distribution(*node.find("distribution"), *keys.distribution, keys.count,
                                                 path + "/distribution"));
  } else if (!keys.pose.is_null()) {
    if (keys.count > 1)
      return keys.pose.error(std::to_string(keys.count) + " " + what + "s cannot start at one pose",
                             "give a 'distribution' instead", path + "/pose");
    SL_ASSIGN(group.placement.X_WM, read_pose(keys.pose, path + "/pose"));
    group.placement.place = keys.pose.place();
  } else {
    group.placement.kind = keys.count > 1 ? Placement::Kind::grid : Placement::Kind::pose;
    group.placement.place = node.place();
  }
  return group;
}

Result<RobotGroup> read_robot(const Node& node, spec::Robot& robot, const std::string& path) {
  SL_ASSIGN(RobotGroup group, read_group(node, robot, "robot", path));
  for (std::size_t i = 0; i < robot.modules.size(); ++i) {
    SL_ASSIGN(Module module, read_module(node.find("modules")->items()[i], robot.modules[i],
                                         path + "/modules/" + std::to_string(i)));
    for (const Module& other : group.modules)
      if (sanitised(other.id) == sanitised(module.id))
        return Error{"two modules are called '" + module.id + "'",
                     "the other one is at " + to_string(other.place), module.place, path + "/modules"};
    group.modules.push_back(std::move(module));
  }
  SL_ASSIGN(group.instance.controllers, read_controllers(robot, path));
  SL_TRY(check_devices(robot.devices, path + "/devices"));
  group.devices = std::move(robot.devices);
  if (robot.rate_hz) {
    group.rate_hz = *robot.rate_hz;
    group.rate_place = node.find("rate")->place();
    for (model::ControllerDecl& decl : group.instance.controllers.edit()) {
      decl.rate_hz = group.rate_hz;
      decl.rate_place = group.rate_place;
    }
  }
  group.joint_controllers = std::move(robot.joint_controllers);
  if (const Node* const files = node.find("joint_controllers"))
    group.joint_controllers_place = files->place();
  return group;
}

/// What is judged, as an expression or as a map.
Result<std::optional<model::CriterionDecl>> read_criterion(const Node& node, const std::string& path) {
  if (node.is_null()) return std::optional<model::CriterionDecl>();
  model::CriterionDecl criterion;
  criterion.place = criterion.success_place = node.place();
  if (node.is_map()) {
    SL_TRY(read_fields(node, criterion, path));
    criterion.place = node.find("value")->place();
    if (const Node* const success = node.find("success")) criterion.success_place = success->place();
  } else if (node.is_scalar() && node.text().size() <= 2000) {
    criterion.value = node.text();
  } else {
    return wrong_type(node, "an expression, or a map with value and success", path);
  }
  return std::optional(std::move(criterion));
}

/// Teams, and that each robot's team is one of them.
Status read_teams(const Node& node, const spec::Root& root, model::Setup& out) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < root.teams.size(); ++i) {
    const spec::Team& keys = root.teams[i];
    const Node& each = node.find("teams")->items()[i];
    const std::string path = "/teams/" + std::to_string(i);
    const Place& place = each.find("name")->place();
    if (sanitised(keys.name) != keys.name || keys.name.empty())
      return Error{"'" + keys.name + "' cannot be the name of a team", "letters, digits, _ and -", place,
                   path + "/name"};
    if (std::find(names.begin(), names.end(), keys.name) != names.end())
      return Error{"two teams are called '" + keys.name + "'", "give one of them another name", place,
                   path + "/name"};
    names.push_back(keys.name);
    SL_ASSIGN(auto controllers, read_controllers(keys, path));
    SL_ASSIGN(auto criterion, read_criterion(keys.criterion, path + "/criterion"));
    out.teams.push_back({keys.name, std::move(controllers), place, std::move(criterion)});
  }
  for (std::size_t i = 0; i < root.robots.size() && !names.empty(); ++i) {
    const std::string& team = root.robots[i].instance.team;
    if (team.empty() || std::find(names.begin(), names.end(), team) != names.end()) continue;
    return node.find("robots")->items()[i].find("team")->error(
        "there is no team '" + team + "'", suggestion(team, names), "/robots/" + std::to_string(i) + "/team");
  }
  return {};
}

/// A program or a criterion without robots would do nothing, without a word.
Status check_teams_have_robots(const spec::Root& root, const model::Setup& setup) {
  for (std::size_t i = 0; i < setup.teams.size(); ++i) {
    const model::TeamDecl& team = setup.teams[i];
    if (team.controllers.get().empty() && !team.criterion) continue;
    if (std::none_of(root.robots.begin(), root.robots.end(),
                     [&](const auto& robot) { return robot.instance.team == team.name; }))
      return Error{"no robot is in team '" + team.name + "'", "name it: team: " + team.name, team.place,
                   "/teams/" + std::to_string(i)};
  }
  return {};
}

/// Two groups that would make robots of one address. A group of n stands for stem1 ... stemn.
Status check_group_names(const std::vector<RobotGroup>& robots) {
  std::map<std::string, const RobotGroup*> single, stems;
  const auto clash = [](const RobotGroup& a, const RobotGroup& b, const std::string& name) {
    return Error{"two robots would be called '" + name + "'",
                 "the other one is at " + to_string(b.instance.place), a.instance.place, "/robots"};
  };
  for (const RobotGroup& group : robots) {
    const auto [known, fresh] = (group.count > 1 ? stems : single).emplace(sanitised(group.name), &group);
    if (!fresh) return clash(group, *known->second, known->first + (group.count > 1 ? "1" : ""));
  }
  // A name that ends in digits may be one of a group's. For a group that does, its lowest number decides: stem 'a'
  // with 20 robots and stem 'a1' with 5 share a11 ... a15.
  const auto check = [&](const std::string& name, const RobotGroup& group) -> Status {
    for (std::size_t cut = name.size(); cut > 1 && name.size() - cut < 8; --cut) {
      if (name[cut - 1] < '0' || name[cut - 1] > '9') break;
      const auto stem = stems.find(name.substr(0, cut - 1));
      if (stem == stems.end() || stem->second == &group || name[cut - 1] == '0') continue;
      int number = 0;
      std::from_chars(name.data() + cut - 1, name.data() + name.size(), number);
      if (number <= stem->second->count) return clash(group, *stem->second, name);
    }
    return {};
  };
  for (const auto& [name, group] : single) SL_TRY(check(name, *group));
  for (const auto& [name, group] : stems) SL_TRY(check(name + "1", *group));
  return {};
}

Status read_physics(const Node& node, Scenario& out) {
  out.setup.physics = Node::map(node.place());
  if (node.is_null()) return {};
  out.engine_place = node.place();
  if (node.is_scalar()) {
    out.setup.engine = node.text();
  } else if (node.is_map()) {
    out.setup.physics = node;
    if (const Node* engine = node.find("engine")) {
      if (!engine->is_scalar()) return wrong_type(*engine, "the name of an engine", "/physics/engine");
      out.engine_place = engine->place();
      out.setup.engine = engine->text();
      out.setup.physics.erase("engine");
    }
  } else {
    return wrong_type(node, "the name of an engine or a map with 'engine'", "/physics");
  }
  if (out.setup.engine.empty())
    return node.error("the name of the engine is empty", "write rigid or planar", "/physics");
  return {};
}

/// `values`, `events`, `criterion` and `log`: their expressions are read when the world they speak of is there.
Status read_watch(const Node& node, const spec::Root& root, model::Setup& out) {
  constexpr std::size_t most_values = 1000, longest = 2000;
  if (!root.values.is_map() && !root.values.is_null())
    return wrong_type(root.values, "a map of names to expressions", "/values");
  if (root.values.entries().size() > most_values)
    return root.values.error("there are more than 1000 values", "", "/values");
  for (const Node::Entry& entry : root.values.entries()) {
    const std::string path = "/values/" + entry.key;
    if (!is_identifier(entry.key))
      return Error{"'" + entry.key.substr(0, 60) + "' cannot be the name of a value",
                   "letters, digits and _, no digit first", entry.key_place, "/values"};
    if (!entry.value.is_scalar() || entry.value.text().size() > longest)
      return wrong_type(entry.value, "an expression", path);
    out.values.push_back({entry.key, entry.value.text(), entry.value.place()});
  }
  std::map<std::string, Place> names;
  for (std::size_t i = 0; i < root.events.size(); ++i) {
    const spec::Event& event = root.events[i];
    const Node& each = node.find("events")->items()[i];
    const std::string path = "/events/" + std::to_string(i);
    if (event.name.empty()) return each.error("the event's name is empty", "", path + "/name");
    if (const auto [known, fresh] = names.emplace(event.name, each.place()); !fresh)
      return each.find("name")->error("two events are called '" + event.name + "'",
                                      "the other one is at " + to_string(known->second), path + "/name");
    out.events.push_back({event.name, event.when, Time::from_s(event.hold_s), event.once, event.stop,
                          each.find("when")->place()});
  }
  SL_ASSIGN(out.criterion, read_criterion(root.criterion, "/criterion"));
  if (!root.log) return {};
  const Node& log = *node.find("log");
  out.log = model::LogDecl{root.log->file, root.log->rate_hz, {}, log.place()};
  const Node& columns = *log.find("values");
  if (root.log->values.empty())
    return columns.error("the log has no values", "list addresses or expressions", "/log/values");
  for (std::size_t i = 0; i < root.log->values.size(); ++i)
    out.log->values.push_back(
        {root.log->values[i], columns.is_sequence() ? columns.items()[i].place() : columns.place()});
  return {};
}

/// `poses` and `share`. Whether there are such topics is seen when the world is there.
Status read_annotations(const Node& node, const spec::Root& root, model::Setup& out) {
  std::map<std::string, Place> names;
  for (std::size_t i = 0; i < root.poses.size(); ++i) {
    const spec::NamedPose& keys = root.poses[i];
    const Node& each = node.find("poses")->items()[i];
    const std::string path = "/poses/" + std::to_string(i);
    if (keys.name.empty()) return each.error("the name of the pose is empty", "", path + "/name");
    if (const auto [known, fresh] = names.emplace(keys.name, each.place()); !fresh)
      return each.find("name")->error("two poses are called '" + keys.name + "'",
                                      "the other one is at " + to_string(known->second), path + "/name");
    SL_ASSIGN(const Pose X_WP, read_pose(keys.pose, path + "/pose"));
    out.poses.push_back({keys.name, X_WP, keys.description, keys.tags, keys.size_m});
  }
  if (!root.share) return {};
  out.sharing = root.share->sharing;
  const Node* const topics = node.find("share")->find("topics");
  for (std::size_t i = 0; i < root.share->topics.size(); ++i) {
    const std::string& name = root.share->topics[i];
    const Node& each = topics->is_sequence() ? topics->items()[i] : *topics;
    const std::string path = "/share/topics/" + std::to_string(i);
    if (name.empty() || name.front() != '/')
      return each.error("'" + name.substr(0, 100) + "' is not the name of a topic", "it begins with /", path);
    if (name.find('*') < name.size() - 1)
      return each.error("'" + name.substr(0, 100) + "' has a * that is not at its end",
                        "name the topics, or write their beginning and a *", path);
    if (name == model::commands_topic)
      return each.error("'" + name + "' is never shared", "what others command is theirs", path);
    out.sharing.topics.push_back({name, each.place()});
  }
  return {};
}

Result<Scenario> read_root(const Node& node, const std::string& file, Diagnostics& diagnostics) {
  // A file of a later version may differ in every key: its version is the only error.
  if (const Node* version = node.find("version")) {
    double number = 1;
    if (version->is_scalar() && parse_number(version->text(), number) && number != 1)
      return version->error("version " + version->text() + " of the scenario format is not known",
                            "this Sandlot reads version 1", "/version");
  }
  spec::Root root;
  SL_TRY(read_fields(node, root));
  Scenario out;
  out.file = file;
  out.setup = std::move(root.setup);
  model::Setup& setup = out.setup;
  out.world = root.world;
  if (const Node* world = node.find("world")) out.world_place = world->place();
  SL_TRY(read_physics(root.physics, out));
  setup.step = Time::from_s(root.time.step_s);
  setup.clock.mode = root.time.clock;
  setup.clock.min_step = Time::from_s(root.time.min_step_s);
  setup.clock.max_step = Time::from_s(root.time.max_step_s);
  if (setup.clock.max_step < setup.clock.min_step)
    return node.find("time")->error("min_step is longer than max_step", "", "/time");
  setup.substeps = root.time.substeps;
  setup.control_interval = root.time.control_interval;
  if (root.time.stop_s) setup.stop = Time::from_s(*root.time.stop_s);
  if (setup.record) {
    const Node& record = *node.find("record");
    std::string& target = setup.record->file;
    if (target.empty())
      return record.error("'file' is missing", "for example file: run.mcap", "/record/file");
    target = (std::filesystem::path(base_folder(out, record.place())) / target).string();
  }
  for (std::size_t i = 0; i < root.plugins.size(); ++i) {
    const Node& all = *node.find("plugins");
    const Node& each = all.is_sequence() ? all.items()[i] : all;
    if (root.plugins[i].empty())
      return each.error("the plugin's name is empty", "name a shared library", "/plugins");
    out.plugins.emplace_back(root.plugins[i], each.place());
  }
  std::int64_t total = 0;
  for (std::size_t i = 0; i < root.things.size(); ++i) {
    const Node& each = node.find("things")->items()[i];
    SL_ASSIGN(RobotGroup group, read_group(each, root.things[i], "thing", "/things/" + std::to_string(i)));
    total += group.count;
    if (total > spec::max_robots)
      return each.error("more than " + std::to_string(spec::max_robots) + " things in all", "", "/things");
    out.things.push_back(std::move(group));
  }
  for (std::size_t i = 0; i < root.robots.size(); ++i) {
    const Node& each = node.find("robots")->items()[i];
    SL_ASSIGN(RobotGroup group, read_robot(each, root.robots[i], "/robots/" + std::to_string(i)));
    total += group.count;
    if (total > spec::max_robots)
      return each.error("more than " + std::to_string(spec::max_robots) + " robots in all", "", "/robots");
    out.robots.push_back(std::move(group));
  }
  SL_TRY(check_group_names(out.robots));
  SL_TRY(read_teams(node, root, setup));
  SL_TRY(read_watch(node, root, setup));
  SL_TRY(read_zones(node, root.zones, setup.zones, diagnostics));
  SL_TRY(read_elements(root.media, "media", setup.media));
  SL_TRY(read_elements(root.rules, "rules", setup.rules));
  SL_TRY(read_elements(root.markers, "markers", setup.markers));
  SL_TRY(read_annotations(node, root, setup));
  SL_TRY(check_teams_have_robots(root, setup));
  return out;
}

}  // namespace

Result<Pose> read_pose(const Node& node, const std::string& path) {
  spec::PoseKeys keys;
  if (node.is_sequence() && (node.items().size() == 3 || node.items().size() == 6)) {
    // The list is the map without its keys.
    static constexpr const char* planar[] = {"x", "y", "yaw"};
    static constexpr const char* spatial[] = {"x", "y", "z", "roll", "pitch", "yaw"};
    Node map = Node::map(node.place());
    for (std::size_t i = 0; i < node.items().size(); ++i)
      map.set((node.items().size() == 3 ? planar : spatial)[i], node.items()[i]);
    SL_TRY(read_fields(map, keys, path));
  } else if (node.is_map()) {
    SL_TRY(read_fields(node, keys, path));
  } else {
    return node.error(
        "a pose is [x, y, yaw], [x, y, z, roll, pitch, yaw] or a map of these, found " +
            (node.is_sequence() ? "a list of " + std::to_string(node.items().size()) : describe(node)),
        "", path);
  }
  return pose_from_rpy({keys.x_m, keys.y_m, keys.z_m}, {keys.roll_rad, keys.pitch_rad, keys.yaw_rad});
}

Result<Scenario> parse_scenario(std::string_view text, const std::string& file,
                                std::span<const Override> overrides, Diagnostics& diagnostics) {
  SL_ASSIGN(Node root, parse_with_includes(text, file));
  return scenario_of_tree(std::move(root), file, overrides, diagnostics);
}

Result<Scenario> scenario_of_tree(Node root, const std::string& file, std::span<const Override> overrides,
                                  Diagnostics& diagnostics) {
  SL_TRY(apply_overrides(root, overrides));
  const Node* const written = root.is_map() ? root.find("vars") : nullptr;
  const Node vars = written ? *written : Node();
  std::vector<std::pair<std::string, Place>> unused_vars;
  SL_TRY(substitute_variables(root, unused_vars));
  SL_TRY(add_team_robots(root, vars, file, unused_vars));
  if (root.is_null() && !root.place().file) root.set_place(place_in(file));
  SL_ASSIGN(Scenario scenario, read_root(root, file, diagnostics));
  // A file that several scenarios include has more than each of them needs.
  std::erase_if(unused_vars, [&](const auto& each) { return each.second.file && *each.second.file != file; });
  scenario.unused_vars = std::move(unused_vars);
  return scenario;
}

Result<Scenario> read_scenario(const std::string& path, std::span<const Override> overrides,
                               Diagnostics& diagnostics) {
  SL_ASSIGN(const std::string text, read_text_file(path, TextLimits{}.max_bytes));
  return parse_scenario(text, path, overrides, diagnostics);
}

std::string base_folder(const Scenario& scenario, const Place& place) {
  const bool in_file = place.file && !starts_with(*place.file, override_place);
  return folder_of(in_file ? *place.file : scenario.file);
}

}  // namespace sandlot::formats
