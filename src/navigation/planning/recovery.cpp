#include "navigation/planning/recovery.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sandlot::navigation {
namespace {

constexpr std::array<EnumName<RecoveryStage>, 6> recovery_stages{{{"watching", RecoveryStage::watching},
                                                                  {"clearing", RecoveryStage::clearing},
                                                                  {"waiting", RecoveryStage::waiting},
                                                                  {"backing", RecoveryStage::backing},
                                                                  {"turning", RecoveryStage::turning},
                                                                  {"given_up", RecoveryStage::given_up}}};

void recovery_enter(RecoveryState& state, RecoveryStage stage) {
  state.stage = stage;
  state.stage_s = 0;
  state.done = 0;
}

void recovery_progress(RecoveryState& state, const Pose2& X) {
  state.seen = true;
  state.idle_s = 0;
  state.x_m = X.x;
  state.y_m = X.y;
  state.theta_rad = X.theta;
}

}  // namespace

std::span<const EnumName<RecoveryStage>> enum_names(RecoveryStage) { return recovery_stages; }

RecoveryStep recover(const RecoverySpec& spec, RecoveryState& state, const CostMap& map,
                     const Footprint& footprint, const Pose2& X, bool failed, double dt_s,
                     const std::function<bool(const Pose2&)>& known) {
  RecoveryStep out;
  const bool finite = is_finite(X);
  state.stage_s += dt_s;
  if (state.stage == RecoveryStage::watching) {
    state.idle_s += dt_s;
    const bool moved_on = finite &&
                          (!state.seen || math::hypot(X.x - state.x_m, X.y - state.y_m) >= spec.progress_m ||
                           std::abs(math::wrap_angle(X.theta - state.theta_rad)) >= spec.progress_rad);
    if (moved_on) {
      // Driving on after a round ends the count; the motions of the round itself were taken as its new place.
      if (state.seen && !failed) state.round = 0;
      recovery_progress(state, X);
    }
    if (failed || state.idle_s >= spec.stuck_time_s) {
      if (state.round >= spec.rounds) {
        recovery_enter(state, RecoveryStage::given_up);
      } else {
        ++state.round;
        recovery_enter(state, RecoveryStage::clearing);
        out.clear_map = true;
        out.stage = state.stage;
        return out;
      }
    }
  }
  if (state.stage == RecoveryStage::clearing) recovery_enter(state, RecoveryStage::waiting);
  if (state.stage == RecoveryStage::waiting && state.stage_s >= spec.wait_s)
    recovery_enter(state, RecoveryStage::backing);

  // A motion goes on while its next part, with what the robot needs to stop, is free.
  const GridFrame frame(map.geometry);
  const auto free = [&](const PlanarTwist& twist) {
    if (!finite) return false;
    for (const double ahead : {dt_s, dt_s + 0.25, dt_s + 0.5}) {
      const Pose2 there = driven(X, twist, ahead);
      if (footprint_contact(map, frame, footprint, there) != Contact::none || (known && !known(there)))
        return false;
    }
    return true;
  };
  if (state.stage == RecoveryStage::backing) {
    const PlanarTwist back{-spec.back_up_mps, 0, 0};
    if (state.done < spec.back_up_m && free(back)) {
      state.done += spec.back_up_mps * dt_s;
      out.command = back;
    } else {
      recovery_enter(state, RecoveryStage::turning);
    }
  }
  if (state.stage == RecoveryStage::turning) {
    // The other way round each time, so that a corner does not hold it twice.
    const PlanarTwist turn{0, 0, state.round % 2 ? spec.turn_radps : -spec.turn_radps};
    if (state.done < spec.turn_rad && free(turn)) {
      state.done += spec.turn_radps * dt_s;
      out.command = turn;
    } else {
      recovery_enter(state, RecoveryStage::watching);
      if (finite) recovery_progress(state, X);
      state.idle_s = 0;
      out.plan_again = true;
    }
  }
  out.stage = state.stage;
  return out;
}

}  // namespace sandlot::navigation
