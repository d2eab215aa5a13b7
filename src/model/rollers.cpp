#include "model/rollers.h"

namespace sandlot::model {

Status add_rollers(Model&) { return {}; }

}  // namespace sandlot::model
