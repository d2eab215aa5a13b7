#pragma once
/// Claims: what a client that drives robots asks for, and what the hub holds of it meanwhile.
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/http/access.h"

namespace sandlot::programs::remote {
class Link;
}

namespace sandlot::server {

struct ClaimRequest {
  std::string robot, team;  ///< one of them
  std::string token;
  bool lockstep = false;
  double deadline_s = 1;
  std::string name;  ///< that the client gives itself
};
/// A remote program that a client in lockstep answers for.
struct ClaimedProgram {
  std::string path;
  double control_period_s = 0;
};
struct ProgramLink {
  ClaimedProgram program;
  std::shared_ptr<programs::remote::Link> link;
  double longest_deadline_s = 0;
};
/// Of a client that drives robots.
struct Claim {
  std::uint64_t number = 0;  ///< of all claims
  ClaimRequest request;
  Access before;  ///< what it may do when the claim ends
  std::vector<ProgramLink> links;
  std::map<std::string, std::string>
      orders;  ///< by program: what was published since its step, as JSON pairs
  std::chrono::steady_clock::time_point commanded;
  bool moving = false;  ///< it has commanded something since it was stopped
};

}  // namespace sandlot::server
