#pragma once
/// stereo_msgs (Humble).
#include "messages/sensor_images.h"

namespace sandlot::msg {

/// How far points lie apart in the pictures of two eyes.
struct DisparityImage {
  static constexpr const char* ros_type = "stereo_msgs/msg/DisparityImage";
  Header header;
  Image image;
  float f = 0;
  float t = 0;
  RegionOfInterest valid_window;
  float min_disparity = 0;
  float max_disparity = 0;
  float delta_d = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"image", "1", "Disparities [pixels] as 32FC1; below min_disparity: none was found."},
          s.image);
    visit(Field{"f", "1", "Focal length [pixels]."}, s.f);
    visit(Field{"t", "m", "Distance between both eyes."}, s.t);
    visit(Field{"valid_window", "", "Part of the image in which there may be disparities."}, s.valid_window);
    visit(Field{"min_disparity", "1", "Smallest disparity that is looked for [pixels]."}, s.min_disparity);
    visit(Field{"max_disparity", "1", "Largest disparity that is looked for [pixels]."}, s.max_disparity);
    visit(Field{"delta_d", "1", "Step of the disparities [pixels]; 0: any value."}, s.delta_d);
  }
};

}  // namespace sandlot::msg
