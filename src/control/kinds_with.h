#pragma once
/// Help for errors: which kinds of devices have messages of a type. The simulator knows its kinds and sets the function; the
/// drivers of a real robot have none, and errors then name the type only.
#include <string>
#include <string_view>

namespace sandlot {

/// Kinds with readings of a message type, or with actuators that take it: "a, b or c"; "" for none.
using KindsWith = std::string (*)(std::string_view message_type, bool actuators);

/// Sets the function for the whole process. Threads may call it at the same time.
void set_kinds_with(KindsWith function);

}  // namespace sandlot
