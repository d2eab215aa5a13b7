#pragma once
/// Property message: a declared property of a robot or object as a message.
#include "messages/sandlot_acting.h"
#include "model/declarations.h"

namespace sandlot::acting {

inline void fill(msg::Property& message, const model::PropertyDecl& property) {
  message.name = property.name;
  message.value = property.value;
  message.unit = property.unit;
  message.min = property.min;
  message.max = property.max;
}

}  // namespace sandlot::acting
