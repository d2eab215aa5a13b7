#include "selforg/store.h"

#include <fmt/format.h>

#include <fstream>

#include "base/atomic_file.h"

namespace sandlot::selforg {
namespace {

constexpr StoredForm controller_form{"SELFORG\n", 1, "controller"};

}  // namespace

void write_stored(ByteWriter& w, const StoredForm& form, std::span<const std::byte> body) {
  w.raw(form.magic.data(), form.magic.size());
  write(w, form.version);
  write(w, hash64(body));
  w.raw(body.data(), body.size());
}

Error damaged_file(const std::string& from) {
  return {fmt::format("'{}' is damaged or incomplete", from), "store it again"};
}

Result<std::span<const std::byte>> stored_body(std::span<const std::byte> bytes, const StoredForm& form,
                                               const std::string& from) {
  ByteReader r(bytes);
  const auto first = r.take(form.magic.size());
  if (!r.ok() || std::memcmp(first.data(), form.magic.data(), form.magic.size()) != 0)
    return Error{fmt::format("'{}' is not a stored {}", from, form.name),
                 fmt::format("files of a stored {} begin with {}", form.name, form.magic.substr(0, 7))};
  std::uint32_t version = 0;
  std::uint64_t sum = 0;
  read(r, version);
  if (r.ok() && version != form.version)
    return Error{
        fmt::format("'{}' has version {}; this program reads version {}", from, version, form.version),
        "store it again with this program"};
  read(r, sum);
  if (!r.ok()) return damaged_file(from);
  const auto body = bytes.last(r.remaining());
  if (hash64(body) != sum) return damaged_file(from);
  return body;
}

Result<std::string> read_stored_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{fmt::format("cannot read '{}'", path), "check the path"};
  std::string text;
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > most_stored_bytes)
      return Error{fmt::format("'{}' has more than 64 MiB", path), "no stored controller is as large"};
  }
  return text;
}

void write_controller(ByteWriter& w, const Controller& controller) {
  ByteWriter body;
  write(body, std::string(controller.kind()));
  write(body, static_cast<std::uint64_t>(controller.sensors()));
  write(body, static_cast<std::uint64_t>(controller.motors()));
  write(body, controller.fixed_key());
  controller.save(body);
  write_stored(w, controller_form, body.bytes());
}

Status read_controller(std::span<const std::byte> bytes, Controller& controller, const std::string& from) {
  SL_ASSIGN(const auto body, stored_body(bytes, controller_form, from));
  ByteReader r(body);
  std::string kind;
  std::uint64_t sensors = 0, motors = 0, key = 0;
  read(r, kind);
  read(r, sensors);
  read(r, motors);
  read(r, key);
  if (!r.ok()) return damaged_file(from);
  if (kind != controller.kind())
    return Error{fmt::format("'{}' holds a controller of kind '{}', not '{}'", from, kind.substr(0, 60),
                             controller.kind()),
                 "load it into one of its kind"};
  if (sensors != controller.sensors() || motors != controller.motors())
    return Error{fmt::format("'{}' holds a controller of {} sensors and {} motors; this one has {} and {}",
                             from, sensors, motors, controller.sensors(), controller.motors()),
                 "load it into one of its size"};
  if (key != controller.fixed_key())
    return Error{fmt::format("'{}' was stored by a controller with other fixed parameters", from),
                 "make the controller with the parameters that it was stored with"};
  if (!load_whole(r, controller)) return damaged_file(from);
  return {};
}

Status store(const Controller& controller, const std::string& path) {
  ByteWriter w;
  write_controller(w, controller);
  return write_file(path, {reinterpret_cast<const char*>(w.bytes().data()), w.size()});
}

Status load(Controller& controller, const std::string& path) {
  SL_ASSIGN(const std::string text, read_stored_file(path));
  return read_controller(std::as_bytes(std::span(text)), controller, path);
}

}  // namespace sandlot::selforg
