/// The port and the interface of server/http/transport.h. A connection is a Peer: beast/peer.cpp.
///
/// All of it runs on one thread; only the queues of messages to clients are shared, under one mutex. There is one timer, which looks at the
/// deadlines of all peers.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <new>
#include <string>

#include "base/log.h"
#include "server/http/beast/impl.h"
#include "server/http/http.h"

namespace sandlot::server {
namespace {

constexpr auto beat = std::chrono::milliseconds(33);
constexpr int most_local_clients = 8;  // of one local port
constexpr const char* loopback = "loopback";

/// What is counted as one address: one of IPv4, a network of 64 bits of IPv6, all of loopback.
std::string counted_address(const tcp::socket& socket) {
  error_code ec;
  net::ip::address address = socket.remote_endpoint(ec).address();
  if (ec) return "";
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    address = net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6());
  if (address.is_loopback()) return loopback;
  if (address.is_v4()) return address.to_string();
  auto bytes = address.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), std::uint8_t{0});
  return net::ip::address_v6(bytes).to_string();
}

}  // namespace

// --- the port ---
Status Transport::Impl::listen() {
  error_code ec;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(options.address, "", tcp::resolver::passive, ec);
  if (ec || found.empty())
    return Error{fmt::format("\"{}\" is not an address of this machine", options.address),
                 "try 127.0.0.1, 0.0.0.0, ::1 or ::"};
  // localhost is often both ::1 and 127.0.0.1; everybody tries the latter.
  const auto v4 = std::find_if(found.begin(), found.end(),
                               [](const auto& f) { return f.endpoint().address().is_v4(); });
  tcp::endpoint at = (v4 != found.end() ? *v4 : *found.begin()).endpoint();
  const int tries = options.next_free && options.port != 0 ? 21 : 1;
  for (int i = 0; i < tries && options.port + i <= 65535; ++i) {
    at.port(static_cast<std::uint16_t>(options.port + i));
    const auto attempt = [&] {
      acceptor.open(at.protocol(), ec);
      if (!ec) acceptor.set_option(tcp::acceptor::reuse_address(true), ec);
      if (!ec && at.address().is_v6() && at.address().is_unspecified())
        acceptor.set_option(net::ip::v6_only(false), ec);
      if (!ec) acceptor.bind(at, ec);
      if (!ec) acceptor.listen(net::socket_base::max_listen_connections, ec);
      if (!ec) acceptor.non_blocking(true, ec);
      if (!ec) bound = acceptor.local_endpoint(ec);
    };
    attempt();
    if (!ec) {
      ::fcntl(acceptor.native_handle(), F_SETFD, FD_CLOEXEC);
      return {};
    }
    error_code ignored;
    acceptor.close(ignored);
    if (ec != net::error::address_in_use) break;
  }
  if (ec == net::error::address_in_use && tries > 1)
    return Error{fmt::format("ports {} to {} of {} are all taken", options.port, at.port(), options.address),
                 "choose another with --port (0: any that is free)"};
  if (ec == net::error::address_in_use)
    return Error{fmt::format("port {} of {} is taken", options.port, options.address),
                 "end the program that has it, or choose another with --port (0: any that is free)"};
  if (ec == net::error::access_denied)
    return Error{
        fmt::format("port {} of {} is not for everybody: {}", options.port, options.address, ec.message()),
        "choose one above 1023 with --port"};
  return Error{
      fmt::format("cannot listen at port {} of {}: {}", options.port, options.address, ec.message())};
}

Status Transport::Impl::listen_locally() {
  for (const LocalPort& port : options.local_ports) {
    error_code ec;
    local::acceptor& made = local_acceptors.emplace_back(io);
    if (port.path.size() >= sizeof(sockaddr_un::sun_path)) ec = net::error::name_too_long;
    if (!ec) made.open(local(), ec);
    if (!ec) made.bind(local::endpoint(port.path), ec);
    // The folder says who may come.
    if (!ec && ::chmod(port.path.c_str(), 0666) != 0) ec.assign(errno, boost::system::system_category());
    if (!ec) made.listen(net::socket_base::max_listen_connections, ec);
    if (!ec) made.non_blocking(true, ec);
    if (ec) return Error{fmt::format("cannot listen at {}: {}", port.path, ec.message())};
    ::fcntl(made.native_handle(), F_SETFD, FD_CLOEXEC);
  }
  return {};
}

