/// JSON objects by UDP, one per datagram: a client is an address and a port that has shown that it receives
/// (server/http/udp_gate.h), until it is silent for `udp_silence_s`.
///
/// To others nothing is sent but a challenge, never longer than what asked for it; a datagram without the session's key
/// is as one from nobody.
#include <sys/random.h>

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <vector>

#include "base/json_writer.h"
#include "base/log.h"
#include "server/http/beast/impl.h"
#include "server/http/http.h"
#include "server/http/udp_gate.h"
#include "wire/rosbridge.h"

namespace sandlot::server {

using udp = net::ip::udp;

namespace {

constexpr std::size_t most_first_bytes = 4096;  ///< of a datagram without a key
constexpr std::size_t most_per_address = 16;    ///< clients
constexpr std::size_t most_read_bytes = 1 << 16;

std::vector<std::byte> bytes_of(const net::ip::address& address) {
  std::vector<std::byte> out;
  const auto add = [&](const auto& bytes) {
    for (const unsigned char each : bytes) out.push_back(static_cast<std::byte>(each));
  };
  if (address.is_v4()) add(address.to_v4().to_bytes());
  else add(address.to_v6().to_bytes());
  return out;
}

std::vector<std::byte> bytes_of(const udp::endpoint& from) {
  std::vector<std::byte> out = bytes_of(from.address());
  out.push_back(static_cast<std::byte>(from.port() >> 8));
  out.push_back(static_cast<std::byte>(from.port() & 0xff));
  return out;
}

struct UdpPeer;

}  // namespace

struct UdpDoor : std::enable_shared_from_this<UdpDoor> {
  Transport::Impl& impl;
  udp::socket socket;
  UdpGate gate;
  std::array<char, most_read_bytes> buffer{};
  udp::endpoint from;
  std::map<udp::endpoint, std::shared_ptr<UdpPeer>> clients;
  /// Addresses that were sent away, and when: until the nonces they had are no good any more nobody listens to them.
  std::map<udp::endpoint, double> sent_away_s;

  UdpDoor(Transport::Impl& owner, std::array<std::uint64_t, 4> keys)
      : impl(owner), socket(owner.io), gate(keys) {}
  Status open();
  void receive();
  void take(std::string_view text);
  void send_away(const udp::endpoint& client);
  bool is_away(double now_s);
  void take_unknown(std::string_view text);
  void begin(std::string nonce, std::string_view text);
  static double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }
};

namespace {

struct UdpPeer final : Peer, std::enable_shared_from_this<UdpPeer> {
  enum class Stage { open, closing, gone };
  UdpDoor& door;
  Transport::Impl& impl;
  const std::uint64_t id;
  const udp::endpoint to;
  const std::string sender;  ///< its address
  const std::string nonce;
  Access access = admit("", "", impl.options.tokens, impl.on_loopback()).access;
  Stage stage = Stage::open;
  std::shared_ptr<Queue> queue = std::make_shared<Queue>();
  Message current;
  bool writing = false;
  std::string farewell;
  const Clock::time_point came = Clock::now();
  Clock::time_point heard = came, closing_since;
  Allowance allowance{impl.options};

  UdpPeer(UdpDoor& owner, std::uint64_t number, const udp::endpoint& address, std::string key)
      : door(owner),
        impl(owner.impl),
        id(number),
        to(address),
        sender(address.address().to_string()),
        nonce(std::move(key)) {}

  void begin() override {
    ++impl.clients;
    ++impl.accepted;
    ++impl.open_clients;
    {
      const std::lock_guard lock(impl.mutex);
      impl.queues.emplace(id, queue);
    }
    if (impl.handler.connected) impl.handler.connected(id, access, "udp");
  }

  void take(std::string_view text) {
    heard = Clock::now();
    if (stage != Stage::open) return;
    if (!allowance.take(heard)) return close_for(allowance.refusal());
    if (impl.handler.message) impl.handler.message(id, std::as_bytes(std::span(text)), true);
  }

