#include "optics/embree.h"

#include <string>

#include "base/check.h"

namespace sandlot::embree {

RTCDevice device() {
  static const RTCDevice started = rtcNewDevice((std::string("isa=") + choose_isa()).c_str());
  SL_CHECK_MSG(started, "Embree refuses to start");
  return started;
}

}  // namespace sandlot::embree
