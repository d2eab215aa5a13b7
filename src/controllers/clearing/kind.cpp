#include "controllers/clearing/clearing.h"

namespace sandlot::controllers::clearing {

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Clearing>({
    .name = "clearing",
    .help = "Pushes scattered objects into an area, in agreement with team-mates by radio.",
});

}  // namespace sandlot::controllers::clearing
