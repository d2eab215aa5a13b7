#pragma once
/// Context of the devices' phase functions in a tick: what they read and write.
#include <span>
#include <string_view>
#include <vector>

#include "base/time.h"
#include "devices/labelled_object.h"
#include "geometry/rays.h"
#include "media/emission.h"
#include "physics/engine.h"

namespace sandlot::optics {
class PictureScene;  // optics/picture.h
}

namespace sandlot {

class TopicBase;     // messages/topic.h
class EnergyLedger;  // devices/energy.h

/// Topics of other devices, for devices that work with another one, such as a pan-tilt unit with its camera. What one
/// device orders of another is declared when it is built: DeviceBuild::order.
class TopicFinder {
 public:
  /// "/robot1/camera/objects"; null when there is none. Valid within the phase.
  virtual const TopicBase* find_topic(std::string_view name) const = 0;

 protected:
  ~TopicFinder() = default;
};

/// Requests of actuators to the engine in this sub-step; filled in pool order, capacity reused.
struct Actuation {
  std::vector<Wrench> wrenches;
  std::vector<JointTarget> joints;
  std::vector<DriveTarget> drives;
  std::vector<RollTarget> rolls;
  std::vector<WheelTarget> wheels;
  std::vector<GripTarget> grips;
  Watch watch;  ///< forces of this sub-step that somebody wants to see after it
  void clear() {
    watch.clear(), rolls.clear(), wheels.clear(), grips.clear();
    wrenches.clear();
    joints.clear();
    drives.clear();
  }
};

/// Interface of a kind's phase functions to the simulation.
struct Context {
  Time now;   ///< end of the tick that is being computed
  Time tick;  ///< its length
  std::uint64_t tick_index = 0;
  std::uint64_t seed = 0;
  const Engine& engine;
  const RayCaster& rays;
  Actuation& actuation;
  EmissionBuffer& emissions;
  // For kinds that see (Kind::sees), in the sense phase; nothing for the others.
  optics::PictureScene* pictures = nullptr;               ///< draws the visuals as they are at `now`
  std::span<const LabelledObject> labelled_objects = {};  ///< for detectors
  const TopicFinder* topics = nullptr;                    ///< null in tests of single kinds alone
  const EnergyLedger* energy = nullptr;  ///< batteries of the world, for chargers; null likewise
};

}  // namespace sandlot
