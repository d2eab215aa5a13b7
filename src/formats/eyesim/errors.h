#pragma once
/// Error models of EyeSim (Koestler, Braunl: Mobile Robot Simulation with Realistic Error Models, sec. 5) as keys of devices.
///
///   error psd STD               normal error of the distance [mm]
///   error v STD, omega STD      normal error of the driving commands [mm/s], [deg/s]
///   error camera KIND P         gaussian (P is a deviation in grey levels, 0 to 255), salt_and_pepper or
///                               hundreds_and_thousands (P is the probability of a pixel)
///   error radio P_b P_p         probabilities of a wrong bit and of a lost packet
///
/// The words are ours: those of EyeSim are not handed down.
#include <optional>
#include <string>

#include "formats/eyesim/lines.h"
#include "model/model.h"

namespace sandlot::formats::eyesim {

struct ErrorModels {
  double psd_std_m = 0, v_std_mps = 0, omega_std_radps = 0;
  Node camera;  ///< list of stages, or null
  std::optional<double> bit_error_rate, drop;
  Place place;

  /// Takes a line `error ...`.
  Status take(const Line& line);
  /// What a device of this kind gets, as keys; null: nothing.
  Node keys_for(const std::string& device_kind) const;
  /// The same with a stage of strength 0 for each model without a line, so that the page has sliders for all of them.
  Node keys_to_tune(const std::string& device_kind, const Place& at) const;
};

}  // namespace sandlot::formats::eyesim
