#include <nlohmann/json.hpp>

#include "formats/scenario/scenario.h"
#include "formats/scenario/spec.h"

namespace sandlot::formats {
namespace {

using Json = nlohmann::ordered_json;
namespace spec = scenario_spec;

/// Any scalar may be written as a text: a number with its unit, or ${variable}.
Json schema_of_leaf(const FieldInfo& field) {
  const auto number = [&](bool integer) {
    Json out = {
        {"type", {integer ? "integer" : "number", "string"}}, {"minimum", field.min}, {"maximum", field.max}};
    return out;
  };
  Json out = Json::object();
  if (field.type == "number" || field.type == "integer") {
    out = number(field.type == "integer");
  } else if (field.type == "bool") {
    out["type"] = {"boolean", "string"};
  } else if (field.type == "text") {
    out["type"] = {"string", "number", "boolean"};
  } else if (field.type == "choice") {
    out["anyOf"] = {Json{{"enum", field.choices}}, Json{{"type", "string"}, {"pattern", "\\$\\{"}}};
  } else if (field.type == "list of number" || field.type == "list of text") {
    out["type"] = {"array", "string"};
    out["items"] = field.type == "list of text" ? Json{{"type", "string"}} : number(false);
    if (field.length > 0) out["minItems"] = out["maxItems"] = field.length;
  } else if (field.type == "list of lists of number") {
    out["type"] = {"array", "string"};
    out["items"] = {
        {"type", "array"}, {"items", number(false)}, {"minItems", field.length}, {"maxItems", field.length}};
  } else if (!field.elements.empty()) {
    out["type"] = "array";
    out["items"] = {{"$ref", "#/$defs/" + field.elements}};
    out["minItems"] = field.min_count;
    out["maxItems"] = field.max_count;
  }
  if (!field.help.empty()) out["description"] = field.help;
  if (!field.unit.empty() && field.unit != "1") out["x-unit"] = field.unit;
  double value = 0;
  if ((field.type == "number" || field.type == "integer") && parse_number(field.default_value, value) &&
      !field.required)
    out["default"] = value;
  else if ((field.type == "choice" || field.type == "text") && !field.default_value.empty())
    out["default"] = field.default_value;
  else if (field.type == "bool") out["default"] = field.default_value == "true";
  return out;
}

Json empty_object() {
  return {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
}

/// The field paths "a/b", "list[]/c" become nested objects and arrays.
Json object_of(const std::vector<FieldInfo>& fields) {
  Json root = empty_object();
  for (const FieldInfo& field : fields) {
    Json* at = &root;
    const std::vector<std::string_view> parts = split(field.path, '/');
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      const bool list = parts[i].size() > 2 && parts[i].substr(parts[i].size() - 2) == "[]";
      Json& child = (*at)["properties"][std::string(parts[i].substr(0, parts[i].size() - (list ? 2 : 0)))];
      if (list) {
        child["type"] = "array";
        if (!child.contains("items")) child["items"] = empty_object();
        at = &child["items"];
      } else {
        if (!child.contains("properties")) child = empty_object();
        at = &child;
      }
    }
    const std::string key(parts.back());
    Json& leaf = (*at)["properties"][key];
    const Json described = schema_of_leaf(field);
    if (leaf.is_null()) leaf = described;
    if (field.for_map) {  // the list alone will do
      for (const auto& [name, value] : described.items()) {
        if (name == "type") (*at)[name] = {"object", value};
        else if (name != "description") (*at)[name] = value;
      }
    }
    if (field.required) (*at)["required"].push_back(key);
  }
  return root;
}

/// A map with `kind` (or `word`) and the keys of that kind; `common` are keys that every kind has.
Json kinds_of(std::span<const KindFields> kinds, const Json& common, bool kind_needed,
              const char* word = "kind") {
  Json names = Json::array(), choices = Json::array();
  Json all = common;
  for (const auto& [name, fields] : kinds) {
    names.push_back(name);
    Json properties = object_of(fields)["properties"];
    // `rate` of a controller's own kind is the kind's.
    for (const auto& [key, value] : common.items())
      if (key != "rate" || !properties.contains(key)) properties[key] = value;
    properties[word] = {{"const", name}};
    choices.push_back({{"if", {{"properties", {{word, {{"const", name}}}}}, {"required", {word}}}},
                       {"then", {{"properties", properties}, {"additionalProperties", false}}}});
  }
  all[word] = {{"type", "string"}, {"description", "Kind of the entry."}};
  if (!names.empty()) all[word]["examples"] = names;
  Json out = {{"type", "object"}, {"properties", all}};
  if (kind_needed) out["required"] = {word};
  if (!choices.empty()) out["allOf"] = choices;
  return out;
}

/// A map with one key, the name of a stage.
Json stages_of(std::span<const KindFields> stages) {
  Json out = empty_object();
  for (const auto& [name, fields] : stages) out["properties"][name] = object_of(fields);
  out["minProperties"] = out["maxProperties"] = 1;
  return out;
}

Json pose_schema(const char* description) {
  Json numbers = {{"type", "array"}, {"items", {{"type", {"number", "string"}}}}};
  Json planar = numbers, spatial = numbers;
  planar["minItems"] = planar["maxItems"] = 3;
  spatial["minItems"] = spatial["maxItems"] = 6;
  return {
      {"description", description},
      {"anyOf", {planar, spatial, object_of(describe_fields<spec::PoseKeys>()), Json{{"type", "string"}}}}};
}

}  // namespace

std::vector<DistributionKind> distribution_kinds() {
  std::vector<DistributionKind> out;
  const spec::Distribution kinds;
  spec::Distribution::fields(kinds, [&]<class Kind>(const Field& field, const std::optional<Kind>&) {
    out.push_back({field.key, field.help, describe_fields<Kind>()});
  });
  return out;
}

std::string schema_of(const std::vector<FieldInfo>& fields) {
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}};
  out.update(object_of(fields));
  return out.dump(2);
}

