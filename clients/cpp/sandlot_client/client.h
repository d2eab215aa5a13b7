#pragma once
/// Drives robots of a Sandlot run from C++17: this header, POSIX sockets and nlohmann/json, nothing of the simulator.
///
///   #include <sandlot_client/client.h>
///
///   sandlot::client::Robot rover("rover", {.lockstep = true});
///   const auto& laser = rover.subscribe("laser");
///   while (const auto step = rover.next_step()) {
///     const bool near = !laser.message.is_null() && laser.message["ranges"][135] < 0.5;
///     rover.command("drive", {{"linear", {{"x", near ? 0.0 : 0.3}}}});
///   }
///
/// Protocol   rosbridge v2 as JSON over TCP, with claims and lockstep of Sandlot's own: docs/clients.md.
/// Messages   JSON objects with the field names of ROS 2; lists of numbers are arrays; lists of bytes are base64 text, see
///            data_of(). Numbers that are not finite are null in both directions.
/// Address    Options::url, or SANDLOT_URL, or tcp://127.0.0.1:8765; unix:PATH reaches a run from inside a sandbox.
/// Token      Options::token, or SANDLOT_TOKEN.
/// Errors     Refused: a request that the server has refused, with its reason. Disconnected: the connection has ended, or could not be
///            made. TimedOut: no answer came.
/// Threads    none: messages are taken while next_step(), spin(), poll() or call() wait. One object belongs to one thread.
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace sandlot::client {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// A request that the server has refused.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The connection has ended or could not be made.
struct Disconnected : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// No answer came in time.
struct TimedOut : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Options {
  std::string url = {}, token = {};
  bool lockstep = false;
  double deadline_s = 1;  ///< longest wall time between a step and its end, at most that of the scenario
  double timeout_s = 10;  ///< longest wait for the connection and for answers
};

/// Latest message of a topic.
struct Reading {
  std::string topic;
  Json message;  ///< null until one has come
  std::uint64_t count = 0;
  /// Whether a message has come since the last call.
  bool fresh() { return std::exchange(seen, count) < count; }
  std::uint64_t seen = 0;
};

/// A control step.
struct Step {
  std::string program;
  std::uint64_t number = 0;
  std::int64_t time_ns = 0;  ///< simulated
  std::uint64_t random = 0;  ///< the program's own, another one in each step
  double time_s() const { return static_cast<double>(time_ns) / 1e9; }
};

inline std::string to_base64(std::string_view bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}
/// @throws Refused  where the text is not base64
inline std::string from_base64(std::string_view text) {
  std::string out;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (value < 0) throw Refused("a field of bytes is not base64");
    word = (word << 6 | static_cast<std::uint32_t>(value)) & 0xffffff;
    if ((bits += 6) >= 8) out += static_cast<char>(word >> (bits -= 8) & 0xff);
  }
  return out;
}

/// Bytes of a field of octets.
inline std::string data_of(const Json& message, const std::string& key = "data") {
  const Json& value = message.at(key);
  if (value.is_string()) return from_base64(value.get_ref<const std::string&>());
  std::string out;
  for (const Json& each : value) out += static_cast<char>(each.get<int>());
  return out;
}
/// A message for a radio. @param to  a robot, a team, an address; empty: all
inline Json packet(std::string_view data, const std::string& to = "") {
  return {{"to", to}, {"data", to_base64(data)}};
}

/// A connection to a run: topics, services, statuses.
class Connection {
 public:
  using Handler = std::function<void(const Json&)>;

