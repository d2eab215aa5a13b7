#include "server/server.h"

#include <future>

#include "base/log.h"
#include "console/console.h"
#include "server/clients/hub.h"
#include "server/faces/foxglove.h"
#include "server/faces/rosbridge.h"

namespace sandlot::server {
namespace {

HttpAnswer text_answer(int status, std::string_view text) {
  HttpAnswer out;
  out.status = status;
  out.owned = payload_of(text);
  out.body = *out.owned;
  return out;
}

}  // namespace

struct Server::Impl {
  Impl(const ServerOptions& options, Session& the_session, Console& the_console)
      : session(the_session),
        console(the_console),
        feed(std::make_shared<Feed>(the_session, mailbox, assets, options.poses_hz)),
        hub(the_session, the_console, options, mailbox, feed, assets) {}

  HttpAnswer get(std::string_view target) const;
  /// Brings `f` to the hub's thread; nothing after close().
  void wake(void (Hub::*f)()) {
    const std::lock_guard lock(mutex);
    if (transport) transport->post([this, f] { (hub.*f)(); });
  }

  Session& session;
  Console& console;
  wire::Assets assets;
  std::shared_ptr<Mailbox> mailbox = std::make_shared<Mailbox>();
  std::shared_ptr<Feed> feed;
  Hub hub;
  std::function<void()> others_on_change;

  std::unique_ptr<Processes> processes;  ///< null: no program is started
  std::mutex mutex;                      ///< of `transport`, as long as others use it
  Transport* transport = nullptr;
  std::unique_ptr<Transport> owned;
  bool stopped = false;
};

HttpAnswer Server::Impl::get(std::string_view target) const {
  constexpr std::string_view asset = "/assets/";
  if (target.substr(0, asset.size()) == asset) {
    const auto body = assets.get(target.substr(asset.size()));
    if (!body) return text_answer(404, body.error().text() + "\n");
    HttpAnswer out;
    out.type = body->type;
    out.owned = body->bytes;
    out.body = *body->bytes;
    return out;
  }
  for (const PageFile& file : page_files())
    if (file.path == target || (target == "/" && file.path == "/index.html")) {
      HttpAnswer out;
      out.type = file.type;
      out.body = file.bytes;
      out.etag = file.etag;
      std::erase(out.etag, '"');
      return out;
    }
  return text_answer(404, "there is no " + std::string(target.substr(0, 200)) + " here\n");
}

Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options, Session& session,
                                              Console& console) {
  auto impl = std::make_unique<Impl>(options, session, console);
  Impl* const self = impl.get();
  TransportOptions transport = options.transport;
  for (const std::string_view name : foxglove::subprotocols) transport.subprotocols.emplace_back(name);
  transport.none_offered = transport.raw_json = true;  // clients of rosbridge come so
  if (options.programs.start) {
    SL_ASSIGN(impl->processes, Processes::create(session.simulation(), options.programs));
    if (impl->processes) transport.local_ports = impl->processes->ports();
  }
  // The transport's thread runs before start() has returned; it waits until the hub knows the transport.
  const auto ready = std::make_shared<std::promise<void>>();
  const std::shared_future<void> is_ready = ready->get_future().share();
  Handler handler;
  handler.get = [self](std::string_view target) { return self->get(target); };
  handler.connected = [self, is_ready](ClientId id, const Access& access, std::string_view subprotocol) {
    is_ready.wait();
    using Carrier = RosbridgeFace::Carrier;
    const bool tcp = subprotocol == "tcp", udp = subprotocol == "udp",
               rosbridge = tcp || udp || subprotocol.empty();
    const Carrier carrier = tcp ? Carrier::tcp : udp ? Carrier::udp : Carrier::websocket;
    const Protocol protocol = tcp         ? Protocol::rosbridge_tcp
                              : udp       ? Protocol::rosbridge_udp
                              : rosbridge ? Protocol::rosbridge
                                          : Protocol::foxglove;
    self->hub.connected(id, access, protocol,
                        [=](Hub& hub, Transport& to, ClientId client) -> std::unique_ptr<Face> {
                          if (rosbridge) return std::make_unique<RosbridgeFace>(hub, to, client, carrier);
                          return std::make_unique<FoxgloveFace>(hub, to, client);
                        });
  };
  handler.message = [self, is_ready](ClientId id, std::span<const std::byte> bytes, bool text) {
    is_ready.wait();
    self->hub.message(id, bytes, text);
  };
  handler.disconnected = [self, is_ready](ClientId id) {
    is_ready.wait();
    self->hub.disconnected(id);
  };
  handler.timer = [self, is_ready] {
    is_ready.wait();
    self->hub.timer();
  };
  SL_ASSIGN(impl->owned, Transport::start(transport, std::move(handler)));
  impl->hub.use(*impl->owned);
  impl->hub.use(impl->processes.get());
  // Clients find the world's topics from their first word on.
  impl->hub.send_world({.inventory = take_inventory(session.simulation(), session.epoch())});
  impl->transport = impl->owned.get();
  impl->mailbox->open([self] { self->wake(&Hub::drain); });
  impl->others_on_change = session.on_change;
  session.on_change = [self] {
    if (self->others_on_change) self->others_on_change();
    self->wake(&Hub::state_changed);
  };
  log::set_listener([self](log::Level level, std::string_view text) {
    const std::uint8_t ros_level = level == log::Level::warning ? 30 : level == log::Level::info ? 20 : 10;
    self->mailbox->push([ros_level, line = std::string(text)](Hub& hub) { hub.send_log(ros_level, line); });
  });
  console.set_clients([self](bool json) {
    const auto rows = self->hub.roster().rows(std::chrono::steady_clock::now());
    return json ? clients_json(rows, {}) : clients_text(rows);
  });
  // Last: from here on viewers may give orders, which call on_change.
  ready->set_value();
  std::unique_ptr<Server> server(new Server(std::move(impl)));
  if (self->processes) SL_TRY(self->processes->start());
  return server;
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::~Server() { stop(); }

std::string Server::url() const { return impl_->owned->url(); }

Counters Server::counters() const {
  Counters out = impl_->owned->counters();
  out.refused += impl_->hub.counts().refused;
  out.dropped += impl_->hub.counts().dropped + impl_->hub.counts().too_long;
  return out;
}

std::vector<Roster::Total> Server::clients() const { return impl_->hub.roster().totals(); }

void Server::stop() {
  if (std::exchange(impl_->stopped, true)) return;
  impl_->console.set_clients(nullptr);
  if (impl_->processes) impl_->processes->expect_end();
  log::set_listener({});
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->transport = nullptr;
  }
  impl_->mailbox->open(nullptr);
  impl_->owned->stop();
  if (impl_->processes) impl_->processes->stop();
  // Not before: as long as the transport's thread lives, an order of a viewer may be calling it.
  impl_->session.on_change = impl_->others_on_change;
  impl_->mailbox->close();
  impl_->feed->detach();
}

}  // namespace sandlot::server
