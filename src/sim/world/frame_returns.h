#pragma once
/// The way back of frames from an observer's thread to the simulation's, which fills a frame again when it was the last to let
/// go of it: freed elsewhere, its memory would be allocated anew in every tick.
///
/// Threads   give_back(): any; release(): the simulation's.
/// Cost      a lock each; no allocation once as many frames have been under way as ever are.
#include <memory>
#include <mutex>
#include <vector>

#include "sim/world/frame.h"

namespace sandlot {

class FrameReturns {
 public:
  void give_back(std::shared_ptr<const Frame> frame) {
    const std::lock_guard lock(mutex_);
    given_back_.push_back(std::move(frame));
  }
  /// Lets go of the frames that were given back.
  void release() {
    {
      const std::lock_guard lock(mutex_);
      released_.swap(given_back_);
    }
    released_.clear();
  }

 private:
  std::mutex mutex_;
  std::vector<std::shared_ptr<const Frame>> given_back_;
  std::vector<std::shared_ptr<const Frame>> released_;  ///< of the simulation's thread
};

/// Approximate memory of a frame's poses.
inline std::size_t pose_bytes(const Frame& frame) {
  std::size_t sum = 0;
  for (const FrameInstance& instance : frame.instances)
    sum += sizeof instance + instance.X_WL.size() * sizeof(Pose);
  return sum;
}

}  // namespace sandlot