  void flush() override {
    if (writing || stage == Stage::gone) return;
    bool full = false;
    while (!writing && !full) {
      {
        const std::lock_guard lock(impl.mutex);
        queue->scheduled = false;
        full = queue->full;
        if (full || queue->messages.empty()) break;
        current = std::move(queue->messages.front());
        queue->messages.pop_front();
        if (current.text && current.size() <= most_datagram_bytes) {
          writing = true;
        } else {  // it fits no datagram
          forget_current();
          ++impl.dropped;
        }
      }
    }
    if (full && stage == Stage::open) return close_for("you are too slow: the queue is full");
    if (writing) return write();
    if (stage == Stage::closing) say_good_bye();
  }

  /// @pre impl.mutex is held
  void forget_current() {
    queue->bytes -= std::min(queue->bytes, current.weight());
    const std::size_t own = std::min(queue->own, current.own);
    queue->own -= own;
    impl.own_bytes -= own;
  }

  void write() {
    const std::array<net::const_buffer, 2> parts{
        net::buffer(current.head),
        net::const_buffer(current.payload ? current.payload->data() : nullptr, current.body())};
    door.socket.async_send_to(parts, to, [self = shared_from_this()](error_code, std::size_t n) {
      if (self->stage == Stage::gone) return;
      self->impl.bytes_out += n;
      self->writing = false;
      {
        const std::lock_guard lock(self->impl.mutex);
        self->forget_current();
      }
      self->current = {};
      self->impl.call([&] { self->flush(); });
    });
  }

  void say_good_bye() {
    error_code ignored;
    impl.bytes_out += door.socket.send_to(net::buffer(farewell), to, 0, ignored);
    end();
  }

  void close(std::string_view level, std::string_view reason) {
    if (stage != Stage::open) return;
    stage = Stage::closing;
    closing_since = Clock::now();
    farewell = fmt::format("{{\"op\":\"status\",\"level\":\"{}\",\"msg\":", level);
    append_json(reason, farewell);
    farewell += "}";
    {
      const std::lock_guard lock(impl.mutex);
      impl.queues.erase(id);
      queue->full = false;
    }
    flush();
  }

  void close_for(std::string_view reason) override {
    if (stage != Stage::open) return;
    ++impl.refused;
    door.send_away(to);
    close("error", reason);
  }

  void on_beat(Clock::time_point now) override {
    const auto over = [&](Clock::time_point since, double s) {
      return std::chrono::duration<double>(now - since).count() > s;
    };
    if (stage == Stage::open && over(heard, impl.options.udp_silence_s)) close("info", "silent for too long");
    else if (stage == Stage::closing && over(closing_since, 1)) end();
  }

  void grant(double messages) override { allowance.grant(messages); }
  void stop() override {
    {
      const std::lock_guard lock(impl.mutex);
      impl.dropped += queue->messages.size();
      queue->messages.clear();
    }
    close("info", "the server ends");
    if (stage == Stage::closing) say_good_bye();  // a datagram is still being sent
    end();
  }
  bool idle() const override { return false; }
  bool dawdles(Clock::time_point) const override { return false; }  // the nonce was its request
  bool is_old_guest(Clock::time_point now) const override {
    return stage == Stage::open && access.role == Role::guest && now > came + patience_with_guests;
  }
  void change_access(const Access& now) override { access = now; }
  const std::string& address() const override { return sender; }

  void end() override {
    if (stage == Stage::gone) return;
    stage = Stage::gone;
    const auto self = shared_from_this();
    impl.peers.erase(id);
    door.clients.erase(to);
    {
      const std::lock_guard lock(impl.mutex);
      impl.queues.erase(id);
      impl.dropped += queue->messages.size();
      queue->messages.clear();
      impl.own_bytes -= std::exchange(queue->own, 0);
    }
    --impl.clients;
    --impl.open_clients;
    impl.call([this] {
      if (impl.handler.disconnected) impl.handler.disconnected(id);
    });
  }
};

}  // namespace

Status UdpDoor::open() {
  error_code ec;
  const udp::endpoint at(impl.bound.address(), impl.bound.port());
  socket.open(at.protocol(), ec);
  if (!ec && at.address().is_v6() && at.address().is_unspecified())
    socket.set_option(net::ip::v6_only(false), ec);
  if (!ec) socket.bind(at, ec);
  if (!ec) socket.non_blocking(true, ec);
  if (ec)
    return Error{
        fmt::format("UDP port {} of {} cannot be used: {}", at.port(), impl.options.address, ec.message()),
        "choose another with --port, or leave --udp out"};
  ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
  return {};
}