bool Transport::Impl::on_loopback() const {
  const auto address = bound.address();
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6()).is_loopback();
  return address.is_loopback();
}

/// Calls what is not ours to trust, or may run out of memory, and goes on.
void Transport::Impl::call(const std::function<void()>& f) noexcept {
  try {
    f();
  } catch (const std::exception& e) {
    log::warning(fmt::format("the server goes on after an error: {}", e.what()));
  }
}

void Transport::Impl::for_one(std::uint64_t id, const std::function<void(Peer&)>& f) {
  const auto found = peers.find(id);
  if (found == peers.end()) return;
  const PeerPtr peer = found->second;
  try {
    f(*peer);
  } catch (const std::exception& e) {
    log::warning(fmt::format("a connection is closed: {}", e.what()));
    peer->end();
  }
}

void Transport::Impl::for_all(const std::function<void(Peer&)>& f) {
  // Each may end itself and others.
  for (auto i = peers.begin(); i != peers.end();) {
    const auto id = i->first;
    for_one(id, f);
    i = peers.upper_bound(id);
  }
}

void Transport::Impl::run() {
  if (options.listens) accept();
  for (std::size_t port = 0; port < local_acceptors.size(); ++port) accept_locally(port);
  next_beat = Clock::now();
  on_beat();
  // What is thrown outside a peer's own completions is out of Beast or Asio, mostly for want of memory: its peer is left
  // without anything under way, and its deadline ends it.
  while (!io.stopped()) call([this] { io.run(); });
}

void Transport::Impl::accept() {
  accept_again = false;
  acceptor.async_accept([this](error_code ec, tcp::socket socket) {
    if (stopping || ec == net::error::operation_aborted) return;
    if (ec && ec != net::error::connection_aborted) {
      accept_again = true;  // no descriptors are left, for instance: at the next beat there may be
      return;
    }
    if (!ec) call([&] { admit_socket(std::move(socket)); });
    accept();
  });
}

/// Reading, writing and closing are the same for sockets of all families: Asio's socket of TCP takes these too.
void Transport::Impl::accept_locally(std::size_t port) {
  local_acceptors[port].async_accept([this, port](error_code ec, local::socket socket) {
    if (stopping || ec == net::error::operation_aborted) return;
    if (ec && ec != net::error::connection_aborted) {
      paused_ports.push_back(port);
      return;
    }
    const auto there = std::count_if(local_port_of.begin(), local_port_of.end(),
                                     [port](const auto& peer) { return peer.second == port; });
    if (!ec && there >= most_local_clients) ++refused;
    else if (!ec)
      call([&] {
        tcp::socket as_tcp(io);
        as_tcp.assign(tcp::v4(), socket.release());
        admit_socket(std::move(as_tcp), port);
      });
    accept_locally(port);
  });
}

const Access* Transport::Impl::local_access(std::uint64_t id) const {
  const auto found = local_port_of.find(id);
  return found == local_port_of.end() ? nullptr : &options.local_ports[found->second].access;
}