std::string scenario_schema(std::span<const KindFields> devices, std::span<const KindFields> controllers,
                            std::span<const StageFields> stages, std::span<const KindFields> builders,
                            std::span<const FieldInfo> device_keys, std::span<const ElementFields> elements) {
  Json root = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Sandlot scenario"}};
  root.update(object_of(describe_fields<spec::Root>()));
  // The keys whose form the field lists leave open.
  Json& keys = root["properties"];
  const auto describe_as = [](Json& slot, Json form) {
    const Json description = slot["description"];
    slot = std::move(form);
    slot["description"] = description;
  };
  describe_as(keys["physics"],
              {{"type", {"string", "object"}}, {"properties", {{"engine", {{"type", "string"}}}}}});
  describe_as(keys["vars"], {{"type", "object"}});
  describe_as(keys["values"],
              {{"type", "object"}, {"additionalProperties", {{"type", {"string", "number"}}}}});
  const Json criterion = {
      {"anyOf", {Json{{"type", {"string", "number"}}}, object_of(describe_fields<model::CriterionDecl>())}}};
  describe_as(keys["criterion"], criterion);
  describe_as(keys["include"], {{"type", {"string", "array"}}, {"items", {{"type", "string"}}}});
  Json& robot = keys["robots"]["items"]["properties"];
  const Json model = {
      {"anyOf", {Json{{"type", "string"}}, kinds_of(builders, Json::object(), true, "builder")}}};
  describe_as(robot["model"], model);
  describe_as(robot["pose"], pose_schema(""));
  Json& thing = keys["things"]["items"]["properties"];
  describe_as(thing["model"], model);
  describe_as(thing["pose"], pose_schema(""));
  const Json named = {
      {"name", {{"type", "string"}, {"description", "Name of the controller."}, {"default", "controller"}}},
      {"rate",
       {{"type", {"number", "string"}},
        {"minimum", 1e-3},
        {"maximum", 1e6},
        {"description", "Control steps per second; the robot's rate or the run's control steps by default."},
        {"x-unit", "Hz"}}}};
  const Json controller = kinds_of(controllers, named, true);
  Json& team = keys["teams"]["items"]["properties"];
  describe_as(team["criterion"], criterion);
  for (Json* const owner : {&robot, &team}) {
    describe_as((*owner)["controller"], {{"anyOf", {Json{{"type", "string"}}, controller}}});
    describe_as((*owner)["controllers"], {{"type", "array"}, {"items", controller}});
  }
  Json mounted = {
      {"link",
       {{"type", "string"}, {"description", "Link it is mounted on; the model's first one by default."}}},
      {"pose", pose_schema("Pose in the link.")},
      {"level", {{"type", "string"}, {"description", "Level of abstraction."}}},
      {"levels",
       {{"type", "array"}, {"items", {{"type", "string"}}}, {"description", "Active levels, if several."}}}};
  mounted.update(object_of({device_keys.begin(), device_keys.end()})["properties"]);
  describe_as(robot["devices"],
              {{"type", "object"}, {"additionalProperties", kinds_of(devices, mounted, false)}});
  const Json element_name = {
      {"name", {{"type", "string"}, {"description", "Name of the element; its kind by default."}}}};
  for (const auto& [key, kinds] : elements)
    describe_as(keys[key],
                {{"type", "array"},
                 {"items", {{"anyOf", {Json{{"type", "string"}}, kinds_of(kinds, element_name, true)}}}}});
  for (const auto& [name, sorts] : stages) root["$defs"][name] = stages_of(sorts);
  return root.dump(2);
}

}  // namespace sandlot::formats
