#pragma once
/// The ros2msg text of a message type: what MCAP files and Foxglove clients call its schema.
///
/// Constants first, then one field per line; after it, behind lines of 80 '=', every type that it is made of, in the
/// order in which they first appear.
#include <string>

#include "messages/info.h"

namespace sandlot {

std::string schema_text(const MessageInfo& info);

}  // namespace sandlot
