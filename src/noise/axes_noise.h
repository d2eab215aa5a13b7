#pragma once
/// Errors of a vector measured by three channels, one per axis (a gyro, a force sensor):
/// noise/channel_noise.h for each.
///
/// Random   the axes draw from one stream, x before y before z: the order is part of the result.
#include <string>

#include "geometry/vec3.h"
#include "noise/channel_noise.h"

namespace sandlot {

struct AxesNoiseSpec {
  ChannelNoiseSpec x, y, z;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "", "Errors along or about x."}, s.x);
    visit(Field{"y", "", "Errors along or about y."}, s.y);
    visit(Field{"z", "", "Errors along or about z."}, s.z);
  }
};

struct AxesNoise {
  ChannelNoise x, y, z;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "", "Errors along or about x."}, s.x);
    visit(Field{"y", "", "Errors along or about y."}, s.y);
    visit(Field{"z", "", "Errors along or about z."}, s.z);
  }
  /// @param name  of the vector, so that several of one device draw apart
  void reset(const AxesNoiseSpec& s, Stream& random, const std::string& name) {
    x.reset(s.x, random, name + "/x");
    y.reset(s.y, random, name + "/y");
    z.reset(s.z, random, name + "/z");
  }
  /// Parameters as ChannelNoise::corrupt().
  Vec3 corrupt(const AxesNoiseSpec& s, Vec3 truth, double dt_s, Stream& random, double errors = 1) {
    const double corrupt_x = x.corrupt(s.x, truth.x, dt_s, random, errors);
    const double corrupt_y = y.corrupt(s.y, truth.y, dt_s, random, errors);
    const double corrupt_z = z.corrupt(s.z, truth.z, dt_s, random, errors);
    return {corrupt_x, corrupt_y, corrupt_z};
  }
};

}  // namespace sandlot
