#pragma once
/// Topic graph: the nodes of a running world and the topics between them, as ROS's rqt_graph shows them.
///
/// Nodes    devices, programs and what clients publish for programs. A device is a node of its own, as a driver is in ROS.
/// Topics   what a node publishes, at the levels that are active now; what a program looked up while it began is what it
///          reads; what an actuator takes is a topic that the program publishes and the device reads.
/// Order    that of Simulation::for_each_topic; readers and publishers in the order of entities.
/// Limits   programs outside this process look nothing up: they are nodes that publish alone. Media, rules and viewers are left
///          out.
#include <string>
#include <vector>

namespace sandlot {

class Simulation;

struct TopicGraph {
  struct Node {
    std::string path;  ///< "rover/laser"
    std::string kind;  ///< "range_finder"
    bool program = false;
  };
  struct Topic {
    std::string name;                              ///< "/rover/laser/ranges"
    std::string type;                              ///< "sensor_msgs/msg/LaserScan"
    std::vector<std::size_t> publishers, readers;  ///< indices into `nodes`
  };
  std::vector<Node> nodes;
  std::vector<Topic> topics;
};

TopicGraph topic_graph(const Simulation& simulation);

}  // namespace sandlot
