#pragma once
/// Files of controllers, wirings and agents: what was learned, to go on with bit for bit.
///
/// A file holds a version, kind and sizes, a key of the fixed parameters, the tunable parameters and State, and a check sum. It is
/// read into an object of the same kind, sizes and fixed parameters; anything else is an error and leaves the object as it was.
#include <string>

#include "selforg/controller.h"

namespace sandlot::selforg {

Status store(const Controller& controller, const std::string& path);
Status load(Controller& controller, const std::string& path);

/// The bytes of such a file.
void write_controller(ByteWriter& w, const Controller& controller);
/// @param from  name of the source, for messages
Status read_controller(std::span<const std::byte> bytes, Controller& controller, const std::string& from);

}  // namespace sandlot::selforg
