/// P7: one lockstep exchange over loopback TCP: a tick's notice to a client and its command back, through the server.
///
/// Measured is the wall time of a run of one robot in lockstep less that of the same run without a client, per step. The
/// reference is a bare echo of messages of the same sizes over loopback TCP, one after the other: the same client, and a
/// server of Asio's that does nothing else.
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "base/check.h"
#include "base/test_folder.h"
#include "bench/bench.h"
#include "bench/one_processor.h"
#include "console/console.h"
#include "server/server.h"
#include "sim/load/load.h"
#include "sim/session/session.h"

namespace sandlot::bench {
namespace {

namespace asio = boost::asio;

constexpr int steps = 2000;
constexpr std::string_view notice =
    R"({"op":"sandlot.tick","program":"rover1/brain","step":1000,"time":{"sec":10,"nanosec":0},"random":"12345678901234567890"})"
    "\n";

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int connected_to(std::uint16_t port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  SL_CHECK(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

void write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const auto n = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

/// Reads lines; false: the end.
class Lines {
 public:
  explicit Lines(int fd) : fd_(fd) {}
  bool next(std::string& line) {
    std::size_t end = 0;
    while ((end = rest_.find('\n')) == std::string::npos) {
      char bytes[4096];
      const auto n = ::recv(fd_, bytes, sizeof bytes, 0);
      if (n <= 0) return false;
      rest_.append(bytes, static_cast<std::size_t>(n));
    }
    line.assign(rest_, 0, end);
    rest_.erase(0, end + 1);
    return true;
  }

 private:
  int fd_;
  std::string rest_;
};

std::string command(std::string_view step) {
  return R"({"op":"publish","topic":"/rover1/drive","msg":{"linear":{"x":0.1,"y":0,"z":0},"angular":{"x":0,"y":0,"z":0.2}}})"
         "\n{\"op\":\"sandlot.done\",\"step\":" +
         std::string(step) + "}\n";
}

/// A rover in an empty plane, with a control step in every tick.
std::unique_ptr<Simulation> make_run(bool lockstep) {
  const test::TestFolder folder;
  std::ofstream(folder.file("run.yaml"))
      << "version: 1\nphysics: planar\ntime: {step: 20 ms, stop: " << steps / 50
      << " s}\nrobots:\n  - {name: rover1, model: rover" << (lockstep ? ", controller: remote" : "") << "}\n";
  Diagnostics diagnostics;
  auto setup = load(folder.file("run.yaml"), {}, diagnostics);
  SL_CHECK_MSG(setup, setup ? "" : setup.error().text().c_str());
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  SL_CHECK_MSG(made, made ? "" : made.error().text().c_str());
  return std::move(*made);
}

/// Seconds per step of a run whose robot a client drives, or nobody.
double one_run(bool lockstep) {
  Session session(make_run(lockstep), {.history_mb = 0});
  Console console(session, {});
  auto server = server::Server::start({.transport = {.port = 0}, .name = "lockstep", .version = ""}, session,
                                      console);
  SL_CHECK_MSG(server, server ? "" : server.error().text().c_str());
  std::thread client;
  const std::string url = (*server)->url();
  const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  if (lockstep)
    client = std::thread([port] {
      const int fd = connected_to(port);
      write_all(
          fd,
          "{\"op\":\"sandlot.claim\",\"robot\":\"rover1\",\"mode\":\"lockstep\",\"deadline_ms\":10000}\n");
      Lines lines(fd);
      for (std::string line; lines.next(line);) {
        const std::size_t at = line.find("\"step\":");
        if (line.find("sandlot.tick") == std::string::npos || at == std::string::npos) continue;
        const std::size_t begin = at + 7;
        write_all(fd, command(std::string_view(line).substr(begin, line.find(',', begin) - begin)));
      }
      ::close(fd);
    });
  RunReport report;
  double begin = 0;
  const Status status = session.run(report, [&](const Simulation& simulation) {
    if (begin == 0 && simulation.tick_index() > 0) begin = wall_seconds();
    return true;
  });
  const double used_s = wall_seconds() - begin;
  SL_CHECK_MSG(status, status ? "" : status.error().text().c_str());
  (*server)->stop();
  if (client.joinable()) client.join();
  return used_s / steps;
}

/// A server of Asio's that says the same and takes the same answers, and does nothing with them.
class Echo {
 public:
  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  /// Takes the client and exchanges so many messages. @return seconds per exchange
  double run(int exchanges) {
    acceptor_.async_accept(socket_, [&](boost::system::error_code error) {
      SL_CHECK(!error);
      socket_.set_option(asio::ip::tcp::no_delay(true));
      begin_ = wall_seconds();
      left_ = exchanges;
      tell();
    });
    io_.run();
    return (wall_seconds() - begin_) / exchanges;
  }

 private:
  void tell() {
    asio::async_write(socket_, asio::buffer(notice),
                      [&](boost::system::error_code error, std::size_t) { SL_CHECK(!error), hear(0); });
  }
  void hear(std::ptrdiff_t lines) {
    socket_.async_read_some(asio::buffer(bytes_),
                            [this, lines](boost::system::error_code error, std::size_t size) {
                              SL_CHECK(!error);
                              const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(size);
                              const auto heard = lines + std::count(bytes_.begin(), end, '\n');
                              if (heard < 2) return hear(heard);
                              if (--left_ > 0) tell();
                            });
  }
  asio::io_context io_{1};
  asio::ip::tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}};
  asio::ip::tcp::socket socket_{io_};
  std::array<char, 16 << 10> bytes_{};
  int left_ = 0;
  double begin_ = 0;
};

/// Seconds per message and answer of the same sizes.
double echo() {
  Echo server;
  const std::string answer = command("1000");
  std::thread client([&answer, port = server.port()] {
    const int fd = connected_to(port);
    Lines lines(fd);
    for (int i = 0; i < steps; ++i) {
      std::string line;
      SL_CHECK(lines.next(line));
      write_all(fd, answer);
    }
    ::close(fd);
  });
  const double used_s = server.run(steps);
  client.join();
  return used_s;
}

}  // namespace

std::vector<Row> lockstep() {
  const OneProcessor one;
  std::vector<double> ours, reference;
  for (int i = 0; i < 4; ++i) {  // the first warms up
    const double alone_s = one_run(false);
    ours.push_back(one_run(true) - alone_s);
    reference.push_back(echo());
  }
  const auto median = [](std::vector<double>& all) {
    all.erase(all.begin());
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
  };
  // Wall time between threads: it swings with the machine's load.
  return {row("P7 lockstep exchange over loopback TCP", "us", 1e6 * median(ours), 1e6 * median(reference), 3,
              12)};
}

}  // namespace sandlot::bench
