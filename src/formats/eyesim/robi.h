#pragma once
/// Robot types of EyeSim (.robi) and its objects (.esObj) as models.
///
/// Frames   .robi: lengths from the robot's own point, which lies at the height at which the wheels stand on the ground: psd
///          and camera with x forward, y left, z up; colliders and masses with x right, y up, z forward.
/// Devices  `drive`, `left_encoder`, `right_encoder`, one range_finder per psd by its name, `camera`, `lidar`.
/// Limits   psd: a single infra-red beam up to 9999 mm. fisheye: an equidistant lens.
#include <map>
#include <string>

#include "formats/content.h"

namespace sandlot::formats::eyesim {

struct Robi {
  model::Instance instance;
  std::map<int, std::string> psds;  ///< device by the number that programs know it by
};

Result<Robi> read_robi(std::string_view text, const std::string& file, const ReadOptions& options,
                       Diagnostics& diagnostics);
/// A robot on wheels as a .robi file; of what such files do not have one warning each says that it is left out.
/// Errors   no drive on two wheels, of a car or on Mecanum wheels.
Result<std::string> robi_of(const model::Instance& instance, Diagnostics& diagnostics);

/// Share of the mass that a .robi file names in that of the whole model, by drive: body, wheels, balls, forks.
namespace shares {
inline constexpr double differential = 0.99, ackermann = 1.02, omni = 1;
}

Result<model::Instance> read_object(std::string_view text, const std::string& file,
                                    const ReadOptions& options, Diagnostics& diagnostics);

}  // namespace sandlot::formats::eyesim
