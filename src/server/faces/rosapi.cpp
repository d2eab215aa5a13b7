/// Services of rosapi: what is there, for clients that look around.
#include <algorithm>
#include <set>

#include "base/json_writer.h"
#include "base/text.h"
#include "server/faces/rosbridge.h"

namespace sandlot::server {
namespace {

/// A node's name as ROS has it: "/rover/laser", "/viewer_3".
std::string node_name(std::string_view id) {
  std::string out = with_slash(id);
  std::replace(out.begin(), out.end(), ' ', '_');
  return out;
}

/// Members of a type, and of the types that it is made of.
void add_types(const MessageInfo& info, std::set<const MessageInfo*>& known, JsonWriter& w) {
  if (!known.insert(&info).second) return;
  const auto list = [&](const char* key, const auto& all, auto&& write) {
    w.key(key).list([&] {
      for (const auto& each : all) write(each);
    });
  };
  using Count = MessageField::Count;
  w.object([&] {
    w.key("type").text(short_name(info.name));
    list("fieldnames", info.fields, [&](const MessageField& f) { w.text(f.name); });
    list("fieldtypes", info.fields,
         [&](const MessageField& f) { w.text(f.message ? short_name(f.message->name) : name_of(f.type)); });
    list("fieldarraylen", info.fields, [&](const MessageField& f) {
      w.integer(f.count == Count::one     ? -1
                : f.count == Count::array ? static_cast<std::int64_t>(f.length)
                                          : 0);
    });
    list("examples", info.fields, [&](const MessageField& f) {
      const bool number = size_of(f.type) > 0 && f.type != Wire::boolean;
      w.text(f.count != Count::one     ? "[]"
             : f.message               ? "{}"
             : number                  ? "0"
             : f.type == Wire::boolean ? "false"
                                       : "");
    });
    list("constnames", info.constants, [&](const MessageConstant& c) { w.text(c.name); });
    list("constvalues", info.constants, [&](const MessageConstant& c) { w.text(c.value); });
  });
  for (const MessageField& each : info.fields)
    if (each.message) add_types(*each.message, known, w);
}

std::string json_of(const foxglove::Parameter& parameter) {
  std::string out;
  JsonWriter w(out);
  const auto list = [&](const auto& all, auto&& write) {
    w.list([&] {
      for (const auto& each : all) write(each);
    });
  };
  if (const auto* const flag = std::get_if<bool>(&parameter.value)) w.flag(*flag);
  else if (const auto* const number = std::get_if<double>(&parameter.value)) w.real(*number);
  else if (const auto* const text = std::get_if<std::string>(&parameter.value)) w.text(*text);
  else if (const auto* const numbers = std::get_if<std::vector<double>>(&parameter.value))
    list(*numbers, [&](double each) { w.real(each); });
  else if (const auto* const texts = std::get_if<std::vector<std::string>>(&parameter.value))
    list(*texts, [&](const std::string& each) { w.text(each); });
  else w.null();
  return out;
}

}  // namespace

/// Nothing: it is none of these services.
std::optional<std::string> RosbridgeFace::answer_of_rosapi(const std::string& service,
                                                           const rosbridge::Body& args) {
  constexpr std::string_view prefix = "/rosapi/";
  if (!starts_with(service, prefix)) return std::nullopt;
  const std::string_view name = std::string_view(service).substr(prefix.size());
  std::vector<const ChannelInfo*> topics;
  for (const ChannelInfo* const each : hub_.channels(client_))
    if (each->type) topics.push_back(each);
  std::vector<const ServiceOffer*> offers = hub_.offered_services(client_);
  std::string out;
  JsonWriter w(out);
  const auto texts = [&](const char* key, const auto& all, auto&& text) {
    w.key(key).list([&] {
      for (const auto* const each : all) w.text(text(*each));
    });
  };
  const auto argument = [&](const char* key) { return rosbridge::text_of(args, key); };
  const auto type_of_topic = [](const ChannelInfo& each) { return each.type->name; };
  const auto name_of_topic = [](const ChannelInfo& each) { return each.topic; };
  const auto name_of_service = [](const ServiceOffer& each) { return each.name; };
  // Who publishes and reads what, as far as the client may see it.
  const auto graph = [&] {
    foxglove::Graph all = hub_.graph();
    const bool whole = hub_.sees_world(client_);
    const auto hidden = [&](const foxglove::Graph::Named& each) {
      return !whole && std::none_of(topics.begin(), topics.end(),
                                    [&](const ChannelInfo* t) { return t->topic == each.name; });
    };
    std::erase_if(all.published, hidden);
    std::erase_if(all.subscribed, hidden);
    if (!whole) all.subscribed.clear();  // others' affairs
    std::erase_if(all.services, [&](const foxglove::Graph::Named& each) {
      return std::none_of(offers.begin(), offers.end(),
                          [&](const ServiceOffer* offer) { return offer->name == each.name; });
    });
    return all;
  };
  const auto ids_of = [](const std::vector<foxglove::Graph::Named>& all, const std::string& wanted) {
    for (const auto& each : all)
      if (each.name == wanted) return each.ids;
    return std::vector<std::string>();
  };
  const auto nodes = [&](const char* key, const std::vector<std::string>& ids) {
    std::set<std::string> names;
    for (const std::string& each : ids) names.insert(node_name(each));
    w.object([&] {
      w.key(key).list([&] {
        for (const std::string& each : names) w.text(each);
      });
    });
  };
  const auto details = [&](const MessageInfo* info) {
    std::set<const MessageInfo*> known;
    w.object([&] {
      w.key("typedefs").list([&] {
        if (info) add_types(*info, known, w);
      });
    });
  };
  if (name == "topics") {
    w.object([&] {
      texts("topics", topics, name_of_topic);
      texts("types", topics, type_of_topic);
    });
  } else if (name == "topics_and_raw_types") {
    w.object([&] {
      texts("topics", topics, name_of_topic);
      texts("types", topics, type_of_topic);
      texts("typedefs_full_text", topics, [](const ChannelInfo& each) { return each.type->schema; });
    });
  } else if (name == "services") {
    w.object([&] { texts("services", offers, name_of_service); });
  } else if (name == "topic_type" || name == "service_type") {
    std::string type;
    const std::string wanted = with_slash(argument(name == "topic_type" ? "topic" : "service"));
    for (const ChannelInfo* const each : topics)
      if (name == "topic_type" && each->topic == wanted) type = each->type->name;
    for (const ServiceOffer* const each : offers)
      if (name == "service_type" && each->name == wanted) type = each->type.name;
    w.object([&] { w.key("type").text(type); });
  } else if (name == "topics_for_type") {
    const std::string type = long_name(argument("type"));
    std::erase_if(topics, [&](const ChannelInfo* each) { return each->type->name != type; });
    w.object([&] { texts("topics", topics, name_of_topic); });
  } else if (name == "services_for_type") {
    std::string type = argument("type");
    if (type.find("/srv/") == std::string::npos && type.find('/') != std::string::npos)
      type.insert(type.find('/'), "/srv");
    std::erase_if(offers, [&](const ServiceOffer* each) { return each->type.name != type; });
    w.object([&] { texts("services", offers, name_of_service); });
  } else if (name == "message_details") {
    const auto found = find_message(argument("type"));
    details(found ? *found : nullptr);
  } else if (name == "service_request_details" || name == "service_response_details") {
    const auto found = find_service(argument("type"));
    details(!found ? nullptr : name == "service_request_details" ? (*found)->request : (*found)->response);
  } else if (name == "nodes") {
    const foxglove::Graph all = graph();
    std::vector<std::string> ids{"sandlot"};
    for (const auto* const side : {&all.published, &all.subscribed, &all.services})
      for (const auto& each : *side) ids.insert(ids.end(), each.ids.begin(), each.ids.end());
    nodes("nodes", ids);
  } else if (name == "node_details") {
    const foxglove::Graph all = graph();
    const std::string wanted = with_slash(argument("node"));
    const auto of_node = [&](const char* key, const std::vector<foxglove::Graph::Named>& side) {
      w.key(key).list([&] {
        for (const auto& each : side)
          if (std::any_of(each.ids.begin(), each.ids.end(),
                          [&](const std::string& id) { return node_name(id) == wanted; }))
            w.text(each.name);
      });
    };
    w.object([&] {
      of_node("subscribing", all.subscribed);
      of_node("publishing", all.published);
      of_node("services", all.services);
    });
  } else if (name == "publishers") {
    nodes("publishers", ids_of(graph().published, with_slash(argument("topic"))));
  } else if (name == "subscribers") {
    nodes("subscribers", ids_of(graph().subscribed, with_slash(argument("topic"))));
  } else if (name == "service_node") {
    const auto ids = ids_of(graph().services, with_slash(argument("service")));
    w.object([&] { w.key("node").text(ids.empty() ? "" : node_name(ids.front())); });
  } else if (name == "service_providers") {
    const std::string type = argument("service");
    nodes("providers", ids_of(graph().services, with_slash(type)));
  } else if (name == "action_servers") {
    w.object([&] { w.key("action_servers").list([&] {}); });
  } else if (name == "get_time") {
    constexpr std::int64_t second_ns = 1'000'000'000;
    const Time now = hub_.report().now;
    w.object([&] {
      w.key("time").object([&] {
        w.key("sec").integer(now.ns / second_ns);
        w.key("nanosec").integer(now.ns % second_ns);
      });
    });
  } else if (name == "get_ros_version") {
    w.object([&] {
      w.key("version").integer(2);
      w.key("distro").text("humble");
    });
  } else {
    return std::nullopt;
  }
  return out;
}

bool RosbridgeFace::call_parameters(const std::string& service, const rosbridge::CallService& request,
                                    const Respond& respond) {
  constexpr std::string_view prefix = "/rosapi/";
  if (!starts_with(service, prefix)) return false;
  const std::string what = service.substr(prefix.size());
  const bool sets = what == "set_param";
  if (what != "get_param" && what != "has_param" && what != "get_param_names" && what != "delete_param" &&
      !sets)
    return false;
  const auto fail = [&](const std::string& why) {
    hub_.count_refused();
    respond(rosbridge::quoted(why), false);
    return true;
  };
  if (what == "delete_param") return fail("parameters belong to the run: they cannot be deleted");
  const Access& access = hub_.access(client_);
  if (!hub_.sees_world(client_) || (sets && !access.is_admin()))
    return fail(std::string("a ") + name_of(access.role) + " may not " + (sets ? "set" : "see") +
                " parameters");
  // Clients of ROS write a slash, or the node's name and a colon, before the name.
  std::string name = rosbridge::text_of(request.args, "name");
  if (starts_with(name, "/sandlot:")) name.erase(0, 9);
  if (starts_with(name, "/")) name.erase(0, 1);
  if (name.empty() && what != "get_param_names") return fail("'name' is missing");
  constexpr std::size_t most_waiting = 50;
  if (parameter_calls_.size() >= most_waiting) return fail("too many requests wait for their answers");
  const std::string about = "rosapi " + std::to_string(++parameter_calls_made_);
  std::vector<foxglove::Parameter> wanted;
  if (sets) {
    const std::string value = rosbridge::value_of(request.args, "value");
    std::string text = "{\"op\":\"setParameters\",\"parameters\":[{\"name\":" + rosbridge::quoted(name) +
                       ",\"value\":" + value + "}]}";
    const auto read = value.empty() ? Error{"'value' is missing, or longer than 1000 letters"}
                                    : foxglove::read_text(text);
    if (!read) return fail(read.error().text());
    wanted = std::get<foxglove::SetParameters>(*read).parameters;
  }
  parameter_calls_[about] = {what, respond, rosbridge::value_of(request.args, "default"), ""};
  std::vector<std::string> names;
  if (what != "get_param_names") names.push_back(name);
  const bool asked = sets ? hub_.set_parameters(client_, wanted, about)
                          : hub_.get_parameters(client_, names, about);
  if (asked) return true;
  parameter_calls_.erase(about);
  return fail("too many requests wait for their answers");
}

void RosbridgeFace::tell_parameters(std::span<const foxglove::Parameter> values, std::string_view about) {
  const auto found = parameter_calls_.find(std::string(about));
  if (found == parameter_calls_.end()) return;
  const ParameterCall call = std::move(found->second);
  parameter_calls_.erase(found);
  const bool there = !values.empty() && values.front().value.index() != 0;
  std::string out;
  JsonWriter w(out);
  if (call.what == "get_param_names") {
    w.object([&] {
      w.key("names").list([&] {
        for (const foxglove::Parameter& each : values) w.text(each.name);
      });
    });
  } else if (call.what == "has_param") {
    w.object([&] { w.key("exists").flag(there); });
  } else if (!call.error.empty() || (call.what == "get_param" && !there && call.otherwise.empty())) {
    return call.respond(rosbridge::quoted(call.error.empty() ? "there is no such parameter" : call.error),
                        false);
  } else {
    w.object([&] {
      if (call.what == "get_param") w.key("value").text(there ? json_of(values.front()) : call.otherwise);
      w.key("successful").flag(true);
      w.key("reason").text("");
    });
  }
  call.respond(out, true);
}

}  // namespace sandlot::server
