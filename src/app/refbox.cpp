#include "app/refbox.h"

#include <cstdio>

#include "base/text.h"
#include "server/http/http.h"
#include "server/refbox/refbox.h"

namespace sandlot::app {

Result<RefboxPlace> read_refbox_place(const std::string& text) {
  RefboxPlace out{.address = server::RefboxOptions().address, .port = 0};
  std::string port = text;
  if (text.find(':') != std::string::npos) {
    const auto place = server::read_host(text);
    if (!place || place->port < 0)
      return Error{"--refbox: '" + text + "' is not an address with a port", "such as 127.0.0.1:28097"};
    out.address = place->host;
    port = std::to_string(place->port);
  }
  double number = 0;
  if (!parse_number(port, number) || !(number >= 0 && number <= 65535) ||
      number != static_cast<double>(static_cast<int>(number)))
    return Error{"--refbox: '" + text + "' is not a port", "such as 28097 or 127.0.0.1:28097"};
  out.port = static_cast<std::uint16_t>(number);
  return out;
}

ServedRefbox::ServedRefbox(std::unique_ptr<server::Refbox> refbox) : refbox_(std::move(refbox)) {}
ServedRefbox::ServedRefbox(ServedRefbox&&) noexcept = default;
ServedRefbox& ServedRefbox::operator=(ServedRefbox&&) noexcept = default;
ServedRefbox::~ServedRefbox() = default;

Result<ServedRefbox> ServedRefbox::start(const RefboxFlags& flags, Session& session) {
  SL_ASSIGN(const RefboxPlace place, read_refbox_place(flags.at));
  server::RefboxOptions options{.address = place.address, .port = place.port};
  SL_ASSIGN(options.teams, server::read_refbox_teams(flags.teams, flags.protocols));
  SL_ASSIGN(auto refbox, server::Refbox::start(options, session));
  std::fprintf(stderr, "referee box: %s\n", refbox->address().c_str());
  return ServedRefbox(std::move(refbox));
}

RefboxSummary ServedRefbox::stop() {
  refbox_->stop();
  RefboxSummary out{.address = refbox_->address(), .refused = refbox_->refused()};
  for (const server::RefboxReport& each : refbox_->teams())
    out.teams.push_back({.team = name_of(each.side),
                         .protocol = name_of(each.protocol),
                         .connections = each.connections,
                         .words = each.words,
                         .world_states = each.world_states,
                         .wrong = each.wrong,
                         .dropped = each.dropped});
  return out;
}

}  // namespace sandlot::app
