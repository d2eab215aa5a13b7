#include "server/faces/foxglove.h"

#include "base/text.h"
#include "messages/json.h"

namespace sandlot::server {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

foxglove::Channel advertised(const ChannelInfo& info) {
  foxglove::Channel out{info.id, info.topic, info.encoding, info.schema_name, "", ""};
  if (info.encoding == "json") {
    out.schema = R"({"type":"object"})";
    out.schema_encoding = "jsonschema";
  } else if (info.type) {
    out.schema = info.type->schema;
    out.schema_encoding = "ros2msg";
  }
  return out;
}

foxglove::Service offered(const ServiceOffer& offer) {
  const auto side = [](const MessageInfo& message) {
    return foxglove::Service::Side{"cdr", message.name, "ros2msg", message.schema};
  };
  return {offer.number, offer.name, offer.type.name, side(*offer.type.request), side(*offer.type.response)};
}

}  // namespace

void FoxgloveFace::welcome(const Access& access) {
  foxglove::ServerInfo info;
  info.name = hub_.options().name;
  info.capabilities = {"clientPublish",   "time",  "parameters", "parametersSubscribe", "services",
                       "connectionGraph", "assets"};
  info.encodings = {"cdr", "json"};
  info.metadata = {{"ROS_DISTRO", "humble"},
                   {"sandlot_version", hub_.options().version},
                   {"sandlot_role", name_of(access.role)},
                   {"sandlot_client", std::to_string(client_)}};
  info.session_id = hub_.session_id();
  transport_.send_text(client_, foxglove::server_info(info));
}

void FoxgloveFace::add_channels(std::span<const ChannelInfo* const> channels) {
  std::vector<foxglove::Channel> out;
  for (const ChannelInfo* const each : channels) out.push_back(advertised(*each));
  transport_.send_text(client_, foxglove::advertise(out));
}

void FoxgloveFace::remove_channels(std::span<const std::uint32_t> numbers) {
  transport_.send_text(client_, foxglove::unadvertise(numbers));
}

void FoxgloveFace::add_services(std::span<const ServiceOffer* const> services) {
  std::vector<foxglove::Service> out;
  for (const ServiceOffer* const each : services) out.push_back(offered(*each));
  transport_.send_text(client_, foxglove::advertise_services(out));
}

void FoxgloveFace::remove_services(std::span<const std::uint32_t> numbers) {
  transport_.send_text(client_, foxglove::unadvertise_services(numbers));
}

bool FoxgloveFace::deliver(std::uint32_t subscription, const Outgoing& message, bool droppable) {
  const auto head = foxglove::message_header(subscription, message.stamp);
  return transport_.send(client_, head, message.bytes, false, droppable);
}

void FoxgloveFace::tell_time(Time now, Payload& shared) {
  if (!shared) shared = std::make_shared<const std::vector<std::byte>>(foxglove::time(now));
  transport_.send(client_, {}, shared, false, true);
}

void FoxgloveFace::report(foxglove::Level level, std::string_view text, std::string_view about) {
  transport_.send_text(client_, foxglove::status(level, text, about));
}

void FoxgloveFace::tell_parameters(std::span<const foxglove::Parameter> parameters, std::string_view about) {
  transport_.send_text(client_, foxglove::parameter_values(parameters, about));
}

void FoxgloveFace::tell_graph(const foxglove::Graph& now, const foxglove::Graph& removed) {
  transport_.send_text(client_, foxglove::graph_update(now, removed));
}

// ------------------------------------------------------------------------------------------- what the client says

void FoxgloveFace::over_budget(std::span<const std::byte> bytes, bool text) {
  if (text) return;
  const auto read = foxglove::read_binary(bytes);
  if (const auto* const called = read ? std::get_if<foxglove::CallService>(&*read) : nullptr)
    transport_.send_text(client_,
                         foxglove::service_failure(called->service, called->call, "too many requests"));
}

void FoxgloveFace::message(std::span<const std::byte> bytes, bool text) {
  const auto read = text ? foxglove::read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()})
                         : foxglove::read_binary(bytes);
  if (!read) return refuse(read.error().text());
  handle(*read);
}

void FoxgloveFace::handle(const foxglove::ClientMessage& message) {
  const auto told = [&](const Status& status) {
    if (!status) refuse(status.error().text());
  };
  std::visit(Overloaded{
                 [&](const foxglove::Subscribe& m) { subscribe(m); },
                 [&](const foxglove::Unsubscribe& m) {
                   for (const std::uint32_t each : m.ids) told(hub_.unsubscribe(client_, each));
                 },
                 [&](const foxglove::Advertise& m) { advertise(m); },
                 [&](const foxglove::Unadvertise& m) {
                   for (const std::uint32_t each : m.ids) {
                     hub_.unadvertise(client_, each);
                     publications_.erase(each);
                   }
                 },
                 [&](const foxglove::GetParameters& m) { hub_.get_parameters(client_, m.names, m.id); },
                 [&](const foxglove::SetParameters& m) { hub_.set_parameters(client_, m.parameters, m.id); },
                 [&](const foxglove::SubscribeParameters& m) {
                   told(hub_.subscribe_parameters(client_, m.names, m.subscribe));
                 },
                 [&](const foxglove::SubscribeGraph& m) { hub_.subscribe_graph(client_, m.subscribe); },
                 [&](const foxglove::FetchAsset& m) { fetch(m); },
                 [&](const foxglove::ClientData& m) { publish(m); },
                 [&](const foxglove::CallService& m) { call(m); },
                 [&](const foxglove::PlaybackControl&) {
                   refuse("playback control is not known here; say it to /sandlot/console");
                 },
             },
             message);
}

