#include "selforg/controller.h"

#include <fmt/format.h>

#include "base/text.h"
#include "selforg/kinds.h"

namespace sandlot::selforg {

std::string channel_name(const Channel& channel, std::size_t element) {
  if (channel.cols > 1)
    return fmt::format("{}[{},{}]", channel.name, element % channel.rows, element / channel.rows);
  if (channel.rows > 1 || channel.values.size() != 1) return fmt::format("{}[{}]", channel.name, element);
  return std::string(channel.name);
}

void Controller::step(std::span<const double> x, std::span<double> y, Mode mode) {
  SL_CHECK_MSG(x.size() == sensors() && y.size() == motors(), "sizes given to init()");
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i])) input_.x[i] = clipped(x[i], 1000);
    else ++input_.bad;
  }
  if (mode == Mode::babble)
    for (std::size_t i = 0; i < y.size(); ++i) output_[i] = clipped(y[i], 1);
  step_element(input_.x, output_, mode);
  if (mode != Mode::babble) std::copy(output_.data.begin(), output_.data.end(), y.begin());
}

Status Controller::set(std::string_view parameter, double number) {
  return set_parameter(parameter, Node::scalar(number_text(number)));
}

Status Controller::set(std::string_view parameter, const char* text) {
  return set_parameter(parameter, Node::scalar(text));
}

Result<double> Controller::get(std::string_view parameter) const {
  SL_ASSIGN(const ValuePath path, parse_value_path(parameter));
  const ValueFound found = value(ValuePart::parameter, path);
  if (found.is == ValueFound::Is::value) return found.value;
  return Error{fmt::format("'{}' has no number '{}'", kind(), parameter), "describe() lists the parameters"};
}

Result<std::unique_ptr<Controller>> make_controller(std::string_view kind, const Setup& setup,
                                                    const Node& parameters) {
  std::vector<std::string> names;
  for (const ControllerKind& each : controller_kinds()) {
    if (each.name == kind) {
      auto made = each.create();
      SL_TRY(made->init(parameters, setup));
      return made;
    }
    names.emplace_back(each.name);
  }
  return Error{fmt::format("no controller kind '{}'", kind), suggestion(kind, names)};
}

}  // namespace sandlot::selforg
