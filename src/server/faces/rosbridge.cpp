#include "server/faces/rosbridge.h"

#include <algorithm>
#include <cmath>

#include "assets/image/write.h"
#include "base/base64.h"
#include "base/json_writer.h"
#include "base/text.h"
#include "messages/json.h"

namespace sandlot::server {
namespace {

using namespace std::chrono_literals;
using rosbridge::Compression;

constexpr auto fragment_patience = 10s;
constexpr std::size_t most_fragments = 10'000;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

/// A text as the pixels of a picture, which compresses it: three bytes each, about as wide as high, filled up with line breaks.
/// What is long stays a text: compressing it would take the time of all clients.
std::string png_message(std::string text) {
  constexpr std::size_t longest = 256 << 10;
  if (text.size() > longest) return text;
  const std::size_t pixels = (text.size() + 2) / 3;
  const auto width = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(pixels))));
  const std::size_t height = (pixels + width - 1) / width;
  std::vector<std::uint8_t> bytes(3 * width * height, '\n');
  std::copy(text.begin(), text.end(), bytes.begin());
  const std::string png = assets::png_of(
      assets::Pixels8{static_cast<int>(width), static_cast<int>(height), 3, bytes});
  std::string out = "{\"op\":\"png\",\"data\":\"";
  add_base64(bytes_of(png), out);
  return out + "\"}";
}

}  // namespace

std::string with_slash(std::string_view name) {
  return starts_with(name, "/") ? std::string(name) : "/" + std::string(name);
}

double RosbridgeFace::Subscription::throttle_s() const {
  double least = 1e9;
  for (const auto& [id, each] : throttles_s) least = std::min(least, each);
  return least;
}

/// Whether a message can be sent: a datagram has an end.
bool RosbridgeFace::fits(std::size_t bytes, std::size_t fragment_size) const {
  return carrier_ != Carrier::udp || bytes <= most_datagram_bytes || fragment_size > 0;
}

/// A response that fits no datagram is a failure, so that nobody waits for it.
void RosbridgeFace::send_response(const std::string& service, const std::string& id, std::string_view values,
                                  bool result, std::size_t fragment_size, bool png) {
  std::string text = rosbridge::service_response(service, id, values, result);
  if (png) text = png_message(std::move(text));
  if (!fits(text.size(), fragment_size))
    text = rosbridge::service_response(service, id,
                                       rosbridge::quoted("the response has " + std::to_string(text.size()) +
                                                         " bytes and fits no datagram; give a fragment_size"),
                                       false);
  send_text(std::move(text), fragment_size, false);
}

bool RosbridgeFace::send_text(std::string text, std::size_t fragment_size, bool droppable) {
  // Of an image in pieces of 100 bytes everybody would feel the work.
  constexpr std::size_t most_pieces = 1000;
  if (fragment_size > 0) fragment_size = std::max(fragment_size, text.size() / most_pieces + 1);
  // A piece becomes longer when it is quoted.
  constexpr std::size_t most_piece = 16'000;
  if (carrier_ == Carrier::udp && fragment_size > 0) fragment_size = std::min(fragment_size, most_piece);
  if (fragment_size == 0 || text.size() <= fragment_size)
    return transport_.send(client_, {}, payload_of(text), true, droppable);
  for (std::string& each : rosbridge::fragments(text, fragment_size, std::to_string(++fragments_sent_)))
    if (!transport_.send(client_, {}, payload_of(each), true, false)) return false;
  return true;
}

// ------------------------------------------------------------------------------------------------ what the hub says

