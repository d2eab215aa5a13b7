/// Drives the rover of @NAME@.yaml: forward while the way is free, else it turns to the side with more room.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <vector>

#include "sandlot_client/client.h"

/// A command for the drive by a laser scan: 271 ranges from -135 to 135 degrees. null: nothing within reach.
nlohmann::json decide(const nlohmann::json& scan) {
  std::vector<double> ranges;
  for (const auto& range : scan["ranges"])
    ranges.push_back(range.is_null() ? scan["range_max"].get<double>() : range.get<double>());
  const auto least = [&](int from, int to) {
    return *std::min_element(ranges.begin() + from, ranges.begin() + to);
  };
  const double right = least(45, 115), ahead = least(115, 156), left = least(156, 226);
  if (ahead > 0.6) return {{"linear", {{"x", 0.4}}}};
  return {{"angular", {{"z", left > right ? 1.0 : -1.0}}}};
}

int main() try {
  sandlot::client::Robot rover("rover", {.lockstep = true, .deadline_s = 5});
  auto& laser = rover.subscribe("laser");
  while (const auto step = rover.next_step())
    if (laser.fresh()) rover.command("drive", decide(laser.message));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
