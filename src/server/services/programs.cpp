/// Services about the programs that the server has started.
#include "server/services/service.h"

namespace sandlot::server::service {

void restart_program(const ServiceContext& context, const msg::RestartProgram::Request& request,
                     const Reply<msg::RestartProgram>& reply) {
  const Status status = context.host.restart_program(request.program);
  reply({static_cast<bool>(status), status ? "" : status.error().text()});
}

}  // namespace sandlot::server::service
