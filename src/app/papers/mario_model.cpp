/// Section 2 of the MARIO paper: the model as a kinematic chain, the world's parameters, what its pair of eyes sees.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

#include "app/papers/mario.h"
#include "app/papers/pictures.h"
#include "draw/graph.h"
#include "messages/messages.h"
#include "sim/world/simulation.h"

namespace sandlot::app::mario {
namespace {

std::string type_text(model::JointType type) {
  for (const auto& each : model::enum_names(type))
    if (each.value == type) return std::string(each.name);
  return "?";
}

}  // namespace

std::vector<ChainLink> chain_of(const model::Model& model) {
  std::vector<ChainLink> out;
  for (const model::Joint& joint : model.joints) {
    if (joint.parent >= model.links.size()) continue;
    const model::Link &parent = model.links[joint.parent], &child = model.links[joint.child];
    out.push_back({joint.name, type_text(joint.type), parent.name, child.name,
                   inverse(parent.X_ML) * child.X_ML, joint.type != model::JointType::fixed});
  }
  return out;
}

draw::Graph drawing_of(const std::vector<ChainLink>& chain) {
  draw::Graph out;
  std::vector<std::string> links;
  const auto place = [&](const std::string& link) {
    for (std::size_t i = 0; i < out.nodes.size(); ++i)
      if (out.nodes[i].form == draw::Graph::Form::box && out.nodes[i].label == link) return i;
    out.nodes.push_back({link, draw::Graph::Form::box, "#ffffff"});
    return out.nodes.size() - 1;
  };
  for (const ChainLink& each : chain) {
    const std::size_t parent = place(each.parent), joint = out.nodes.size();
    out.nodes.push_back({each.joint, draw::Graph::Form::ellipse, each.moves ? "#fde5cc" : "#eeeeee"});
    const std::size_t child = place(each.child);
    out.edges.emplace_back(parent, joint);
    out.edges.emplace_back(joint, child);
  }
  return out;
}

namespace {

void figure_5(Report& report, const model::Model& model) {
  const std::vector<ChainLink> chain = chain_of(model);
  report.page.heading("Figure 5: the kinematic chain");
  report.figure("figure_5", draw::draw_graph(drawing_of(chain)),
                "Figure 5: links (boxes) and joints (ellipses) that Sandlot reads from the URDF file "
                "(models/mario/mario.urdf). Orange: joints that move; grey: fixed ones.");
  std::vector<std::vector<std::string>> rows;
  double moving = 0;
  for (const ChainLink& each : chain) {
    moving += each.moves;
    const Vec3 p = each.X_PC.p, rpy = rpy_from_quat(each.X_PC.q);
    const auto number = [](double x) { return fmt::format("{:g}", std::round(1e4 * x) / 1e4 + 0.0); };
    rows.push_back({each.joint, each.type, each.parent, each.child,
                    number(p.x) + ", " + number(p.y) + ", " + number(p.z),
                    number(rpy.x) + ", " + number(rpy.y) + ", " + number(rpy.z)});
  }
  report.page.table({"joint", "type", "from", "to", "x, y, z [m]", "roll, pitch, yaw [rad]"}, rows);
  report.page.paragraph(
      "The paper has the same nine links and eight joints, fixed ones for the sensors and the virtual "
      "base_footprint, with these names. Of its numbers only the size of the base and place, size and mass "
      "of the "
      "inertial unit are printed as text; they are kept (models/mario/README.md says which numbers are "
      "ours). The "
      "frames of the two optical axes are ours.");
  // The chassis, and each link behind a joint that moves.
  report.rows.push_back(
      {"Figure 5", "joints that move", "", 8.0, moving, moving == 8 ? "the same" : "differs"});
  report.rows.push_back(
      {"Figure 5", "links that they join", "", 9.0, moving + 1, moving == 8 ? "the same" : "differs"});
}

std::string world_text(const model::Setup& setup) {
  return fmt::format(
      "World and physics: gravity {:g}, {:g}, {:g} m/s^2; engine {}, steps of {:g} ms in {} sub-steps. The "
      "parameters in the paper's Figure 2 are in a screenshot that was not at hand.",
      setup.gravity.x, setup.gravity.y, setup.gravity.z, setup.engine, 1000 * setup.step.s(), setup.substeps);
}

}  // namespace

Status model_and_eyes(Report& report) {
  std::array<assets::Picture, 2> eyes;
  std::shared_ptr<const model::Model> model;
  std::string world;
  LoggedRunSpec spec{.condition = {"model", "vineyard_loop", {}}, .values = {"x"}, .duration_s = 0.02};
  spec.at_end = [&](const Simulation& simulation) -> Status {
    const auto* const entity = simulation.find_entity("mario");
    if (!entity) return Error{"vineyard_loop has no robot 'mario'"};
    model = entity->instance.model;
    world = world_text(simulation.setup());
    for (std::size_t i = 0; i < 2; ++i) {
      const auto* const image = topic_cast<msg::Image>(
          simulation.find_topic(i == 0 ? "/mario/stereo/left/image" : "/mario/stereo/right/image"));
      if (!image || image->count == 0) return Error{"the pair of eyes of 'mario' has no pictures"};
      SL_ASSIGN(eyes[i], assets::visible(image->message));
    }
    return {};
  };
  SL_TRY(report.context.logged(spec));
  figure_5(report, *model);
  report.page.heading("Figures 2 and 7: the world, and what the robot sees of it");
  report.page.paragraph(world);
  PictureTile left = tile_of(eyes[0], "left"), right = tile_of(eyes[1], "right");
  left.scale = right.scale = 0.7;
  report.figure(
      "figure_7", picture_svg({left, right}, 2),
      "Figure 7: the pictures of the stereo camera, from which visual odometry is computed, at the start of "
      "the loop: 640 x 480 pixels, 85 degrees, eyes 12 cm apart, Gaussian noise of 1 % in each pixel.");
  return {};
}

}  // namespace sandlot::app::mario
