/// Worlds: walls by their ends, in frames that may be pushed, as the Saphira simulator had them.
#include <array>
#include <cmath>

#include "base/math.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/plan.h"

namespace sandlot::formats::eyesim {
namespace {

constexpr std::size_t deepest = 100;

struct Frame {
  double x_m, y_m, yaw_rad;
};

class WldReader {
 public:
  explicit WldReader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  Status read(const Line& line) {
    const std::string word = lower(line.keyword());
    if (is_number(word)) return wall(line);
    if (word == "width") return length(line, plan_.width_m);
    if (word == "height") return length(line, plan_.height_m);
    if (word == "floor") {
      SL_TRY(length(line, plan_.width_m));
      SL_ASSIGN(const double height, number_at(line, 2, "a height in mm"));
      return set_length(line, height, plan_.height_m);
    }
    if (word == "floor_texture") {
      if (line.arguments() < 1) return line.error("'floor_texture' names no picture");
      plan_.texture = line.words[1];
      plan_.texture_place = line.place;
      return {};
    }
    if (word == "push") {
      if (frames_.size() >= deepest) return line.error("more than 100 frames are pushed into each other");
      SL_ASSIGN(const Spot spot, pose(line));
      frames_.push_back({spot.x_m, spot.y_m, spot.yaw_rad});
      return {};
    }
    if (word == "pop") {
      if (frames_.empty()) return line.error("'pop' has no 'push' before it");
      frames_.pop_back();
      return {};
    }
    if (word == "position") {
      SL_ASSIGN(Spot spot, pose(line));
      to_world(spot.x_m, spot.y_m);
      for (const Frame& frame : frames_) spot.yaw_rad += frame.yaw_rad;
      plan_.starts.push_back(spot);
      return {};
    }
    warn_unknown(line, diagnostics_);
    return {};
  }

  Plan take() { return std::move(plan_); }

 private:
  static Status set_length(const Line& line, double value_mm, double& out) {
    if (!(value_mm > 0)) return line.error("a floor of this size is none", "give its width and height in mm");
    out = value_mm * mm;
    return {};
  }
  static Status length(const Line& line, double& out) {
    SL_ASSIGN(const double value, number_at(line, 1, "a length in mm"));
    return set_length(line, value, out);
  }
  static Result<Spot> pose(const Line& line) {
    SL_ASSIGN(const double x, number_at(line, 1, "x in mm"));
    SL_ASSIGN(const double y, number_at(line, 2, "y in mm"));
    SL_ASSIGN(const double phi, number_at(line, 3, "an angle in degrees"));
    return Spot{x * mm, y * mm, radians(phi), line.place};
  }

  /// From the innermost frame to the world.
  void to_world(double& x, double& y) const {
    for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
      const double c = math::cos(frame->yaw_rad), s = math::sin(frame->yaw_rad);
      const double turned_x = c * x - s * y + frame->x_m;
      y = s * x + c * y + frame->y_m;
      x = turned_x;
    }
  }

  Status wall(const Line& line) {
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 0));
    if (n.size() < 4) {
      diagnostics_.warn(
          line.error("a wall has four numbers at least; this line is left out", "write x1 y1 x2 y2 in mm"));
      return {};
    }
    Wall wall{
        .x1_m = n[0] * mm, .y1_m = n[1] * mm, .x2_m = n[2] * mm, .y2_m = n[3] * mm, .place = line.place};
    if (n.size() >= 6) {
      if (!(n[4] > 0 && n[5] > 0)) return line.error("a wall has a thickness and a height above 0");
      wall.thickness_m = n[4] * mm;
      wall.height_m = n[5] * mm;
    }
    if (n.size() >= 9) {
      std::array<float, 3> rgb{};
      for (std::size_t i = 0; i < 3; ++i) {
        if (!(n[6 + i] >= 0 && n[6 + i] <= 255)) return line.error("colours are from 0 to 255");
        rgb[i] = static_cast<float>(n[6 + i] / 255);
      }
      wall.color = {rgb[0], rgb[1], rgb[2], 1};
    }
    if (n.size() != 4 && n.size() != 6 && n.size() != 9)
      diagnostics_.warn(line.error("a wall has 4, 6 or 9 numbers; what is too many is left out",
                                   "x1 y1 x2 y2 thickness height red green blue"));
    to_world(wall.x1_m, wall.y1_m);
    to_world(wall.x2_m, wall.y2_m);
    const double dx = wall.x2_m - wall.x1_m, dy = wall.y2_m - wall.y1_m;
    if (!(dx * dx + dy * dy > 1e-12)) {
      diagnostics_.warn(line.error("a wall without length is left out"));
      return {};
    }
    plan_.walls.push_back(wall);
    return {};
  }

  Diagnostics& diagnostics_;
  Plan plan_;
  std::vector<Frame> frames_;
};

}  // namespace

Result<Plan> read_wld(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  SL_ASSIGN(const std::vector<Line> lines, lines_of(text, file));
  WldReader reader(diagnostics);
  for (const Line& line : lines) SL_TRY(reader.read(line));
  return reader.take();
}

}  // namespace sandlot::formats::eyesim
