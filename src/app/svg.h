#pragma once
/// A picture of a run from above: the world, the robots with their paths and their last laser scans, as one SVG
/// file that a browser or README shows.
#include <map>
#include <string>
#include <vector>

#include "sim/simulation.h"

namespace sandlot {

/// Watches a run and remembers what the picture needs. Add it as an observer before the run.
class SvgRecorder final : public Observer {
 public:
  /// @param simulation  must outlive the recorder; its static world is drawn as it is when drawing
  explicit SvgRecorder(const Simulation& simulation) : simulation_(simulation) {}
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
  /// The finished drawing.
  std::string draw() const;

 private:
  struct Path {
    std::vector<Vec3> points;  ///< thinned: a new point after 2 cm
  };
  const Simulation& simulation_;
  std::map<std::string, Path> paths_;
};

}  // namespace sandlot
