/// Scenarios as .sim files.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/math.h"
#include "base/text.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/sim.h"

namespace sandlot::formats::eyesim {
namespace {

namespace fs = std::filesystem;

std::string sim_decimal(double value) {
  const double rounded = std::floor(value * 1e6 + 0.5) / 1e6;
  return number_text(rounded == 0 ? 0 : rounded);
}
std::string in_quotes(const std::string& text) {
  return text.empty() || text.find_first_of(" \t#;") != std::string::npos ? '"' + text + '"' : text;
}
std::string extension_of(const std::string& file) { return lower(fs::path(file).extension().string()); }

class SimWriter {
 public:
  SimWriter(const Scenario& scenario, Diagnostics& diagnostics)
      : scenario_(scenario), diagnostics_(diagnostics) {}

  Result<std::string> write() {
    std::string out;
    const std::string world = extension_of(scenario_.world);
    if (world == ".wld" || world == ".maz" || world == ".maze")
      out += "world " + in_quotes(scenario_.world) + "\n";
    else if (!scenario_.world.empty())
      return Error{"a .sim file has a world of EyeSim, not '" + scenario_.world + "'",
                   "convert the world to .wld first and name that", scenario_.world_place};
    const double step_ms = scenario_.setup.step.s() * 1e3;
    if (std::abs(step_ms - 50) > 1e-9) out += "step " + sim_decimal(step_ms) + "\n";
    for (const RobotGroup& group : scenario_.things) add(group, false);
    for (const RobotGroup& group : scenario_.robots) add(group, true);
    out += types_ + lines_;
    for (const model::ElementDecl& marker : scenario_.setup.markers) out += marker_line(marker);
    if (scenario_.setup.rules.empty() == false) leave_out("'rules'", scenario_.setup.rules.front().place);
    return out;
  }

 private:
  void leave_out(const std::string& what, const Place& place) const {
    diagnostics_.warn({what + " is left out: a .sim file has no line for it", "", place});
  }

  void add(const RobotGroup& group, bool robot) {
    if (group.placement.kind != Placement::Kind::pose || group.count != 1)
      return leave_out("the group '" + group.name + "'", group.instance.place);
    if (group.model.empty()) return leave_out("'" + group.name + "' of a builder", group.instance.place);
    std::string type = built_in_type(group.model, robot);
    if (type.empty()) {
      const std::string extension = extension_of(group.model);
      if (extension != (robot ? ".robi" : ".esobj")) {
        diagnostics_.warn(
            {"'" + group.name + "' is left out: its model is '" + group.model + "'",
             robot ? "convert the robot to .robi first" : "a .sim file has objects of .esObj files",
             group.model_place});
        return;
      }
      type = declared_type(group.model, base_folder(scenario_, group.model_place), robot, group.model_place);
      const std::string line = (robot ? "robot " : "object ") + in_quotes(group.model) + "\n";
      if (types_.find(line) == std::string::npos) types_ += line;
    }
    const Pose& X = group.placement.X_WM;
    lines_ += in_quotes(type) + " " + sim_decimal(X.p.x * 1e3) + " " + sim_decimal(X.p.y * 1e3) + " " +
              sim_decimal(yaw_of(X.q) * (180 / math::pi));
    if (robot) lines_ += program(group);
    lines_ += "\n";
  }

  std::string program(const RobotGroup& group) const {
    const auto& controllers = group.instance.controllers.get();
    if (controllers.empty()) return "";
    const model::ControllerDecl& first = controllers.front();
    if (controllers.size() > 1)
      leave_out("a second controller of '" + group.name + "'", controllers[1].place);
    const Node* const program = first.config.find("program");
    if (first.kind == "robios" && program) return " " + in_quotes(program->text());
    std::string out = "controller:" + first.kind;
    char mark = '?';
    for (const Node::Entry& key : first.config.entries())
      if (key.value.is_scalar() && key.value.text().find_first_of("&\"") == std::string::npos)
        out += mark + key.key + "=" + key.value.text(), mark = '&';
      else leave_out("'" + key.key + "' of the controller of '" + group.name + "'", key.key_place);
    return " " + in_quotes(out);
  }

  std::string marker_line(const model::ElementDecl& marker) const {
    const Node* const centre = marker.config.find("centre");
    const Node* const color = marker.config.find("color");
    if (marker.kind != "disc" || !centre || centre->items().size() != 2) {
      leave_out("marker '" + marker.name + "'", marker.place);
      return "";
    }
    std::string out = "marker";
    const auto scaled = [&](const Node& node, double factor) {
      double value = 0;
      for (const Node& each : node.items())
        if (parse_number(each.text(), value)) out += " " + sim_decimal(value * factor);
    };
    scaled(*centre, 1e3);
    if (color && color->items().size() == 3) scaled(*color, 255);
    return out + "\n";
  }

  const Scenario& scenario_;
  Diagnostics& diagnostics_;
  std::string types_, lines_;
};

}  // namespace

Result<std::string> sim_of(const Scenario& scenario, Diagnostics& diagnostics) {
  return SimWriter(scenario, diagnostics).write();
}

}  // namespace sandlot::formats::eyesim
