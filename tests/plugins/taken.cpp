/// Brings a controller whose name is ours.
#include "control/plugin.h"

namespace {
struct Nothing {
  using Spec = sandlot::NoFields;
  using State = sandlot::NoFields;
  Spec spec;
  State state;
  sandlot::Status init(const sandlot::Description&) { return {}; }
  void step(const sandlot::Observation&, sandlot::Command&) {}
};
constexpr sandlot::ControllerKind wander = sandlot::make_controller<Nothing>(
    {.name = "wander", .help = "Nothing."});
}  // namespace

SANDLOT_PLUGIN("test_taken", &wander)
