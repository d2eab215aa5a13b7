/// Commands about what people press on a robot.
#include <fmt/format.h>

#include <charconv>

#include "base/text.h"
#include "console/command.h"
#include "messages/command.h"
#include "messages/messages.h"

namespace sandlot::console {
namespace {

struct KeysFound {
  const TopicBase* slot = nullptr;
  std::string device;
};

/// The first device of the robot that takes presses, or the one that is named.
Result<KeysFound> find_keys(CommandCall& call, std::string_view name) {
  if (!name.empty() && name.front() == '/') name.remove_prefix(1);
  const std::string robot(name.substr(0, name.find('/')));
  const auto entity = find_thing(call, robot);
  if (!entity) {
    call.unknown_thing = true;
    return entity.error();
  }
  for (const auto& device : (*entity)->devices) {
    if (name != robot && device->path != name) continue;
    for (const Simulation::Slot& slot : device->commands)
      if (std::string_view(slot.topic->type()) == msg::KeyPress::ros_type)
        return KeysFound{slot.topic.get(), device->path};
  }
  return Error{std::string(name.substr(0, 100)) + " has no keys to press",
               "give the robot a device of the kind 'keys'"};
}

template <class Number>
bool read_whole(const std::string& text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && last == end;
}

}  // namespace

CommandResult cmd_press(CommandCall& call) {
  msg::KeyPress press;
  const bool touches = call.words[1] == "touch";
  const bool is_read = touches
                           ? call.words.size() == 4 && read_whole(call.words[2], press.x) &&
                                 read_whole(call.words[3], press.y)
                           : call.words.size() == 2 && read_whole(call.words[1], press.key) && press.key > 0;
  if (!is_read)
    return Error{"press takes the number of a key or a place", "press ROBOT 1, or press ROBOT touch 20 30"};
  SL_ASSIGN(const KeysFound keys, find_keys(call, call.words[0]));
  SL_ASSIGN(std::vector<std::byte> bytes,
            command_from_json(
                *keys.slot, fmt::format(R"({{"key": {}, "x": {}, "y": {}}})", press.key, press.x, press.y)));
  const std::string what = touches ? fmt::format("a touch at {} {}", press.x, press.y)
                                   : fmt::format("key {}", press.key);
  CommandRequest request{keys.device, keys.slot->type(), std::move(bytes)};
  return submit(call, {{std::move(request), keys.device + " got " + what}});
}

}  // namespace sandlot::console
