#include <algorithm>
#include <tuple>

#include "wire/append.h"
#include "wire/scene.h"

namespace sandlot::wire {

void write_deliveries(std::vector<FrameDelivery>& deliveries, std::uint64_t tick, Time now,
                      std::vector<std::byte>& out) {
  const auto link = [](const FrameDelivery& each) {
    return std::tuple(each.sender, each.receiver, each.medium);
  };
  std::stable_sort(deliveries.begin(), deliveries.end(),
                   [&](const FrameDelivery& a, const FrameDelivery& b) { return link(a) < link(b); });
  std::vector<std::size_t> ends;  // of each link, behind its latest delivery
  for (std::size_t i = 1; i <= deliveries.size(); ++i)
    if (i == deliveries.size() || link(deliveries[i]) != link(deliveries[i - 1])) ends.push_back(i);
  // Of too many every n-th goes, so that no robot is always left out for its number.
  const std::size_t stride = (ends.size() + most_links - 1) / most_links;
  out.clear();
  append(out, tick);
  append(out, now.ns);
  append(out, static_cast<std::uint32_t>(stride == 0 ? 0 : (ends.size() + stride - 1) / stride));
  for (std::size_t i = 0; i < ends.size(); i += stride) {
    const FrameDelivery& latest = deliveries[ends[i] - 1];
    const std::size_t count = ends[i] - (i == 0 ? 0 : ends[i - 1]);
    append(out, static_cast<std::uint32_t>(latest.sender));
    append(out, static_cast<std::uint32_t>(latest.receiver));
    append(out, static_cast<std::uint16_t>(latest.medium));
    append(out, static_cast<std::uint16_t>(std::min<std::size_t>(count, 0xffff)));
    append(out, latest.channel);
    append_float(out, latest.strength);
  }
}

}  // namespace sandlot::wire
