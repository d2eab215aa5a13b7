#include "selforg/store.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "base/atomic_file.h"

namespace sandlot::selforg {
namespace {

constexpr std::string_view magic = "SELFORG\n";
constexpr std::uint32_t version = 1;

}  // namespace

void write_controller(ByteWriter& w, const Controller& controller) {
  ByteWriter body;
  write(body, std::string(controller.kind()));
  write(body, static_cast<std::uint64_t>(controller.sensors()));
  write(body, static_cast<std::uint64_t>(controller.motors()));
  write(body, controller.fixed_key());
  controller.save(body);
  w.raw(magic.data(), magic.size());
  write(w, version);
  write(w, hash64(body.bytes()));
  w.raw(body.bytes().data(), body.size());
}

Status read_controller(std::span<const std::byte> bytes, Controller& controller, const std::string& from) {
  ByteReader r(bytes);
  const auto first = r.take(magic.size());
  if (!r.ok() || std::memcmp(first.data(), magic.data(), magic.size()) != 0)
    return Error{fmt::format("'{}' is not a stored controller", from), "files of `store` begin with SELFORG"};
  std::uint32_t found_version = 0;
  std::uint64_t sum = 0;
  read(r, found_version);
  if (r.ok() && found_version != version)
    return Error{
        fmt::format("'{}' has version {}; this program reads version {}", from, found_version, version),
        "store it again with this program"};
  read(r, sum);
  const auto damaged = [&] {
    return Error{fmt::format("'{}' is damaged or incomplete", from), "store it again"};
  };
  if (!r.ok() || hash64(bytes.last(r.remaining())) != sum) return damaged();
  std::string kind;
  std::uint64_t sensors = 0, motors = 0, key = 0;
  read(r, kind);
  read(r, sensors);
  read(r, motors);
  read(r, key);
  if (!r.ok()) return damaged();
  if (kind != controller.kind())
    return Error{fmt::format("'{}' holds a controller of kind '{}', not '{}'", from, kind, controller.kind()),
                 "load it into one of its kind"};
  if (sensors != controller.sensors() || motors != controller.motors())
    return Error{fmt::format("'{}' holds a controller of {} sensors and {} motors; this one has {} and {}",
                             from, sensors, motors, controller.sensors(), controller.motors()),
                 "load it into one of its size"};
  if (key != controller.fixed_key())
    return Error{fmt::format("'{}' was stored by a controller with other fixed parameters", from),
                 "make the controller with the parameters that it was stored with"};
  controller.load(r);
  if (!r.ok() || r.remaining() != 0) return damaged();
  return {};
}

Status store(const Controller& controller, const std::string& path) {
  ByteWriter w;
  write_controller(w, controller);
  return write_file(path, {reinterpret_cast<const char*>(w.bytes().data()), w.size()});
}

Status load(Controller& controller, const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{fmt::format("cannot read '{}'", path), "check the path"};
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return read_controller(std::as_bytes(std::span(text)), controller, path);
}

}  // namespace sandlot::selforg
