#include "base/check.h"
#include "server/services/service.h"

namespace sandlot::server {
namespace {

template <class S, void (*function)(const ServiceContext&, const typename S::Request&, const Reply<S>&)>
void call_typed(const ServiceContext& context, const AnyMessage& request, std::shared_ptr<ServiceCall> call) {
  SL_CHECK(&request.info() == &message_info<typename S::Request>());
  function(context, *static_cast<const typename S::Request*>(request.data()), Reply<S>(std::move(call)));
}

}  // namespace

std::span<const Service> services() {
  static const Service table[] = {
#define SL_SERVICE(type, name, right, function) \
  {name, find_service(type::ros_type).value(), Right::right, call_typed<type, service::function>},
#include "messages/services.def"
#undef SL_SERVICE
  };
  return table;
}

}  // namespace sandlot::server
