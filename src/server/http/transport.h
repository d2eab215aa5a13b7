#pragma once
/// One port for HTTP and WebSocket: sockets, limits, queues. Admission is decided by server/http/http.h; the content of messages is the Handler's matter.
///
/// Threads   one thread of its own runs all connections and calls the Handler; send(), close_client(), post() and counters() may be called from
///           any thread, stop() from any but the Handler's.
/// Queues    each client has one, of `queue_bytes`; all together have four times that, beyond which the fullest count as full. A droppable message that finds it more than half full is dropped and counted; one that must
///           arrive and finds it full closes the client, with a reason. An empty queue takes a message of any size. A client that takes nothing
///           for `stall_s` is closed. A message of more than 1 MiB goes out in fragments of that size.
/// Refused   (counted, answered with a reason and an HTTP status) what is no HTTP, heads over 16 KiB, bodies, methods but GET and HEAD,
///           requests with another site's Origin or, on loopback, a Host that is not loopback's (DNS rebinding); WebSockets with no known
///           sub-protocol, a wrong token, beyond `most_clients`; requests that take longer than `handshake_s`; sockets beyond
///           `most_per_address`. Where there is no room, who has asked nothing for a second, or is a guest for two, makes room.
/// Shares    a client whose messages have taken more than `work_share` of the thread's time is read later: nothing is lost, and TCP slows
///           the sender.
/// TCP       a connection whose first byte is `{` carries JSON objects both ways, with a line break behind each of ours. It gets text
///           messages alone; its good-bye is a last object.
/// UDP       with the option, at the same number: a JSON object per datagram, both ways, from clients that have shown that they
///           receive (server/http/udp_gate.h). It gets text messages of at most most_datagram_bytes; longer ones are dropped.
/// Local     ports in the file system take the same; their connections have the port's access, and are not among `most_clients`.
/// Closed    (counted as refused, with a code and a reason) clients whose messages are over the limits of wire/foxglove.h (spectators: 1 MiB,
///           whatever the kind), come at more than `messages_per_s` for long, or are no WebSocket frames.
/// Gone      a client that is silent for `silence_s` although it was sent pings; an HTTP connection that asks nothing for `idle_s`.
/// Errors    start(): the address cannot be bound. An exception out of the Handler or out of memory ends the one connection it concerns.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "server/http/access.h"

namespace sandlot::server {

using ClientId = std::uint64_t;
/// Bytes that several clients may wait for at once.
using Payload = std::shared_ptr<const std::vector<std::byte>>;
inline Payload payload_of(std::string_view text) {
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return std::make_shared<const std::vector<std::byte>>(begin, begin + text.size());
}

/// A datagram's payload that every system takes, of messages to clients.
inline constexpr std::size_t most_datagram_bytes = 65'000;
/// A socket of the file system, whose connections have an access of their own: who can open it is let in.
struct LocalPort {
  std::string path;
  Access access;
};

struct TransportOptions {
  bool listens = true;  ///< at address and port; else only local ports are there
  std::vector<LocalPort> local_ports;
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;         ///< 0: any that is free
  bool next_free = false;            ///< when it is taken, try the 20 after it
  std::vector<Token> tokens;         ///< none: on loopback everybody may steer, elsewhere nobody
  std::vector<std::string> origins;  ///< other sites whose pages may connect: "https://app.example.org"
  std::vector<std::string> subprotocols;
  bool none_offered = false;  ///< whether a WebSocket may come without a sub-protocol
  bool raw_json =
      false;  ///< whether a connection may begin with `{`: JSON objects over TCP, one behind the other
  bool udp = false;
  std::size_t most_clients = 64;
  std::size_t queue_bytes = 32u << 20;
  std::size_t most_sockets = 256;  ///< with those that speak HTTP
  /// Sockets of one address; of loopback, which all programs of a machine share.
  std::size_t most_per_address = 32, most_from_loopback = 256;
  double wrong_tokens_at_once = 20, wrong_token_pause_s = 1;  ///< per address; server/http/guesses.h
  double messages_per_s = 2000, messages_at_once = 4000;      ///< of one client; who sends more is closed
  double work_share = 0.25;  ///< of the thread's time that the messages of one client may take
  double handshake_s = 10, stall_s = 30, silence_s = 30, idle_s = 60;
  double udp_silence_s = 10;
};

struct Counters {
  std::uint64_t clients = 0, accepted = 0, refused = 0, dropped = 0, bytes_out = 0, bytes_in = 0;
};

/// Figures of one client's connection.
struct ConnectionFacts {
  std::string address;  ///< of the other side, "127.0.0.1:50312", "unix socket"
  std::string name;     ///< that the client gives itself: `name` in the query of its URL
  std::uint64_t bytes_in = 0, bytes_out = 0, dropped = 0;
};

/// What an HTTP GET is answered with.
struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::vector<std::byte>> owned;  ///< keeps `body` alive; null: it is static
  std::span<const std::byte> body;
  std::string etag;  ///< without quotes; "": not to be cached
};