void UdpDoor::receive() {
  socket.async_receive_from(net::buffer(buffer), from,
                            [self = shared_from_this()](error_code ec, std::size_t n) {
                              if (ec == net::error::operation_aborted || !self->socket.is_open()) return;
                              if (!ec) {
                                self->impl.bytes_in += n;
                                self->impl.call([&] { self->take({self->buffer.data(), n}); });
                              }
                              self->receive();
                            });
}

void UdpDoor::take(std::string_view text) {
  const auto known = clients.find(from);
  if (known == clients.end() || !same_secret(nonce_in(text), known->second->nonce)) return take_unknown(text);
  const std::shared_ptr<UdpPeer> peer = known->second;
  peer->take(text);
}

/// Only clients come here, which have shown that the address is theirs.
void UdpDoor::send_away(const udp::endpoint& client) {
  constexpr std::size_t most = 1000;
  const double now = now_s();
  std::erase_if(sent_away_s, [&](const auto& each) { return now > each.second + 2 * UdpGate::valid_s; });
  if (sent_away_s.size() < most) sent_away_s[client] = now;
}

bool UdpDoor::is_away(double now_s) {
  const auto found = sent_away_s.find(from);
  return found != sent_away_s.end() && now_s <= found->second + 2 * UdpGate::valid_s;
}

void UdpDoor::take_unknown(std::string_view text) {
  const auto refuse = [&] { ++impl.refused; };
  const double now = now_s();
  if (is_away(now)) return refuse();
  if (impl.stopping || text.size() > most_first_bytes || !gate.allow(bytes_of(from.address()), now))
    return refuse();
  const std::vector<std::byte> peer = bytes_of(from);
  const std::string_view given = nonce_in(text);
  if (!given.empty()) {
    if (!gate.is_nonce(given, peer, now)) return refuse();
    return begin(std::string(given), text);
  }
  const auto read = rosbridge::read_text(text);
  if (!read || !std::holds_alternative<rosbridge::Hello>(read->operation)) return refuse();
  const std::string challenge = fmt::format("{{\"op\":\"sandlot.challenge\",\"nonce\":\"{}\"}}",
                                            gate.nonce(peer, now));
  // Whoever's address this is gets no more than was sent in its name.
  if (challenge.size() > text.size()) return refuse();
  error_code ignored;
  impl.bytes_out += socket.send_to(net::buffer(challenge), from, 0, ignored);
}

/// A client that has come back with its nonce.
void UdpDoor::begin(std::string nonce, std::string_view text) {
  if (const auto before = clients.find(from); before != clients.end()) {  // the same port, begun again
    const std::shared_ptr<UdpPeer> peer = before->second;
    peer->end();
  }
  const auto here = static_cast<std::size_t>(
      std::count_if(clients.begin(), clients.end(),
                    [&](const auto& each) { return each.first.address() == from.address(); }));
  if (impl.clients >= impl.options.most_clients || here >= most_per_address) {
    ++impl.refused;
    return;
  }
  const auto id = impl.next_id++;
  const auto peer = std::make_shared<UdpPeer>(*this, id, from, std::move(nonce));
  impl.peers.emplace(id, peer);
  clients.emplace(from, peer);
  const std::string first(text);
  impl.for_one(id, [](Peer& each) { each.begin(); });
  if (peer->stage == UdpPeer::Stage::open) peer->take(first);
}

Status open_udp(Transport::Impl& impl) {
  std::array<std::uint64_t, 4> keys{};
  if (getrandom(keys.data(), sizeof keys, 0) != static_cast<ssize_t>(sizeof keys))
    return Error{"the system has no random numbers for keys", "leave --udp out"};
  impl.udp = std::make_shared<UdpDoor>(impl, keys);
  SL_TRY(impl.udp->open());
  impl.udp->receive();
  return {};
}

void close_udp(Transport::Impl& impl) {
  error_code ignored;
  if (impl.udp) impl.udp->socket.close(ignored);
}

}  // namespace sandlot::server
