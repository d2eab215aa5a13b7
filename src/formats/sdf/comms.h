#pragma once
/// Gazebo's communication of a world: the plugins RFComms and PerfectComms as media of kind `radio`, CommsEndpoint of its
/// models as devices of kind `radio`.
///
///   PerfectComms  everything arrives at once, however far
///   RFComms       <range_config> and <radio_config>: log-distance loss, fading per packet, noise, QPSK
///
/// Limits   RFComms takes <sigma> for a variance, as Gazebo's code does, and cuts the fading off at three deviations. Its bit
///          error rate is that of QPSK by the textbook, where Gazebo's formula has twice the rate of BPSK and counts bytes; its
///          limit of bits per second and radio becomes time on the air. In a world without these plugins an endpoint is not
///          supported. Topics and brokers have no effect, with a warning for each.
/// Source   gz-sim, src/systems/rf_comms, src/systems/perfect_comms.
#include "formats/content.h"
#include "formats/sdf/reading.h"

namespace sandlot::formats {

/// Takes a plugin of a world, if it is one of these. @return whether it is
Result<bool> read_comms(const Xml& plugin, const Reading& in, WorldContent& out);

/// Makes the endpoints of all models devices of the world's medium, if there is one.
void connect_endpoints(WorldContent& content, const Reading& in);

}  // namespace sandlot::formats
