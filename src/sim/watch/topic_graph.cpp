#include "sim/watch/topic_graph.h"

#include <algorithm>
#include <map>

#include "sim/world/simulation.h"

namespace sandlot {
namespace {

using Device = Simulation::Device;
using GraphProgram = Simulation::ProgramEntry;

class GraphBuilder {
 public:
  explicit GraphBuilder(const Simulation& simulation) : simulation_(simulation) {}

  TopicGraph build() {
    for (const auto& entity : simulation_.entities()) {
      for (const auto& device : entity->devices) add_device(*device);
      for (const auto& program : entity->programs) add_program(*program);
    }
    for (const Simulation::Team& team : simulation_.teams())
      for (const auto& program : team.programs) add_program(*program);
    // Readers and orders, when all topics are known.
    for (const auto& entity : simulation_.entities())
      for (const auto& program : entity->programs) connect(*program);
    for (const Simulation::Team& team : simulation_.teams())
      for (const auto& program : team.programs) connect(*program);
    return std::move(graph_);
  }

 private:
  std::size_t add_node(const std::string& path, const std::string& kind, bool program) {
    nodes_.emplace(path, graph_.nodes.size());
    graph_.nodes.push_back({path, kind, program});
    return graph_.nodes.size() - 1;
  }
  TopicGraph::Topic& topic(const TopicBase& base) {
    const auto [place, fresh] = topics_.emplace(base.name(), graph_.topics.size());
    if (fresh) graph_.topics.push_back({base.name(), base.type(), {}, {}});
    return graph_.topics[place->second];
  }
  static void link(std::vector<std::size_t>& list, std::size_t node) {
    if (std::find(list.begin(), list.end(), node) == list.end()) list.push_back(node);
  }

  void add_device(const Device& device) {
    const std::size_t node = add_node(device.path, device.decl.kind, false);
    const std::size_t levels = simulation_.kind(device).levels.size();
    for (const Simulation::Slot& slot : device.topics)
      if (slot.level >= levels || (device.levels >> slot.level & 1))
        link(topic(*slot.topic).publishers, node);
  }
  void add_program(const GraphProgram& program) {
    const std::size_t node = add_node(program.path, program.decl.kind, true);
    if (!program.outputs) return;
    for (const Outputs::Output& output : program.outputs->all()) link(topic(*output.topic).publishers, node);
    for (const Outputs::Input& input : program.outputs->inputs()) link(topic(*input.topic).readers, node);
  }
  void connect(const GraphProgram& program) {
    const std::size_t node = nodes_.at(program.path);
    for (const std::uint32_t reading : program.reads)
      if (reading < program.topics.size() && program.topics[reading])
        link(topic(*program.topics[reading]).readers, node);
    for (const std::uint32_t actuator : program.claims) {
      if (actuator >= program.routes.size()) continue;
      const Simulation::Route& route = program.routes[actuator];
      if (!route.device || !route.slot) continue;
      TopicGraph::Topic& orders = topic(*route.slot->topic);
      link(orders.publishers, node);
      link(orders.readers, nodes_.at(route.device->path));
    }
  }

  const Simulation& simulation_;
  TopicGraph graph_;
  std::map<std::string, std::size_t, std::less<>> nodes_, topics_;
};

}  // namespace

TopicGraph topic_graph(const Simulation& simulation) { return GraphBuilder(simulation).build(); }

}  // namespace sandlot
