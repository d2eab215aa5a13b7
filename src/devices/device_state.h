#pragma once
/// State of a device as bytes: tunable fields, State, the factor on its errors, and what is late.
#include "base/bytes.h"

namespace sandlot {

template <class Spec, class Device>
void save_device(ByteWriter& w, const Spec& spec, const Device& device) {
  write_tunables(w, spec);
  write(w, device.state);
  bool late = false;
  if constexpr (requires { device.late; }) late = device.late.has_value();
  // Last and only where it is not 1: the bytes of a device without it are those of before it was. Likewise what is late.
  if constexpr (requires { spec.errors; })
    if (late || spec.errors != 1) write(w, spec.errors);
  if constexpr (requires { device.late; })
    if (late) write(w, *device.late);
}

/// @param r  ends where the device's bytes end
template <class Spec, class Device>
void load_device(ByteReader& r, Spec& spec, Device& device) {
  read_tunables(r, spec);
  read(r, device.state);
  if constexpr (requires { spec.errors; }) {
    if (spec.errors = 1; r.remaining() > 0) read(r, spec.errors);
    if (!(spec.errors >= 0 && spec.errors <= 1e6)) r.fail();
  }
  if constexpr (requires { device.late; })
    if (device.late.reset(); r.remaining() > 0) read(r, device.late.emplace());
}

}  // namespace sandlot
