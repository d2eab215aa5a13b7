#pragma once
/// TCP port: a listening socket of its own whose connections carry plain bytes both ways, for protocols in which the server speaks first.
///
/// Threads   one thread of its own runs all connections and calls the handler. post(), counters() and port() may be called from any
///           thread, stop() from any but that one; all else belongs to that thread.
/// Queues    each connection has one, of `queue_bytes`: who lets it fill, or takes nothing for `stall_s`, is closed and counted.
/// Shares    a connection is read at `read_bytes_per_s` at most, with as much at once: nothing is lost, and TCP slows the sender.
/// Refused   (counted) connections beyond `most_connections`, and those that the handler does not want.
/// Gone      a peer whose machine does not answer: TCP asks after 5 s of silence, three times within 6 s.
/// Errors    listen(): the address cannot be bound. An exception out of the handler ends the one connection that it concerns.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"

namespace sandlot::server {

struct TcpPortOptions {
  std::string option;  ///< that chooses the port, for errors: "--refbox"
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any that is free
  std::size_t most_connections = 8;
  std::size_t queue_bytes = 64u << 10;
  double stall_s = 10;
  double read_bytes_per_s = 1u << 20;
  int send_buffer_bytes = 64 << 10;  ///< of the kernel
};

struct TcpPortCounters {
  std::uint64_t open = 0, accepted = 0, refused = 0;
  std::uint64_t stalled = 0;  ///< closed because they did not read
};

class TcpPort {
 public:
  using Id = std::uint64_t;
  struct Handler {
    /// @param address  of the other side, without its port: "127.0.0.1". @return false: it is closed at once
    std::function<bool(Id, const std::string& address)> connected;
    std::function<void(Id, std::string_view bytes)> received;
    /// Once for each that was wanted.
    std::function<void(Id)> disconnected;
  };
  /// Who connects waits until begin().
  static Result<std::unique_ptr<TcpPort>> listen(const TcpPortOptions& options);
  /// Starts the thread. To be called once.
  void begin(Handler handler);
  /// As stop().
  ~TcpPort();
  TcpPort(const TcpPort&) = delete;
  TcpPort& operator=(const TcpPort&) = delete;

  std::uint16_t port() const;
  void send(Id to, std::string_view bytes);
  /// What is queued may be lost.
  void close(Id connection);
  /// Runs f on the port's thread, soon. Nothing after stop().
  void post(std::function<void()> f);
  TcpPortCounters counters() const;
  /// Closes all connections and ends the thread. No call of the handler comes after it.
  void stop();

  struct Impl;

 private:
  explicit TcpPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot::server
