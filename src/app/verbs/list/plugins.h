#pragma once
/// Names in files of Gazebo and of joint controllers, and what they become here.
#include <string>
#include <vector>

namespace sandlot::app {

/// One thing that a Gazebo file or a controller file may name, and what it becomes here.
struct Mapped {
  std::string name, element, kind, levels, unused;
};
std::vector<Mapped> mapped_names();

void print_plugins();
/// As a part of the reference page.
void print_plugin_table();

}  // namespace sandlot::app