bool RosbridgeFace::deliver(std::uint32_t, const Outgoing& message, bool droppable) {
  const auto found = subscriptions_.find(message.channel.topic);
  if (found == subscriptions_.end() || !message.channel.type) return true;
  Subscription& to = found->second;
  if (const double throttle_s = to.throttle_s(); throttle_s > 0) {
    const auto now = Clock::now();
    if (now < to.next) return true;
    to.next = now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(throttle_s));
  }
  const auto in_form = [&](Outgoing::Form form, auto&& write) -> const Payload& {
    Payload& made = message.form(form);
    if (!made) made = write();
    return made;
  };
  const std::string& topic = message.channel.topic;
  const MessageInfo& type = *message.channel.type;
  if (to.compression == Compression::cbor || to.compression == Compression::cbor_raw) {
    const bool raw = to.compression == Compression::cbor_raw;
    const Payload& made = in_form(raw ? Outgoing::Form::cbor_raw : Outgoing::Form::cbor, [&] {
      return std::make_shared<const std::vector<std::byte>>(
          raw ? rosbridge::publish_cbor_raw(topic, message.stamp, *message.bytes)
              : rosbridge::publish_cbor(topic, type, *message.bytes));
    });
    return transport_.send(client_, {}, made, false, droppable);
  }
  const auto json = [&] { return rosbridge::publish_json(topic, type, *message.bytes); };
  const Payload& made = to.compression == Compression::png
                            ? in_form(Outgoing::Form::png, [&] { return payload_of(png_message(json())); })
                            : in_form(Outgoing::Form::json, [&] { return payload_of(json()); });
  if (!fits(made->size(), to.fragment_size)) {
    hub_.count_dropped();
    if (!std::exchange(to.too_long, true))
      report(foxglove::Level::error,
             "messages of '" + topic + "' fit no datagram; give a fragment_size or a compression", {});
    return true;
  }
  if (to.fragment_size == 0) return transport_.send(client_, {}, made, true, droppable);
  return send_text({reinterpret_cast<const char*>(made->data()), made->size()}, to.fragment_size, droppable);
}

void RosbridgeFace::remove_channels(std::span<const std::uint32_t> numbers) {
  for (const std::uint32_t number : numbers)
    std::erase_if(subscriptions_, [&](const auto& each) { return each.second.channel == number; });
}

void RosbridgeFace::report(foxglove::Level level, std::string_view text, std::string_view about) {
  if (const auto call = parameter_calls_.find(std::string(about)); call != parameter_calls_.end()) {
    call->second.error = text;  // told with the answer
    return;
  }
  const auto ours = level == foxglove::Level::info      ? rosbridge::Level::info
                    : level == foxglove::Level::warning ? rosbridge::Level::warning
                                                        : rosbridge::Level::error;
  if (ours >= level_) transport_.send_text(client_, rosbridge::status(ours, text, about));
}

void RosbridgeFace::tell_step(const StepNotice& step) {
  transport_.send_text(client_, rosbridge::tick(step.program, step.number, step.now, step.random));
}

// --------------------------------------------------------------------------------------------- what the client says

/// A call is answered, so that nobody waits for it.
void RosbridgeFace::over_budget(std::span<const std::byte> bytes, bool text) {
  const auto read = text ? rosbridge::read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()})
                         : rosbridge::read_binary(bytes);
  if (!read) return;
  if (const auto* const call = std::get_if<rosbridge::CallService>(&read->operation))
    transport_.send_text(client_, rosbridge::service_response(call->service, read->id,
                                                              rosbridge::quoted("too many requests"), false));
}

void RosbridgeFace::message(std::span<const std::byte> bytes, bool text) {
  const auto read = text ? rosbridge::read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()})
                         : rosbridge::read_binary(bytes);
  if (!read) return refuse(read.error().text(), {});
  handle(*read);
}

void RosbridgeFace::handle(const rosbridge::ClientMessage& message) {
  const std::string& id = message.id;
  std::visit(Overloaded{
                 [&](const rosbridge::Subscribe& m) { subscribe(id, m); },
                 [&](const rosbridge::Unsubscribe& m) { unsubscribe(id, m.topic); },
                 [&](const rosbridge::Advertise& m) { advertise(id, m); },
                 [&](const rosbridge::Unadvertise& m) {
                   const auto found = publications_.find(with_slash(m.topic));
                   if (found == publications_.end())
                     return refuse("'" + m.topic.substr(0, 100) + "' was not advertised", id);
                   hub_.unadvertise(client_, found->second);
                   publications_.erase(found);
                 },
                 [&](const rosbridge::Publish& m) { publish(id, m); },
                 [&](const rosbridge::CallService& m) { call(id, m); },
                 [&](const rosbridge::SetLevel& m) { level_ = m.level; },
                 [&](const rosbridge::Fragment& m) { fragment(id, m); },
                 [&](const rosbridge::Claim& m) { claim(id, m); },
                 [&](const rosbridge::Done& m) { done(id, m); },
                 [&](const rosbridge::Release&) { hub_.release(client_); },
                 [&](const rosbridge::Hello&) {
                   std::string out;
                   JsonWriter w(out);
                   w.object([&] {
                     w.key("op").text("sandlot.welcome");
                     if (!id.empty()) w.key("id").text(id);
                     w.key("role").text(name_of(hub_.access(client_).role));
                   });
                   transport_.send_text(client_, std::move(out));
                 },
                 [&](const rosbridge::Other& m) {
                   refuse("the operation '" + m.op.substr(0, 60) + "' is not known here", id);
                 },
             },
             message.operation);
}