void FoxgloveFace::subscribe(const foxglove::Subscribe& request) {
  std::size_t refused = 0;
  std::string why;
  for (const auto& [subscription, channel] : request.subscriptions)
    if (const Status status = hub_.subscribe(client_, subscription, channel); !status && refused++ == 0)
      why = status.error().text();
  if (refused > 0)
    refuse(refused == 1 ? why : why + ", and " + std::to_string(refused - 1) + " more were refused");
}

void FoxgloveFace::advertise(const foxglove::Advertise& request) {
  for (const foxglove::Advertise::Each& each : request.channels) {
    if (publications_.count(each.id) > 0) {
      refuse("channel " + std::to_string(each.id) + " is advertised already");
      continue;
    }
    if (publications_.size() >= most_publications)
      return refuse("more than " + std::to_string(most_publications) + " channels are advertised");
    if (each.encoding != "cdr" && each.encoding != "json") {
      refuse("'" + each.encoding.substr(0, 60) + "' is not an encoding of messages; cdr and json are");
      continue;
    }
    Hub::Publication made{each.topic, each.schema_name, nullptr, {}};
    if (const Status allowed = hub_.judge(client_, made); !allowed) {
      refuse(allowed.error().text());
      if (hub_.access(client_).role == Role::spectator) return;
      continue;
    }
    publications_[each.id] = each.encoding == "json";
    hub_.advertise(client_, each.id, std::move(made));
  }
}

void FoxgloveFace::publish(const foxglove::ClientData& data) {
  if (hub_.access(client_).role == Role::spectator) return refuse("a spectator may not publish");
  Hub::Publication* const publication = hub_.find_publication(client_, data.channel);
  if (!publication) return refuse("channel " + std::to_string(data.channel) + " was not advertised");
  hub_.publish(client_, *publication, data.bytes,
               publications_.at(data.channel) ? Hub::Encoding::json : Hub::Encoding::cdr);
}

void FoxgloveFace::call(const foxglove::CallService& request) {
  const auto fail = [&](const std::string& why) {
    hub_.count_refused();
    transport_.send_text(client_, foxglove::service_failure(request.service, request.call, why));
  };
  const ServiceOffer* const offer = hub_.find_service(client_, request.service);
  if (!offer) return fail("there is no service " + std::to_string(request.service));
  const bool json = request.encoding == "json";
  if (!json && request.encoding != "cdr")
    return fail("'" + request.encoding.substr(0, 60) + "' is not an encoding of requests; cdr and json are");
  const MessageInfo& info = *offer->type.request;
  const auto message = json ? message_from_json(info, {reinterpret_cast<const char*>(request.bytes.data()),
                                                       request.bytes.size()})
                            : message_from_cdr(info, request.bytes);
  if (!message) return fail(offer->name + ": " + message.error().text());
  hub_.call(client_, *offer, *message,
            [service = request.service, call = request.call, encoding = request.encoding,
             type = offer->type.response](Face& face, const ServiceCall::Outcome& outcome) {
              auto& self = static_cast<FoxgloveFace&>(face);
              if (!outcome) {
                self.transport_.send_text(self.client_,
                                          foxglove::service_failure(service, call, outcome.error().text()));
                return;
              }
              std::string text;
              std::span<const std::byte> body = *outcome;
              if (encoding == "json") {
                const Status written = cdr_to_json(*type, *outcome, text);
                SL_CHECK_MSG(written, "what was written just now can be read");
                body = std::as_bytes(std::span(text));
              }
              self.transport_.send(self.client_, {},
                                   std::make_shared<const std::vector<std::byte>>(
                                       foxglove::service_response(service, call, encoding, body)),
                                   false, false);
            });
}

void FoxgloveFace::fetch(const foxglove::FetchAsset& request) {
  constexpr std::string_view scheme = "sandlot://";
  std::vector<std::byte> out;
  if (hub_.access(client_).is_scoped()) {
    out = foxglove::asset_error(request.request, "assets are for administrators and spectators");
  } else if (starts_with(request.uri, scheme)) {
    const auto body = hub_.assets().get(std::string_view(request.uri).substr(scheme.size()));
    out = body ? foxglove::asset(request.request, *body->bytes)
               : foxglove::asset_error(request.request, body.error().text());
  } else {
    out = foxglove::asset_error(request.request,
                                "assets are called as the world names them: sandlot://mesh/a5");
  }
  if (out.size() > 4 && out[5] != std::byte{0}) hub_.count_refused();
  transport_.send(client_, {}, std::make_shared<const std::vector<std::byte>>(std::move(out)), false, false);
}

}  // namespace sandlot::server