  explicit Connection(const Options& options = {}) : timeout_s_(options.timeout_s) {
    connect_to(!options.url.empty() ? options.url : environment("SANDLOT_URL", "tcp://127.0.0.1:8765"));
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { close(); }

  void close() {
    if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  }
  /// Called with each refusal that answers no call.
  std::function<void(const Json& status)> on_status = [](const Json& status) {
    const std::string level = status.value("level", "");
    if (level != "info" && level != "none")
      std::cerr << "sandlot: " << level << ": " << status.value("msg", "") << "\n";
  };

  void send(const Json& message) {
    const std::string text = message.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    for (std::size_t sent = 0; sent < text.size();) {
      const ssize_t n = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (n < 0 && errno != EINTR) throw gone();
      if (n > 0) sent += static_cast<std::size_t>(n);
    }
  }
  std::string next_id() { return "cpp" + std::to_string(++ids_); }

  /// Takes what has come, waiting for it up to a time; negative: for ever. @return whether something came
  bool poll(double timeout_s = 0) {
    if (socket_ < 0) throw gone();
    pollfd watched{socket_, POLLIN, 0};
    const int timeout_ms = timeout_s < 0 ? -1 : static_cast<int>(std::ceil(std::min(timeout_s, 1e6) * 1e3));
    if (::poll(&watched, 1, timeout_ms) <= 0) return false;
    char bytes[1 << 16];
    const ssize_t n = ::recv(socket_, bytes, sizeof bytes, 0);
    if (n < 0 && errno == EINTR) return false;
    if (n <= 0) throw gone();
    // Only what is new is searched for the end of a line.
    std::size_t searched = rest_.size(), begin = 0;
    rest_.append(bytes, static_cast<std::size_t>(n));
    for (std::size_t end; (end = rest_.find('\n', searched)) != std::string::npos; begin = searched = end + 1)
      if (end > begin)
        take(Json::parse(rest_.begin() + static_cast<std::ptrdiff_t>(begin),
                         rest_.begin() + static_cast<std::ptrdiff_t>(end)));
    rest_.erase(0, begin);
    return true;
  }

  /// The answer to a request. @throws Refused, TimedOut
  Json wait(const std::string& id, double timeout_s) {
    const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
    while (answers_.count(id) == 0) {
      const double left_s = std::chrono::duration<double>(end - Clock::now()).count();
      if (left_s <= 0) throw TimedOut("no answer within " + std::to_string(timeout_s) + " s");
      poll(left_s);
    }
    Json answer = std::move(answers_.extract(id).mapped());
    if (answer.value("op", "") == "status") throw Refused(answer.value("msg", ""));
    return answer;
  }

  /// The latest message of a topic: "/rover/laser/ranges". It lives as long as the connection. @param handler  called with each
  Reading& subscribe_topic(const std::string& topic, Handler handler = {}, double throttle_ms = 0) {
    if (handler) handlers_[topic].push_back(std::move(handler));
    Reading& reading = readings_[topic];
    reading.topic = topic;
    send({{"op", "subscribe"},
          {"topic", topic},
          {"throttle_rate", throttle_ms},
          {"id", "subscribe:" + topic}});
    return reading;
  }
  void publish(const std::string& topic, const Json& message) {
    send({{"op", "publish"}, {"topic", topic}, {"msg", message}});
  }
  /// Calls a service. @throws Refused  with the server's reason
  Json call(const std::string& service, const Json& args = Json::object(), double timeout_s = 10) {
    const std::string id = next_id();
    send({{"op", "call_service"}, {"service", service}, {"args", args}, {"id", id}});
    Json answer = wait(id, timeout_s);
    const Json values = answer.value("values", Json());
    if (!answer.value("result", false))
      throw Refused(values.is_string() ? values.get<std::string>() : values.dump());
    return values;
  }
  /// Topics and their types.
  std::vector<std::pair<std::string, std::string>> topics() {
    const Json found = call("/rosapi/topics", Json::object(), timeout_s_);
    std::vector<std::pair<std::string, std::string>> out;
    for (std::size_t i = 0; i < found["topics"].size(); ++i)
      out.emplace_back(found["topics"][i].get<std::string>(), found["types"][i].get<std::string>());
    return out;
  }
  /// The latest hundred statuses.
  const std::deque<Json>& statuses() const { return statuses_; }

 protected:
  static std::string environment(const char* name, const char* otherwise) {
    const char* const value = std::getenv(name);
    return value && *value ? value : otherwise;
  }
  std::deque<Step> steps_;
  double timeout_s_;

 private:
  Disconnected gone() {
    close();
    return Disconnected("the server has closed the connection" +
                        (statuses_.empty() ? "" : ": " + statuses_.back().value("msg", "")));
  }

  void take(const Json& message) {
    const std::string op = message.value("op", ""), id = message.value("id", "");
    if (op == "publish") {
      const auto topic = message.at("topic").get<std::string>();
      const auto reading = readings_.find(topic);
      if (reading == readings_.end()) return;
      reading->second.message = message.at("msg");
      ++reading->second.count;
      if (const auto handlers = handlers_.find(topic); handlers != handlers_.end())
        for (const Handler& each : handlers->second) each(reading->second.message);
    } else if (op == "sandlot.tick") {
      const Json& time = message.at("time");
      steps_.push_back(
          {message.at("program").get<std::string>(), message.at("step").get<std::uint64_t>(),
           time.at("sec").get<std::int64_t>() * 1'000'000'000 + time.at("nanosec").get<std::int64_t>(),
           std::strtoull(message.value("random", "0").c_str(), nullptr, 10)});
    } else {
      if (op == "status") {
        statuses_.push_back(message);
        if (statuses_.size() > 100) statuses_.pop_front();
        if (id.empty()) return on_status(message);
      }
      if (!id.empty()) answers_[id] = message;
    }
  }

  /// Tries for a while: client and run may start in any order.
  void connect_to(const std::string& url) {
    const auto end = Clock::now() + std::chrono::duration<double>(timeout_s_);
    while (!try_to_connect(url)) {
      const bool not_yet = errno == ECONNREFUSED || errno == ENOENT || errno == EAGAIN;
      if (!not_yet || Clock::now() > end)
        throw Disconnected("nobody answers at " + url + ": " + std::strerror(errno));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  bool try_to_connect(const std::string& url) {
    if (url.rfind("unix:", 0) == 0) {
      sockaddr_un address{};
      address.sun_family = AF_UNIX;
      if (url.size() - 5 >= sizeof address.sun_path) throw Disconnected("the path is too long: " + url);
      std::memcpy(address.sun_path, url.data() + 5, url.size() - 5);
      return try_address(AF_UNIX, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
    const std::size_t colon = url.rfind(':');
    if (url.rfind("tcp://", 0) != 0 || colon < 6)
      throw Disconnected("'" + url + "' is not an address: tcp://HOST:PORT or unix:PATH");
    std::string host = url.substr(6, colon - 6), port = url.substr(colon + 1);
    while (!port.empty() && port.back() == '/') port.pop_back();
    if (host.size() > 1 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
    addrinfo hints{}, *found = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found))
      throw Disconnected("'" + url + "' cannot be found: " + ::gai_strerror(error));
    bool connected = false;
    for (const addrinfo* each = found; each && !connected; each = each->ai_next)
      connected = try_address(each->ai_family, each->ai_addr, each->ai_addrlen);
    ::freeaddrinfo(found);
    const int on = 1;
    if (connected) ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return connected;
  }
  bool try_address(int family, const sockaddr* address, socklen_t size) {
    socket_ = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket_ >= 0 && ::connect(socket_, address, size) == 0) return true;
    const int error = errno;
    close();
    errno = error;
    return false;
  }

  int socket_ = -1;
  std::string rest_;  ///< of a line that is not whole yet
  std::uint64_t ids_ = 0;
  std::map<std::string, Reading> readings_;
  std::map<std::string, std::vector<Handler>> handlers_;
  std::map<std::string, Json> answers_;
  std::deque<Json> statuses_;
};

/// What robots and teams have in common.
class Driver : public Connection {
 public:
  const std::string& name() const { return name_; }
  /// Control period of the program, once its lockstep has begun.
  std::optional<double> period_s() const { return period_s_; }

  /// Ends the step before, and waits for the next one. What was commanded since then acts with its end. None: the run has ended.
  /// Lockstep begins with the first call, so that the first step has the readings subscribed to before it.
  std::optional<Step> next_step() {
    if (!lockstep_) throw Refused("next_step() is for lockstep; spin() is for others");
    if (!period_s_) begin();
    try {
      if (open_) send({{"op", "sandlot.done"}, {"step", open_->number}, {"program", open_->program}});
      open_.reset();
      while (steps_.empty()) poll(-1);
    } catch (const Disconnected&) { return std::nullopt; }
    open_ = std::move(steps_.front());
    steps_.pop_front();
    return open_;
  }
  /// Takes messages for a while, by the wall clock.
  void spin(double seconds) {
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    for (double left_s = seconds; left_s > 0;
         left_s = std::chrono::duration<double>(end - Clock::now()).count())
      poll(left_s);
  }

 protected:
  Driver(const char* kind, std::string name, const Options& options)
      : Connection(options), name_(std::move(name)), lockstep_(options.lockstep) {
    claim_ = {{"op", "sandlot.claim"},
              {kind, name_},
              {"token", !options.token.empty() ? options.token : environment("SANDLOT_TOKEN", "")},
              {"mode", "free"}};
    claim();
    topics_ = topics();
    claim_["mode"] = "lockstep";
    claim_["deadline_ms"] = 1000 * options.deadline_s;
  }
  /// "laser" or "laser/ranges" of a robot as a topic.
  std::string topic_of(const std::string& wanted) const {
    std::string known;
    for (const auto& [topic, type] : topics_) {
      if (topic == wanted || topic.rfind(wanted + "/", 0) == 0) return topic;
      known += (known.empty() ? "" : ", ") + topic;
    }
    throw Refused("'" + wanted + "' publishes nothing; there are: " + known);
  }

 private:
  Json claim() {
    const std::string id = next_id();
    claim_["id"] = id;
    send(claim_);
    return wait(id, timeout_s_);
  }
  void begin() { period_s_ = claim().at("programs").at(0).at("control_period_s").get<double>(); }

  std::string name_;
  bool lockstep_;
  Json claim_;
  std::vector<std::pair<std::string, std::string>> topics_;
  std::optional<double> period_s_;
  std::optional<Step> open_;  ///< not ended yet
};

/// The client that drives a robot.
class Robot : public Driver {
 public:
  explicit Robot(std::string name, const Options& options = {}) : Driver("robot", std::move(name), options) {}
  /// The latest message of a device: "laser", or "laser/ranges" of one with several levels.
  Reading& subscribe(const std::string& device, Handler handler = {}) {
    return subscribe_topic(topic_of("/" + name() + "/" + device), std::move(handler));
  }
  /// A command for a device, at its active level or "drive/ideal".
  void command(const std::string& device, const Json& message) {
    publish("/" + name() + "/" + device, message);
  }
};

/// The client that drives all robots of a team.
class Team : public Driver {
 public:
  explicit Team(std::string name, const Options& options = {}) : Driver("team", std::move(name), options) {}
  Reading& subscribe(const std::string& robot, const std::string& device, Handler handler = {}) {
    return subscribe_topic(topic_of("/" + robot + "/" + device), std::move(handler));
  }
  void command(const std::string& robot, const std::string& device, const Json& message) {
    publish("/" + robot + "/" + device, message);
  }
};

}  // namespace sandlot::client
