#pragma once
/// Finder of objects of known colours in pictures: balls, goals and robots on flat ground, with their places.
///
/// Frame    B: the robot's base, z up; the ground is the plane z = -base_height. Pictures come from a camera
///          at X_BS.
/// Ball     its middle is where the ray of the patch's middle meets the plane of its radius; rays that hardly
///          fall (less than 1.5 degrees) meet it anywhere, so there the size of the patch decides. `visible`
///          is the size seen of that expected; patches too small or too large for their place are not balls,
///          nor are lines of mixed colour where two surfaces meet.
/// Standing things (goals, robots, posts) have a lower edge at a known height. In each of up to 48 directions
/// the lowest pixel of the
///          patch is a point of it; those near the nearest one are averaged, and `depth` leads on to the
///          middle.
/// Pieces   patches of one target nearer to each other than 0.8 of its size are one thing, separated by what
///          stands before it.
/// Horizon  patches of standing things without a pixel below the horizon are none of them.
/// Noise    specks are bridged (`gap`) and small patches dropped (`min_pixels`).
/// Limits   no tracking from picture to picture; one thing behind another of the same colour becomes one
///          thing.
/// Cost     one look into a table per pixel, 16 bytes of memory per pixel of the camera, no allocation after
///          the first picture.
/// Source   the vision of soccer robots of the Middle Size League: M. Lauer, S. Lange, M. Riedmiller,
///          Calculating the perfect match (2005), sec. 2.
#include <string>
#include <vector>

#include "base/text.h"
#include "perception/blobs.h"
#include "perception/camera_model.h"

namespace sandlot::perception {

enum class Form : std::uint8_t { ball, standing };
inline constexpr EnumName<Form> form_names[] = {{"ball", Form::ball}, {"standing", Form::standing}};
constexpr std::span<const EnumName<Form>> enum_names(Form) { return form_names; }

struct Target {
  std::string label = "ball";
  ColourRange colour;
  Form form = Form::ball;
  double size_m = 0.22, foot_m = 0, depth_m = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"label", "", "Label of the object when it is found."}, s.label);
    visit(Field{"colour", "", "Colour of the object."}, s.colour);
    visit(Field{"form", "", "Shape that the distance is computed from."}, s.form);
    visit(Field{"size", "m", "Size of the object: a ball's diameter, otherwise the width.", 1e-3, 100},
          s.size_m);
    visit(Field{"foot", "m", "Height of the colour's lower edge over the ground, of an object that stands.",
                -10, 10},
          s.foot_m);
    visit(Field{"depth", "m", "Distance from the nearest point to the middle, of an object that stands.", 0,
                100},
          s.depth_m);
  }
};

struct FinderSpec {
  std::vector<Target> targets{Target{}};
  double base_height_m = 0;
  int min_pixels = 6, gap = 1;
  double max_range_m = 30, min_visible = 0.15;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"targets", "", "Objects to search for.", 0, 0, Field::none, 200, 1}, s.targets);
    visit(Field{"base_height", "m", "Height of the robot's base frame over the ground.", -10, 10},
          s.base_height_m);
    visit(Field{"min_pixels", "1", "Smallest number of pixels of a patch; smaller ones count as noise.", 1,
                1e6},
          s.min_pixels);
    visit(Field{"gap", "1", "Number of pixels of another colour that do not separate a patch.", 0, 16},
          s.gap);
    visit(Field{"max_range", "m", "Farthest distance at which an object is reported.", 1e-3, 1e4},
          s.max_range_m);
    visit(Field{"min_visible", "1", "Smallest visible part, of the width of an object that stands.", 0, 1},
          s.min_visible);
  }
};

struct Found {
  std::uint32_t target = 0;  ///< index into FinderSpec::targets
  Vec3 position_B;           ///< of its middle: balls in height too, others on the ground
  double bearing_rad = 0;    ///< in B, from x to y
  double range_m = 0;        ///< over the ground, from B's origin
  double visible = 1, confidence = 1;
  Blob patch;
};

class Finder {
 public:
  Finder() = default;
  /// @param X_BS  where the camera sits
  Finder(FinderSpec spec, const CameraModel& camera, const Pose& X_BS);
  int width() const { return width_; }
  int height() const { return height_; }

  /// Objects in the picture, the nearest first. An error when the picture has another size than the camera.
  Status find(const ImageView& picture, std::vector<Found>& out);

 private:
  struct Sum {  ///< over a patch
    Vec3 direction;
    double solid_angle = 0, lowest = 1;
  };
  bool ball(const Target& target, const Sum& sum, const Blob& patch, Found& out) const;
  bool standing(const Target& target, std::uint32_t blob, const Sum& sum, Found& out);
  /// Point where the lower edge of a pixel meets the plane.
  Vec3 foot_on(std::size_t pixel, double height_B) const;

  FinderSpec spec_;
  ColourTable colours_;
  int width_ = 0, height_ = 0;
  Vec3 eye_B_;
  std::vector<std::array<float, 3>> directions_B_,
      origins_B_;  ///< per pixel; NaN: sees nothing. Origins of some mirrors only
  std::vector<float> solid_angle_;
  BlobFinder blobs_;
  std::vector<Sum> sums_;
  std::vector<std::uint32_t> first_run_, next_run_;
};

}  // namespace sandlot::perception
