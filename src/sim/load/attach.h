#pragma once
/// Robots composed of modules: a chassis, a scanner, a camera head, an arm; each a model of its own.
#include <string>

#include "model/model.h"

namespace sandlot {

/// Fixes `module` to link `link` of `robot` at X_LM: its links, joints, frames and lights become `id::name`, its devices
/// `id` where it has one, else `id_name`; names in its devices' keys go on meaning its own parts. Its model is not
/// changed: the robot gets a new one.
/// @pre link is one of the robot's
/// Errors   a joint of the module that holds on to the world; two devices of one name.
Status attach_module(model::Instance& robot, const model::Instance& module, const std::string& id,
                     std::uint32_t link, const Pose& X_LM);

}  // namespace sandlot