void RosbridgeFace::subscribe(const std::string& id, const rosbridge::Subscribe& request) {
  const std::string topic = with_slash(request.topic);
  const ChannelInfo* const info = hub_.find_channel(client_, topic);
  if (!info) {
    std::vector<std::string> known;
    for (const ChannelInfo* const each : hub_.channels(client_)) known.push_back(each->topic);
    const std::string near = nearest(topic, known);
    return refuse("there is no topic '" + topic.substr(0, 200) + "'" +
                      (near.empty() ? "" : "; did you mean '" + near + "'?"),
                  id);
  }
  if (carrier_ != Carrier::websocket && request.compression != Compression::none &&
      request.compression != Compression::png)
    return refuse("cbor comes by WebSocket alone", id);
  if (!info->type) return refuse("'" + topic + "' has a form that rosbridge does not know", id);
  if (!request.type.empty() && long_name(request.type) != info->type->name)
    return refuse("'" + topic + "' carries " + info->type->name + ", not " + request.type.substr(0, 100), id);
  const bool known = subscriptions_.count(topic) > 0;
  Subscription& made = subscriptions_[topic];
  constexpr std::size_t most_parts = 100;
  if (made.throttles_s.size() >= most_parts) return refuse("too many subscriptions to '" + topic + "'", id);
  made.channel = info->id;
  made.compression = request.compression;
  made.fragment_size = request.fragment_size;
  made.throttles_s[id] = request.throttle_s;
  if (known) return;
  if (const Status status = hub_.subscribe(client_, info->id, info->id); !status) {
    subscriptions_.erase(topic);
    refuse(status.error().text(), id);
  }
}

void RosbridgeFace::unsubscribe(const std::string& id, const std::string& name) {
  const std::string topic = with_slash(name);
  const auto found = subscriptions_.find(topic);
  if (found == subscriptions_.end()) return refuse("'" + topic.substr(0, 200) + "' is not subscribed to", id);
  if (id.empty()) found->second.throttles_s.clear();
  else found->second.throttles_s.erase(id);
  if (!found->second.throttles_s.empty()) return;
  const std::uint32_t channel = found->second.channel;
  subscriptions_.erase(found);
  if (const Status status = hub_.unsubscribe(client_, channel); !status) refuse(status.error().text(), id);
}

void RosbridgeFace::advertise(const std::string& id, const rosbridge::Advertise& request) {
  const std::string topic = with_slash(request.topic);
  if (publications_.size() >= most_publications && publications_.count(topic) == 0)
    return refuse("more than " + std::to_string(most_publications) + " topics are advertised", id);
  Hub::Publication made{topic, request.type, nullptr, {}};
  if (const Status allowed = hub_.judge(client_, made); !allowed) return refuse(allowed.error().text(), id);
  const auto [place, fresh] = publications_.try_emplace(topic, next_publication_);
  if (fresh) ++next_publication_;
  hub_.advertise(client_, place->second, std::move(made));
}

/// A topic need not be advertised: the first message does that.
void RosbridgeFace::publish(const std::string& id, const rosbridge::Publish& request) {
  const std::string topic = with_slash(request.topic);
  auto found = publications_.find(topic);
  Hub::Publication* publication = found == publications_.end()
                                      ? nullptr
                                      : hub_.find_publication(client_, found->second);
  if (!publication) {  // not advertised, or forgotten by a claim
    publications_.erase(topic);
    advertise(id, {topic, ""});
    found = publications_.find(topic);
    if (found == publications_.end()) return;
    publication = hub_.find_publication(client_, found->second);
  }
  hub_.publish(client_, *publication,
               [&](const TopicBase& slot) { return request.message.to_command(slot); });
}

