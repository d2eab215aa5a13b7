// The clearing law that comes with Sandlot, outside its tree: the same text, in a shared library of its own.
#include "clearing.h"

namespace {
using namespace sandlot;
using my_clearing::Clearing;

constexpr ControllerKind kind = make_controller<Clearing>(
    {.name = "my_clearing", .help = "Pushes scattered objects into an area, from a plugin."});
}  // namespace

SANDLOT_PLUGIN("clearing_plugin", &kind)
