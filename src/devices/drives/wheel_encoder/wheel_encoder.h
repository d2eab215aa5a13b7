#pragma once
/// Incremental encoder on a turning joint.
///
/// Output   level `ticks`: floor(angle * ticks_per_turn / 2 pi), counting on over turns and below zero, 0 in
///          the declared pose of the model. Level `joint`: the exact angle, speed and effort, without
///          quantisation. Both may be active at once.
/// Time     the end of the tick.
/// Noise    level `ticks`: noise/chain.h on the angle [rad], then counting. An angle that is not a number (a
///          drop-out) leaves the count as it was.
/// Limits   no index pulse, missed edges, counter width, or play between wheel and encoder.
/// Cost     one division per sample, no allocation.
/// Errors   a joint that is not there or does not turn.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/chain.h"

namespace sandlot::wheel_encoder {

struct Spec {
  std::string joint;
  int ticks_per_turn = 1024;
  double rate_hz = 50.0;
  ChainSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Name of the revolute or continuous joint.", 0, 0, Field::required, 1000},
          s.joint);
    visit(Field{"ticks_per_turn", "1", "Edges counted per turn of the joint.", 1, 1e8}, s.ticks_per_turn);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"noise", "rad", "Errors of the counted angle."}, s.noise);
    visit(errors_field, s.errors);
  }
};

struct Encoder {
  using Spec = wheel_encoder::Spec;
  using State = ChannelChain;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t joint = 0;
  Topic<msg::Int64Stamped>* ticks = nullptr;
  Topic<msg::JointState>* exact = nullptr;

  static Result<Encoder> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Encoder> pool, const Context& context);
};

/// Ticks shown at an angle: the number of edges passed since 0.
std::int64_t ticks_at(double angle_rad, int ticks_per_turn);

extern const Kind kind;

}  // namespace sandlot::wheel_encoder
