#include <algorithm>
#include <limits>

#include "wire/scene.h"

namespace sandlot::wire {
namespace {

void append(std::vector<std::byte>& out, const auto& value) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}
void append_float(std::vector<std::byte>& out, double x) {
  constexpr double most = std::numeric_limits<float>::max();
  append(out, static_cast<float>(std::clamp(x, -most, most)));
}

}  // namespace

void write_contacts(const Frame& frame, std::vector<std::byte>& out) {
  out.clear();
  out.reserve(20 + 28 * frame.contacts.size());
  append(out, frame.tick);
  append(out, frame.now.ns);
  append(out, static_cast<std::uint32_t>(frame.contacts.size()));
  for (const Contact& contact : frame.contacts)
    for (const double x : {contact.point_W.x, contact.point_W.y, contact.point_W.z, contact.normal_W.x,
                           contact.normal_W.y, contact.normal_W.z, contact.depth_m})
      append_float(out, x);
}

}  // namespace sandlot::wire
