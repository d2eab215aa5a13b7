#pragma once
/// Files of controllers, wirings and agents: what was learned, to go on with bit for bit.
///
/// A file holds a version, kind and sizes, a key of the fixed parameters, the tunable parameters and State, and a check sum. It is
/// read into an object of the same kind, sizes and fixed parameters; anything else is an error and leaves the object as it was.
///
/// Limits   64 MiB per file.
#include <string>

#include "selforg/controller.h"

namespace sandlot::selforg {

Status store(const Controller& controller, const std::string& path);
Status load(Controller& controller, const std::string& path);

/// The bytes of such a file.
void write_controller(ByteWriter& w, const Controller& controller);
/// @param from  name of the source, for messages
Status read_controller(std::span<const std::byte> bytes, Controller& controller, const std::string& from);

// What files of controllers and of agents share.

inline constexpr std::size_t most_stored_bytes = std::size_t{64} << 20;

struct StoredForm {
  std::string_view magic;
  std::uint32_t version;
  const char* name;  ///< "agent"
};
/// Magic, version and check sum around a body.
void write_stored(ByteWriter& w, const StoredForm& form, std::span<const std::byte> body);
/// The body. Errors: another form, another version, bytes that are missing or changed.
Result<std::span<const std::byte>> stored_body(std::span<const std::byte> bytes, const StoredForm& form,
                                               const std::string& from);
Error damaged_file(const std::string& from);
/// The bytes of a file of at most most_stored_bytes.
Result<std::string> read_stored_file(const std::string& path);

/// Loads `thing` from all that is left in `r`. @return false: that does not fit it, and it is as it was before
template <class T>
bool load_whole(ByteReader& r, T& thing) {
  ByteWriter before;
  thing.save(before);
  thing.load(r);
  if (r.ok() && r.remaining() == 0) return true;
  ByteReader back(before.bytes());
  thing.load(back);
  SL_CHECK(back.ok());
  return false;
}

}  // namespace sandlot::selforg
