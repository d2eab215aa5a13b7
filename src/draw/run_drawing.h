#pragma once
/// Drawing of a run from above: the world, the robots with their paths and last laser scans, as one SVG file
/// for browsers and READMEs.
#include <map>
#include <string>
#include <vector>

#include "draw/plan.h"
#include "sim/world/simulation.h"

namespace sandlot::draw {

/// Observer that collects paths and scans. Add it before the run.
///
/// Limits   a robot's path is kept as at most 20,000 points: 2 cm apart on the first 400 m, then twice that,
///          and so on.
class RunDrawing final : public Observer {
 public:
  /// @param simulation  must outlive the drawing; draw() shows its static world at that time
  explicit RunDrawing(const Simulation& simulation);
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
  Plan plan() const;
  /// The finished drawing.
  std::string draw() const { return to_svg(plan()); }

 private:
  struct Path {
    std::vector<std::vector<Vec3>> parts;  ///< a new one after each jump
    Vec3 last;                             ///< where the robot was in the previous frame
    double spacing_m = 0.02;               ///< a new point after this distance
    double driven_m = 0;
    std::size_t points = 0;

    void add(Vec3 point);
  };
  /// Where the sensor was when it took its latest scan.
  struct ScanPose {
    Time stamp;
    Pose X_WS;
  };
  void note_scans();
  std::vector<Plan::Scan> scans_of(const Simulation::Entity& entity) const;

  const Simulation& simulation_;
  std::map<std::string, Path> paths_;
  std::map<const TopicBase*, ScanPose> scan_poses_;
};

}  // namespace sandlot::draw
