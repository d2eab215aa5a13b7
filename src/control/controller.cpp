#include "control/controller.h"

#include <algorithm>
#include <atomic>

#include "base/check.h"
#include "base/text.h"
#include "control/claims.h"
#include "control/kinds_with.h"

namespace sandlot {
namespace {

std::atomic<KindsWith> kinds_with = nullptr;
thread_local std::vector<std::uint32_t>*claims = nullptr, *reads = nullptr;

void note(std::vector<std::uint32_t>& list, std::uint32_t index) {
  const auto place = std::lower_bound(list.begin(), list.end(), index);
  if (place == list.end() || *place != index) list.insert(place, index);
}

}  // namespace

ClaimNotes::ClaimNotes(std::vector<std::uint32_t>& claimed, std::vector<std::uint32_t>& read) {
  SL_CHECK(claims == nullptr);
  claims = &claimed;
  reads = &read;
}
ClaimNotes::~ClaimNotes() { claims = reads = nullptr; }

void set_kinds_with(KindsWith function) { kinds_with = function; }

Result<const Description::Entry*> Description::find(const std::vector<Entry>& entries,
                                                    std::string_view device, const char* type,
                                                    const char* what) const {
  const Entry* found = nullptr;
  std::vector<std::string> names;
  const std::string* other_type = nullptr;  // of what has the name, but not the type
  // Without a name, devices precede topics of programs: an estimator that comes later changes nothing for those that read a
  // drive's own odometry.
  const bool has_device = std::any_of(entries.begin(), entries.end(), [&](const Entry& entry) {
    return entry.type == type && !entry.program;
  });
  for (const Entry& entry : entries) {
    if (entry.type != type) {
      if (device == entry.device && !other_type) other_type = &entry.type;
      continue;
    }
    // A device has one entry for each of its levels.
    if (names.empty() || names.back() != entry.device) names.push_back(entry.device);
    if (device.empty() && entry.program && has_device) continue;
    const bool match = device.empty() || device == entry.device || device == entry.device + "/" + entry.level;
    if (match && found && found->device != entry.device)
      return Error{"robot '" + robot + "' has several " + what + "s of type " + type,
                   "name one of them: " + found->device + ", " + entry.device};
    if (match && !found) found = &entry;
  }
  if (found) {
    if (claims) note(&entries == &actuators ? *claims : *reads, found->index);
    return found;
  }
  const std::string wanted = device.empty()
                                 ? std::string(what) + " of type " + type
                                 : std::string(what) + " '" + std::string(device) + "' of type " + type;
  if (other_type)
    return Error{"robot '" + robot + "' has no " + wanted,
                 "'" + std::string(device) + "' has " + *other_type};
  if (!names.empty()) return Error{"robot '" + robot + "' has no " + wanted, suggestion(device, names)};
  const KindsWith lookup = kinds_with;
  const std::string kinds = lookup ? lookup(type, &entries == &actuators) : "";
  return Error{"robot '" + robot + "' has no " + wanted,
               "add a device that offers one" + (kinds.empty() ? "" : ", of kind " + kinds)};
}

}  // namespace sandlot