struct Handler {
  /// `target` is decoded, begins with "/" and has neither query nor "..".
  std::function<HttpAnswer(std::string_view target)> get;
  /// @param subprotocol  "": the client offered none; "tcp", "udp": it sends JSON objects without a WebSocket
  std::function<void(ClientId, const Access&, std::string_view subprotocol)> connected;
  std::function<void(ClientId, std::span<const std::byte> bytes, bool text)> message;
  std::function<void(ClientId)> disconnected;
  /// About 30 times a second, for what is due by the wall clock.
  std::function<void()> timer;
};

class Transport {
 public:
  static Result<std::unique_ptr<Transport>> start(const TransportOptions& options, Handler handler);
  /// As stop().
  ~Transport();
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  std::uint16_t port() const;
  /// "http://127.0.0.1:8765/"
  std::string url() const;

  /// Queues a message of two parts that are sent as one (a header of this client's, a payload shared by many).
  /// @return false: dropped, or the client is gone
  bool send(ClientId client, std::span<const std::byte> head, Payload payload, bool text, bool droppable);
  bool send_text(ClientId client, std::string text);
  /// Bytes that wait for a client: those who can choose send less to the slow.
  std::size_t waiting_bytes(ClientId client) const;
  /// Empty when the client is gone. On the transport's thread.
  ConnectionFacts facts(ClientId client) const;
  /// Allows a client so many messages beyond those per second: it was asked for them. On the transport's thread.
  void grant(ClientId client, double messages);
  /// What a client may do has changed. On the transport's thread.
  void change_access(ClientId client, const Access& access);
  /// Whether tokens of the client's address may be looked at. On the transport's thread, as the next.
  bool may_try_token(ClientId client) const;
  void count_wrong_token(ClientId client);
  /// What is queued is still sent, then the reason (its first 123 bytes), with code 1008.
  void close_client(ClientId client, std::string_view reason);
  /// Runs f on the transport's thread, soon.
  void post(std::function<void()> f);
  Counters counters() const;
  /// Closes all clients, waits at most 2 s for them, ends the thread. No call of the Handler comes after it.
  void stop();

  struct Impl;

 private:
  explicit Transport(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A WebSocket client, for `sandlot console`; blocking, for one thread. Pings are answered by a thread of its own, so that the user may think
/// for as long as he likes; 64 MiB that nobody receives stop it reading.
class WebSocketClient {
 public:
  /// @param url  "ws://127.0.0.1:8765/?token=..."
  static Result<std::unique_ptr<WebSocketClient>> connect(const std::string& url,
                                                          std::string_view subprotocol, double timeout_s);
  ~WebSocketClient();
  Status send(std::span<const std::byte> bytes, bool text);
  struct Message {
    std::vector<std::byte> bytes;
    bool text = false;
  };
  /// Waits for a message. An error: the connection is gone, or nothing came in time.
  Result<Message> receive(double timeout_s);
  /// False: the connection is gone, and what had come before has been received.
  bool open() const;

 private:
  struct Impl;
  explicit WebSocketClient(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot::server
