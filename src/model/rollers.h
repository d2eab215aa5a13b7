#pragma once
/// Wheels with rollers: from the declaration of a wheel to links and joints of its rollers.
#include "base/result.h"
#include "model/model.h"

namespace sandlot::model {

/// Adds a link and a continuous joint for each roller of every joint that has `rollers`, named after the wheel's link
/// ("wheel_roller_3" with its "wheel_roller_3_axle", row by row); a model whose rollers were added already stays as it is.
///
/// Each roller is a Barrel that keeps to the wheel's rim as the wheel turns: exactly for omni wheels, to fourth order for
/// others (within 0.3 % of the radius for usual Mecanum wheels). Rollers of a row may reach into each other's ends near
/// the hub, as real ones with hollow ends do, so that the rim can be without gaps; on the rim they may not overlap.
///
/// The mass and inertia of the wheel link are those of the wheel without rollers, and its collision shapes those of the
/// hub: none may reach beyond the rollers.
/// Errors: a wheel that cannot be built (count < 2, rollers that overlap or do not fit the radius, an angle at which
/// it could not roll), with the joint's place.
Status add_rollers(Model& model);

/// Whether the numbers of a wheel are such that one can compute with it. That of a forged model may have any.
bool is_wheel(const RollerWheel& wheel);

}  // namespace sandlot::model