void RosbridgeFace::call(const std::string& id, const rosbridge::CallService& request) {
  const std::string name = with_slash(request.service);
  const auto respond = [this, service = request.service, id, size = request.fragment_size,
                        png = request.compression == Compression::png](std::string_view values, bool result) {
    send_response(service, id, values, result, size, png);
  };
  if (const auto answer = answer_of_rosapi(name, request.args)) return respond(*answer, true);
  if (call_parameters(name, request, respond)) return;
  const auto fail = [&](const std::string& why) {
    hub_.count_refused();
    respond(rosbridge::quoted(why), false);
  };
  const ServiceOffer* const offer = hub_.find_service(client_, name);
  if (!offer) {
    std::vector<std::string> known;
    for (const ServiceOffer* const each : hub_.offered_services(client_)) known.push_back(each->name);
    const std::string near = nearest(name, known);
    return fail("there is no service '" + name.substr(0, 200) + "'" +
                (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
  const auto cdr = request.args.to_cdr(*offer->type.request);
  if (!cdr) return fail(name + ": " + cdr.error().text());
  const auto message = message_from_cdr(*offer->type.request, *cdr);
  SL_CHECK_MSG(message, "what was written just now can be read");
  hub_.call(client_, *offer, *message,
            [service = request.service, id, size = request.fragment_size, type = offer->type.response,
             png = request.compression == Compression::png](Face& face, const ServiceCall::Outcome& outcome) {
              auto& self = static_cast<RosbridgeFace&>(face);
              std::string values;
              if (!outcome) values = rosbridge::quoted(outcome.error().text());
              else
                SL_CHECK_MSG(cdr_to_json(*type, *outcome, values), "what was written just now can be read");
              self.send_response(service, id, values, static_cast<bool>(outcome), size, png);
            });
}

void RosbridgeFace::fragment(const std::string& id, const rosbridge::Fragment& request) {
  const auto now = Clock::now();
  if (carrier_ == Carrier::udp) return refuse("fragments do not come by datagrams, which have no order", id);
  if (request.total == 0 || request.total > most_fragments || request.number >= request.total)
    return refuse("a fragment's num and total do not fit", id);
  if (assembly_ && (assembly_->id != id || now > assembly_->begun + fragment_patience)) {
    refuse("fragments of '" + assembly_->id.substr(0, 60) + "' are thrown away", assembly_->id);
    assembly_.reset();
  }
  if (!assembly_) {
    assembly_ = Assembly{.id = id,
                         .parts = std::vector<std::optional<std::string>>(request.total),
                         .bytes = 0,
                         .missing = request.total,
                         .begun = now};
  }
  if (request.total != assembly_->parts.size() || assembly_->parts[request.number] ||
      assembly_->bytes + request.data.size() > rosbridge::most_bytes) {
    assembly_.reset();
    return refuse("a fragment comes twice, or does not fit the others", id);
  }
  assembly_->parts[request.number] = request.data;
  assembly_->bytes += request.data.size();
  if (--assembly_->missing > 0) return;
  std::string whole;
  for (const auto& each : assembly_->parts) whole += *each;
  assembly_.reset();
  const auto read = rosbridge::read_text(whole);
  if (!read) return refuse(read.error().text(), id);
  if (std::holds_alternative<rosbridge::Fragment>(read->operation))
    return refuse("fragments of fragments are not put together", id);
  handle(*read);
}

void RosbridgeFace::claim(const std::string& id, const rosbridge::Claim& request) {
  hub_.claim(client_,
             {request.robot, request.team, request.token, request.lockstep, request.deadline_s, request.name},
             [id](Face& face, const Result<std::vector<ClaimedProgram>>& programs) {
               auto& self = static_cast<RosbridgeFace&>(face);
               if (!programs) {
                 self.transport_.send_text(
                     self.client_, rosbridge::status(rosbridge::Level::error, programs.error().text(), id));
                 return;
               }
               const Access& access = self.hub_.access(self.client_);
               std::string out;
               JsonWriter w(out);
               w.object([&] {
                 w.key("op").text("sandlot.claimed");
                 if (!id.empty()) w.key("id").text(id);
                 w.key(name_of(access.role)).text(access.name);
                 w.key("robots").list([&] {
                   for (const std::string& each : access.robots) w.text(each);
                 });
                 w.key("programs").list([&] {
                   for (const ClaimedProgram& each : *programs)
                     w.object([&] {
                       w.key("name").text(each.path);
                       w.key("control_period_s").real(each.control_period_s);
                     });
                 });
               });
               self.transport_.send_text(self.client_, std::move(out));
             });
}

void RosbridgeFace::done(const std::string& id, const rosbridge::Done& request) {
  const auto text = [](const rosbridge::Body& body) { return body ? body.text() : std::string(); };
  if (const Status status = hub_.done(client_, request.step, request.program, text(request.orders),
                                      text(request.samples));
      !status)
    refuse(status.error().text(), id);
}

}  // namespace sandlot::server
