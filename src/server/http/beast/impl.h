#pragma once
/// Shared declarations of transport.cpp (the port, the interface) and peer.cpp (a connection, all that needs
/// Beast). Not for others to include.
///
/// Everything here belongs to the one thread that runs `io`, but for the atomic counters and what Impl::mutex guards.
#include "base/sanitizers.h"
#if SL_THREAD_SANITIZER
#define BOOST_ASIO_DISABLE_FENCED_BLOCK  // the sanitizer knows no fences; Asio's mutexes order everything without them
#endif
#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "base/text.h"
#include "server/http/guesses.h"
#include "server/http/transport.h"

namespace sandlot::server {

namespace net = boost::asio;
using tcp = net::ip::tcp;
using local = net::local::stream_protocol;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// With somebody who has neither a token nor a claim, when others want in.
inline constexpr auto patience_with_guests = std::chrono::seconds(2);

/// How long clients have for good-byes.
constexpr auto goodbye = std::chrono::milliseconds(1500);

struct Message {
  std::string head;  // 13 bytes in general: no allocation
  Payload payload;
  bool text = false;
  std::size_t body() const { return payload ? payload->size() : 0; }
  std::size_t size() const { return head.size() + body(); }
  /// What it counts in a queue: a million empty ones take memory too.
  std::size_t weight() const { return size() + 128; }
  std::size_t own = 0;  // of its weight, what no other queue shares
};

/// What waits for one client. Guarded by Impl::mutex.
struct Queue {
  std::deque<Message> messages;
  std::size_t bytes = 0;   // with that being written
  std::size_t own = 0;     // of these, what no other queue shares
  bool scheduled = false;  // flush() is on its way
  bool full = false;       // something that must arrive did not fit
  std::uint64_t dropped = 0;
};

/// The messages that a client may still send: so many at once, and so many more a second.
struct Allowance {
  explicit Allowance(const TransportOptions& options)
      : per_s(options.messages_per_s), most(options.messages_at_once), left(most) {}
  /// @return whether there was one left
  bool take(Clock::time_point now = Clock::now()) {
    left = std::min(most, left + per_s * std::chrono::duration<double>(now - last).count());
    last = now;
    return (left -= 1) >= 0;
  }
  void grant(double messages) { left = std::min(most, left + messages); }
  std::string refusal() const { return "more than " + number_text(per_s) + " messages a second"; }

  double per_s, most, left;
  Clock::time_point last = Clock::now();
};

/// A connection, from accept to end. Every function may end it; whoever calls holds a PeerPtr meanwhile.
struct Peer {
  virtual ~Peer() = default;
  virtual void begin() = 0;
  /// Looks at the deadlines.
  virtual void on_beat(Clock::time_point now) = 0;
  /// Sends what has been queued.
  virtual void flush() = 0;
  /// Allows so many messages beyond those per second.
  virtual void grant(double messages) = 0;
  /// Sends what is queued, then the reason, then ends.
  virtual void close_for(std::string_view reason) = 0;
  /// The server stops: ends at once, or very soon.
  virtual void stop() = 0;
  virtual void end() = 0;
  /// Whether there was no request since the last answer.
  virtual bool idle() const = 0;
  /// Whether it has been connected for some time, and has not made a request.
  virtual bool dawdles(Clock::time_point now) const = 0;
  /// Whether it has been a guest for some time.
  virtual bool is_old_guest(Clock::time_point now) const = 0;
  virtual void change_access(const Access& access) = 0;
  /// Its address, as Impl counts them.
  virtual const std::string& address() const = 0;

  ConnectionFacts facts;  ///< but for what was dropped
};
using PeerPtr = std::shared_ptr<Peer>;

struct UdpDoor;  // udp.cpp

struct Transport::Impl {
  explicit Impl(const TransportOptions& the_options) : options(the_options) {}

  const TransportOptions options;
  Handler handler;
  // Destroyed last: what is under way in it holds the peers.
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  tcp::endpoint bound;
  std::deque<local::acceptor> local_acceptors;         // as options.local_ports
  std::map<std::uint64_t, std::size_t> local_port_of;  // peers that came there
  std::vector<std::size_t> paused_ports;               // that accept again at the next beat
  net::steady_timer timer{io};
  std::map<std::uint64_t, PeerPtr> peers;
  std::shared_ptr<UdpDoor> udp;  ///< null: not listened to
  std::uint64_t next_id = 1;
  std::size_t clients = 0;                        // peers that have been let in, or are about to
  std::map<std::string, std::size_t> sockets_of;  // number by address
  Guesses guesses{options.wrong_tokens_at_once, options.wrong_token_pause_s};
  bool accept_again = false, stopping = false;
  Clock::time_point next_beat, last_moment;

  mutable std::mutex mutex;
  std::map<ClientId, std::shared_ptr<Queue>> queues;
  std::size_t own_bytes = 0;  // of all queues
  std::mutex stop_mutex;
  std::atomic<std::uint64_t> open_clients{0}, accepted{0}, refused{0}, dropped{0}, bytes_out{0}, bytes_in{0};
  std::thread thread;

  Status listen();
  Status listen_locally();
  bool on_loopback() const;
  void run();
  void accept();
  void accept_locally(std::size_t port);
  void admit_socket(tcp::socket socket, std::optional<std::size_t> local_port = std::nullopt);
  /// Of a peer that came to a local port; null: it did not.
  const Access* local_access(std::uint64_t id) const;
  bool has_room(const std::string& address);
  bool has_room_for_client();
  void on_beat();
  void begin_stop();
  void call(const std::function<void()>& f) noexcept;
  void for_one(std::uint64_t id, const std::function<void(Peer&)>& f);
  void for_all(const std::function<void(Peer&)>& f);
  void schedule(ClientId client, Queue& queue);
};

/// "127.0.0.1:50312", "unix socket"; "": the connection is gone.
std::string remote_address(const tcp::socket& socket);
/// Defined in peer.cpp.
PeerPtr make_peer(Transport::Impl& impl, std::uint64_t id, tcp::socket socket, std::string address);

/// Listens to datagrams at the port that is bound. Defined in udp.cpp, as the next.
Status open_udp(Transport::Impl& impl);
void close_udp(Transport::Impl& impl);

}  // namespace sandlot::server
