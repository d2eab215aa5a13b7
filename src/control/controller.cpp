#include "control/controller.h"

#include "base/text.h"

namespace sandlot {

Result<const Description::Entry*> Description::find(const std::vector<Entry>& entries,
                                                    std::string_view device, const char* type,
                                                    const char* what) const {
  const Entry* found = nullptr;
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    if (entry.type != type) continue;
    names.push_back(entry.device);
    const bool match = device.empty() || device == entry.device || device == entry.device + "/" + entry.level;
    if (match && found && found->device != entry.device)
      return Error{"robot '" + robot + "' has several " + what + "s of type " + type,
                   "name one of them: " + found->device + ", " + entry.device};
    if (match && !found) found = &entry;
  }
  if (found) return found;
  const std::string wanted = device.empty()
                                 ? std::string(what) + " of type " + type
                                 : std::string(what) + " '" + std::string(device) + "' of type " + type;
  return Error{"robot '" + robot + "' has no " + wanted,
               names.empty() ? std::string("add a device that offers one") : suggestion(device, names)};
}

}  // namespace sandlot
