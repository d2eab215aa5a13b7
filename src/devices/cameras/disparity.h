#pragma once
/// Disparities of a rectified pair of pictures by matching blocks of pixels.
///
/// Cost       sum over a square window of the absolute differences of both pictures' horizontal slopes (Sobel, cut off at +-31, so that
///            the brightness of an eye does not matter). Of the disparities looked for the cheapest counts.
/// Sub-pixel  two lines of equal and opposite slope through the cheapest and its neighbours, in steps of 1/16.
/// Refused    windows without texture; where another disparity, not next to it, is nearly as cheap; what the right eye matches with
///            something nearer (by more than one pixel): it does not see that point. There the disparity is `no_disparity`.
/// Errors     those of the method and nothing else: windows that reach over an edge widen what is near, repeated patterns match
///            wrongly, noise of pixels moves the minimum.
/// Limits     whole surfaces are seen as if they faced the camera; no filter of small patches, no global reasoning.
/// Random     none; whole numbers alone, so that rows may be split over any threads.
/// Cost       640 x 480 with 64 disparities: some 25 ms on one core. Allocates for each strip of rows.
/// Source     K. Konolige, Small Vision Systems: Hardware and Implementation (1997); the sub-pixel fit: M. Shimizu, M. Okutomi,
///            Sub-pixel Estimation Error Cancellation on Area-Based Matching (2005).
#include <cstdint>
#include <span>

#include "base/fields.h"

namespace sandlot::cameras {

struct MatchKeys {
  int window = 11, count = 64, least = 0;
  int texture = 8;
  double uniqueness = 0.1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"window", "1",
                "Side of the square that is compared [pixels]; an even number becomes the next odd one.", 3,
                31},
          s.window);
    visit(Field{"count", "1", "Number of disparities that are looked for [pixels].", 2, 512}, s.count);
    visit(Field{"min", "1", "Smallest disparity that is looked for [pixels].", 0, 4096}, s.least);
    visit(Field{"texture", "1",
                "Mean slope that a window must have to be looked at [half a grey value per pixel].", 0, 255,
                Field::tunable},
          s.texture);
    visit(Field{"uniqueness", "1", "Margin by which the best disparity must be cheaper than any other one.",
                0, 10, Field::tunable},
          s.uniqueness);
  }
};

constexpr float no_disparity = -1;

/// Computes the rows [first, last) of the disparities u_left - u_right, one per pixel of the left picture.
/// @param left, right  8 bits per pixel, width x height, rows without gaps
/// @param disparity    out: the rows asked for, without gaps
void match_rows(const MatchKeys& keys, std::span<const std::uint8_t> left,
                std::span<const std::uint8_t> right, int width, int height, int first, int last,
                std::span<float> disparity);

}  // namespace sandlot::cameras
