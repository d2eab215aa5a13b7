#pragma once
/// Teams of a referee box: which base station is which team's, by the address that it comes from.
///
///   cyan=172.16.39.*, magenta=172.16.74.*     as in the league: the team's network
///   cyan=127.0.0.2@224.16.32.39               by one address, with the name that JSON gives the team
///   (nothing)                                 who comes first is cyan, who comes second magenta
///
/// Errors    a sentence that begins with the option.
#include <array>
#include <string>
#include <string_view>

#include "base/result.h"
#include "wire/refbox.h"

namespace sandlot::server {

struct RefboxTeam {
  refbox::Side side = refbox::Side::cyan;
  std::string pattern = "*";  ///< address, of which the last parts may be `*`; "*": any
  refbox::Protocol protocol = refbox::Protocol::json;
};

struct RefboxTeams {
  std::array<RefboxTeam, 2> all{RefboxTeam{.side = refbox::Side::cyan},
                                RefboxTeam{.side = refbox::Side::magenta}};
  refbox::TeamIds ids;
};

/// @param teams      text of --refbox-teams; "": none
/// @param protocols  text of --refbox-protocol: "json", "2009", "cyan=2009,magenta=json"; "": json
Result<RefboxTeams> read_refbox_teams(std::string_view teams, std::string_view protocols);

/// Whether an address, such as 172.16.39.5, is one of a pattern, such as 172.16.39.*.
bool address_matches(std::string_view address, std::string_view pattern);

}  // namespace sandlot::server
