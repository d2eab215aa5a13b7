#pragma once
/// Plan of a room as EyeSim's worlds and mazes give it, and the world made of it.
///
/// Frame    W: origin at the lower left corner of the plan, x right, y up in it. [m], [rad]
/// Walls    upright boxes about their line, from the ground up.
#include <optional>
#include <string>
#include <vector>

#include "formats/content.h"
#include "geometry/color.h"

namespace sandlot::formats::eyesim {

struct Wall {
  double x1_m = 0, y1_m = 0, x2_m = 0, y2_m = 0;
  double thickness_m = 0.01, height_m = 0.2;
  Color color{0.85f, 0.85f, 0.82f, 1};
  Place place;
};

struct Spot {
  double x_m = 0, y_m = 0, yaw_rad = 0;
  Place place;
};

struct Plan {
  std::vector<Wall> walls;
  double width_m = 0, height_m = 0;  ///< of the floor; 0: none
  std::string texture;               ///< file as written; "": none
  Place texture_place;
  std::vector<Spot> starts;        ///< of robots, in the order of the file
  std::vector<Spot> balls, boxes;  ///< where a maze has letters for them
};

Result<Plan> read_wld(std::string_view text, const std::string& file, Diagnostics& diagnostics);
/// Walls of neighbouring cells that lie in one line are one.
Result<Plan> read_maze(std::string_view text, const std::string& file, Diagnostics& diagnostics);

/// @param name  of the world
Result<WorldContent> world_of(const Plan& plan, const std::string& name, const std::string& file,
                              const ReadOptions& options, Diagnostics& diagnostics);

/// A plan as a .maz file. Walls lose their thickness, height and colour.
/// Errors   walls that do not lie on a grid.
Result<std::string> maze_text(const Plan& plan, Diagnostics& diagnostics);
/// A world as a .maz file: upright boxes that stand still are walls, robots are starts, balls and boxes are letters.
Result<std::string> maze_of(const model::Setup& setup, Diagnostics& diagnostics);
/// Appends the upright boxes of a thing that stands still as walls; of other shapes one warning says that they are left out.
void walls_of_instance(const model::Instance& instance, std::vector<Wall>& out, Diagnostics& diagnostics);

/// Upright boxes that stand still, and the floor, as a .wld file; of everything else one warning says that it is left out.
Result<std::string> wld_of(const model::Setup& setup, Diagnostics& diagnostics);

}  // namespace sandlot::formats::eyesim
