#pragma once
/// Input recorder: the input from outside of each tick, written into the log that a rewound run repeats.
#include "sim/session/session.h"

namespace sandlot {

struct Session::InputRecorder final : Observer {
  explicit InputRecorder(InputLog& to) : input(to) {}
  InputLog& input;
  Wants wants() const override { return {.input = true, .instances = false}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
};

}  // namespace sandlot