void Transport::Impl::admit_socket(tcp::socket socket, std::optional<std::size_t> local_port) {
  ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  const std::string address = counted_address(socket);
  if (!local_port && !has_room(address)) {
    ++refused;
    socket.non_blocking(true, ignored);
    const std::string text = "there are too many connections\n";
    const auto head = write_head(
                          {.status = 503, .type = "text/plain", .length = text.size(), .keep_alive = false}) +
                      text;
    socket.write_some(net::buffer(head), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
    return;
  }
  const auto id = next_id++;
  if (local_port) local_port_of.emplace(id, *local_port);
  peers.emplace(id, make_peer(*this, id, std::move(socket), address));
  ++sockets_of[address];
  for_one(id, [](Peer& peer) { peer.begin(); });
}

/// Whether another socket of an address may come. Who asks nothing makes room.
bool Transport::Impl::has_room(const std::string& address) {
  const auto now = Clock::now();
  const auto make_room = [&](bool same_address) {
    for (const bool also_new : {false, true})
      for (const auto& [id, peer] : peers) {  // the oldest first
        if (same_address && peer->address() != address) continue;
        if (!peer->idle() && !(also_new && peer->dawdles(now))) continue;
        const PeerPtr held = peer;
        held->end();
        return true;
      }
    return false;
  };
  const auto of_address = sockets_of.find(address);
  const std::size_t most = address == loopback ? options.most_from_loopback : options.most_per_address;
  if (of_address != sockets_of.end() && of_address->second >= most && !make_room(true)) return false;
  return peers.size() < options.most_sockets || make_room(false);
}

/// Whether another client may come. Who has been a guest for long makes room: it has claimed nothing.
bool Transport::Impl::has_room_for_client() {
  if (clients < options.most_clients) return true;
  const auto now = Clock::now();
  const auto guest = std::find_if(peers.begin(), peers.end(),
                                  [now](const auto& p) { return p.second->is_old_guest(now); });
  if (guest == peers.end()) return false;
  const PeerPtr held = guest->second;
  ++refused;
  held->end();
  return true;
}

void Transport::Impl::on_beat() {
  const auto now = Clock::now();
  next_beat = std::max(next_beat + beat, now + beat / 2);
  timer.expires_at(next_beat);
  timer.async_wait([this](error_code ec) {
    if (!ec) on_beat();
  });
  for_all([now](Peer& peer) { peer.on_beat(now); });
  if (stopping) {
    if (peers.empty() || now > last_moment) io.stop();
    return;
  }
  if (accept_again) accept();
  for (const std::size_t port : std::exchange(paused_ports, {})) accept_locally(port);
  if (handler.timer) call(handler.timer);
}

void Transport::Impl::begin_stop() {
  if (stopping) return;
  stopping = true;
  last_moment = Clock::now() + goodbye + 3 * beat;
  error_code ignored;
  acceptor.close(ignored);
  for (local::acceptor& each : local_acceptors) each.close(ignored);
  for_all([](Peer& peer) { peer.stop(); });
  close_udp(*this);
  if (peers.empty()) io.stop();
}

void Transport::Impl::schedule(ClientId client, Queue& queue) {
  if (queue.scheduled) return;
  queue.scheduled = true;
  net::post(io, [this, client] { for_one(client, [](Peer& peer) { peer.flush(); }); });
}

std::string remote_address(const tcp::socket& socket) {
  error_code ec;
  const tcp::endpoint at = socket.remote_endpoint(ec);
  if (ec) return "";
  if (at.port() == 0) return "unix socket";  // of a program that the run has started
  const std::string host = at.address().to_string();
  return at.address().is_v6() ? fmt::format("[{}]:{}", host, at.port())
                              : fmt::format("{}:{}", host, at.port());
}

// --- the interface ---
Transport::Transport(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Transport>> Transport::start(const TransportOptions& options, Handler handler) {
  auto impl = std::make_unique<Impl>(options);
  impl->handler = std::move(handler);
  if (options.listens) SL_TRY(impl->listen());
  if (options.listens && options.udp) SL_TRY(open_udp(*impl));
  SL_TRY(impl->listen_locally());
  auto* const running = impl.get();
  impl->thread = std::thread([running] { running->run(); });
  return std::unique_ptr<Transport>(new Transport(std::move(impl)));
}

Transport::~Transport() { stop(); }

void Transport::stop() {
  SL_CHECK_MSG(impl_->thread.get_id() != std::this_thread::get_id(), "stop() from within the Handler");
  const std::lock_guard lock(impl_->stop_mutex);  // stop() may be called twice at once
  if (!impl_->thread.joinable()) return;
  net::post(impl_->io, [impl = impl_.get()] { impl->call([impl] { impl->begin_stop(); }); });
  impl_->thread.join();
}

std::uint16_t Transport::port() const { return impl_->bound.port(); }

std::string Transport::url() const {
  if (!impl_->options.listens) return "";
  auto address = impl_->bound.address();
  // "Everywhere" is not an address to go to; this machine's own is one of those that are meant.
  if (address.is_unspecified()) {
    if (address.is_v4()) address = net::ip::address_v4::loopback();
    else address = net::ip::address_v6::loopback();
  }
  if (address.is_v6()) {
    auto v6 = address.to_v6();
    v6.scope_id(0);  // has no place in a URL
    address = v6;
  }
  return fmt::format("http://{}/", Url{.host = address.to_string(), .port = port()}.authority());
}

bool Transport::send(ClientId client, std::span<const std::byte> head, Payload payload, bool text,
                     bool droppable) {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->queues.find(client);
  if (found == impl_->queues.end()) return false;
  Queue& queue = *found->second;
  const std::size_t most = impl_->options.queue_bytes;
  bool sent = false;
  try {
    Message message{.head = std::string(reinterpret_cast<const char*>(head.data()), head.size()),
                    .payload = std::move(payload),
                    .text = text};
    const std::size_t weight = message.weight();
    message.own = weight - (message.payload && message.payload.use_count() > 1 ? message.body() : 0);
    // Where all of them together hold too much, those that hold more than their part are the full ones.
    const bool crowded = impl_->own_bytes > 4 * most && queue.own > most / 8;
    sent = !queue.full && (queue.bytes == 0 || (queue.bytes + weight <= most && !crowded &&
                                                (!droppable || queue.bytes <= most / 2)));
    if (sent) {
      queue.bytes += weight;
      queue.own += message.own;
      impl_->own_bytes += message.own;
      queue.messages.push_back(std::move(message));
    }
  } catch (const std::bad_alloc&) { sent = false; }
  if (!sent) ++impl_->dropped, ++queue.dropped;
  if (!sent && !droppable) queue.full = true;
  if (sent || queue.full) impl_->schedule(client, queue);
  return sent;
}

bool Transport::send_text(ClientId client, std::string text) {
  const auto bytes = std::as_bytes(std::span(text));
  return send(client, {}, std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end()), true,
              false);
}

std::size_t Transport::waiting_bytes(ClientId client) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->queues.find(client);
  return found == impl_->queues.end() ? 0 : found->second->bytes;
}

