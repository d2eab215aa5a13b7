#pragma once
/// `sandlot calibrate`: errors of a detector in a camera's pictures, as parameters of the camera's level
/// `objects`.
///
/// Truth    objects of the camera without errors, from the same samples as the pictures.
/// Detector `picture`: perception/finder.h, which knows the colours and sizes of the objects as their models
///          declare them. `objects`: the level `objects` as the scenario sets it, in a second world with the
///          same motion: a check of the method.
/// Samples  the robot stands; before each picture it is turned at random and the things that are looked for
///          are put anywhere in view, none into another. With `as_it_runs` the scenario runs with its
///          controllers instead.
#include <functional>
#include <map>
#include <string>

#include "app/commands.h"
#include "app/detector_fit.h"

namespace sandlot::app {

struct CalibrateOptions {
  std::string file, camera;
  std::vector<std::string> labels;  ///< none: all
  int samples = 300;
  double max_range_m = 6;
  std::string detector = "picture";
  bool as_it_runs = false;
  std::optional<std::uint64_t> seed;
  std::vector<formats::Override> overrides;
  std::vector<std::string> paths;
  std::string out;
  std::string pictures;  ///< folder for the first few pictures with what was found in them; "": none
  bool json = false;
};

struct Calibration {
  DetectorFit fit;
  int pictures = 0, sighted = 0, found = 0, confused = 0, ghosts = 0;  ///< found: those confused, too
  double seconds = 0;
  struct Label {
    int sighted = 0, found = 0, confused = 0, ghosts = 0;
    double bearing_squares = 0, range_squares = 0;  ///< [rad^2, m^2] sums over those found and not confused
  };
  std::map<std::string, Label> labels;
  bool interrupted = false;
};

/// @param progress  called after each picture with the part that is done; false stops
Result<Calibration> calibrate_camera(const CalibrateOptions& options, Diagnostics& diagnostics,
                                     const std::function<bool(double)>& progress = {});
/// Calibration as keys of a scenario.
std::string calibration_yaml(const CalibrateOptions& options, const Calibration& calibration);
int calibrate(const CalibrateOptions& options);

}  // namespace sandlot::app
