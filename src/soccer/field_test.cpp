#include "soccer/field.h"

#include <gtest/gtest.h>

namespace sandlot::soccer::test {
namespace {

TEST(Dimensions, FitIntoEachOther) {
  for (const auto& size : enum_names(FieldSize{})) {
    const Dimensions d = dimensions_of(size.value);
    EXPECT_LT(d.goal_width_m, d.goal_area_width_m) << size.name;
    EXPECT_LT(d.goal_area_width_m, d.penalty_area_width_m) << size.name;
    EXPECT_LT(d.goal_area_depth_m, d.penalty_area_depth_m) << size.name;
    EXPECT_LT(d.penalty_area_width_m, d.width_m) << size.name;
    EXPECT_LT(d.penalty_mark_m + d.circle_radius_m, d.length_m / 2) << size.name;
    EXPECT_LT(2 * d.restart_y_m, d.width_m) << size.name;
  }
}

}  // namespace
}  // namespace sandlot::soccer::test
