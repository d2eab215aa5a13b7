#pragma once
/// Motion of an instance along a path: a pure function of time, so that nothing of it needs saving.
///
/// Between two keys the position runs straight and the orientation turns the short way about one axis, both evenly.
/// Limits   no smoothing: the velocity jumps at keys.
#include "model/model.h"

namespace sandlot::model {

/// @pre motion.keys is not empty
Pose pose_at(const Motion& motion, double time_s);

struct Moved {
  Pose X_WM;      ///< at the end
  Velocity V_WM;  ///< the mean over the interval that takes the pose from its start to its end
};
/// A path that begins anew elsewhere than it ended jumps there: at no velocity, so that it kicks nobody.
/// @pre to_s > from_s
Moved moved(const Motion& motion, double from_s, double to_s);

}  // namespace sandlot::model
