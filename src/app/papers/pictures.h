#pragma once
/// Pictures of a report: rendered images side by side, with marks on them, as one SVG that holds their pixels.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "assets/image/visible.h"

namespace sandlot::app {

/// Box around something in a picture, with a text beside it.
struct PictureMark {
  double left = 0, top = 0, right = 0, bottom = 0;  ///< first and last column and row
  std::string text, colour = "#ffff00";
};

struct PictureTile {
  std::string title;  ///< above the picture; "": no line for titles where no tile has one
  int width = 0, height = 0;
  std::span<const std::uint8_t> rgb;  ///< @pre 3 * width * height values
  std::vector<PictureMark> marks = {};
  double scale = 1;  ///< size in the page over the picture's own
};

PictureTile tile_of(const assets::Picture& picture, std::string title = "");

/// Pictures in rows of `columns`, from the upper left of places that are as wide and high as the largest.
std::string picture_svg(const std::vector<PictureTile>& tiles, int columns);

}  // namespace sandlot::app
