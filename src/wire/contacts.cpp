#include "wire/append.h"
#include "wire/scene.h"

namespace sandlot::wire {

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