ConnectionFacts Transport::facts(ClientId client) const {
  const auto found = impl_->peers.find(client);
  if (found == impl_->peers.end()) return {};
  ConnectionFacts out = found->second->facts;
  const std::lock_guard lock(impl_->mutex);
  if (const auto queue = impl_->queues.find(client); queue != impl_->queues.end())
    out.dropped = queue->second->dropped;
  return out;
}

void Transport::grant(ClientId client, double messages) {
  impl_->for_one(client, [messages](Peer& peer) { peer.grant(messages); });
}

void Transport::change_access(ClientId client, const Access& access) {
  impl_->for_one(client, [&access](Peer& peer) { peer.change_access(access); });
}

bool Transport::may_try_token(ClientId client) const {
  const auto found = impl_->peers.find(client);
  return found != impl_->peers.end() && impl_->guesses.allowed(found->second->address(), Clock::now());
}

void Transport::count_wrong_token(ClientId client) {
  const auto found = impl_->peers.find(client);
  if (found != impl_->peers.end()) impl_->guesses.count_wrong(found->second->address(), Clock::now());
}

void Transport::close_client(ClientId client, std::string_view reason) {
  net::post(impl_->io, [impl = impl_.get(), client, why = std::string(reason)] {
    impl->for_one(client, [&why](Peer& peer) { peer.close_for(why); });
  });
}

void Transport::post(std::function<void()> f) {
  net::post(impl_->io, [impl = impl_.get(), f = std::move(f)] { impl->call(f); });
}

Counters Transport::counters() const {
  return {.clients = impl_->open_clients,
          .accepted = impl_->accepted,
          .refused = impl_->refused,
          .dropped = impl_->dropped,
          .bytes_out = impl_->bytes_out,
          .bytes_in = impl_->bytes_in};
}

}  // namespace sandlot::server
