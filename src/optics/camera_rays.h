#pragma once
/// The rays of a picture, eight at a time: pixels, samples on pixel and lens, moments of the exposure.
///
/// Samples on the pixel stand in the same places in every pixel (a Hammersley set, whose mean is the centre);
/// those on the lens are turned by an angle from the hash of key and pixel, so that blur is grain and not
/// pattern.
#include <array>
#include <vector>

#include "optics/picture.h"
#include "optics/picture_tree.h"

namespace sandlot::optics {

/// X after `t_s` at constant velocity.
Pose moved(const Pose& X, const Velocity& velocity, double t_s);

/// Eight neighbouring pixels: 4 x 2, or 8 x 1 when rows are exposed one after the other.
struct Block {
  lanes::I u, v;
  lanes::I inside;  ///< the image
  int width;        ///< of the image
  std::size_t index(int lane) const {
    return static_cast<std::size_t>(v[lane]) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u[lane]);
  }
};

struct Aim {
  Rays rays;
  lanes::F cone;  ///< [rad] that one sample stands for
};

class CameraRays {
 public:
  explicit CameraRays(const PictureJob& job);

  int samples() const { return samples_; }
  int slices() const { return slices_; }
  bool has_aperture() const { return aperture_; }
  int block_width() const { return rolling_ ? 8 : 4; }
  int block_height() const { return rolling_ ? 1 : 2; }
  Block block(int u0, int v0) const;

  /// Through the pixels' centres and the middle of the lens, in the middle of the exposure.
  Aim centre(const Block& block) const;
  Aim aim(const Block& block, int sample) const;
  int centre_slice(const Block& block) const { return slice_at(row_time(block)); }
  int slice_of(const Block& block, int sample) const;
  double time_of_slice(int slice) const;

  /// Value of PictureJob::depth_m for a hit at t.
  lanes::F depth(const Block& block, const Rays& rays, lanes::F t) const;

 private:
  /// The camera at one moment.
  struct View {
    float axes[9];    ///< columns: x y z of S in W
    float offset[3];  ///< from the base
  };
  View view(double t_s) const;
  double row_time(const Block& block) const;
  int slice_at(double t_s) const;
  Aim aim(const Block& block, lanes::F du, lanes::F dv, const View& view, int lens_sample) const;
  lanes::F3 from_table(const Block& block, lanes::F du, lanes::F dv, lanes::I& valid, lanes::F& cone) const;

  const PictureJob& job_;
  const Lens& lens_;
  double base_[3];
  int samples_ = 1, slices_ = 1;
  double first_s_ = 0, last_s_ = 0;  ///< of the whole exposure
  bool pinhole_ = false, plain_ = false, aperture_ = false, rolling_ = false, moving_ = false;
  float per_fx_ = 1, per_fy_ = 1, cx_ = 0, cy_ = 0, cone_scale_ = 1;
  View still_;
  std::vector<std::array<float, 2>> on_pixel_, on_lens_;
  std::vector<double> when_s_;  ///< of each sample, about the middle of its row's exposure
};

}  // namespace sandlot::optics
