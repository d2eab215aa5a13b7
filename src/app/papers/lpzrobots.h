#pragma once
/// Parts of the report on LpzRobots that need no robot of the thesis: substances in contact (chapter 2), and agents in a loop of numbers
/// (sections 4.1.2, 4.7.1, 4.8, 5.1.1).
#include <cstdint>

#include "app/papers/papers.h"

namespace sandlot::app::lpzrobots {

/// What an agent in the loop x' = A y + S x + noise came to. A = 0.5 I; S = 0.4 times a turn by 30 degrees, 0 without a world; noise
/// uniform within 0.05.
struct LoopResult {
  double model_error = 0;  ///< |A_learned - A|, Frobenius norm
  double world_error = 0;  ///< |S_learned - S|
  double surprise = 0;     ///< root mean square of the model's error over the last quarter
  double off_taught = 0;   ///< mean |y - taught| per motor over the last quarter
  double off_goal = 0;     ///< mean |x - goal| per sensor over the last quarter
};
struct LoopSpec {
  std::uint64_t seed = 1;
  bool world = false;           ///< whether the sensors go on without the motors: S
  bool extended_model = false;  ///< whether the agent's model has an S
  bool babbling = false;  ///< motor values are drawn uniformly from -1 to 1 and the agent learns from them
  bool taught = false;    ///< direct teaching of taught_y
  bool goal = false;      ///< an additional error function: the sensors should be goal_x
};
inline constexpr int loop_steps = 20'000;
inline constexpr double taught_y[] = {0.6, -0.3}, goal_x[] = {-0.2, 0.3};
Result<LoopResult> run_loop(const LoopSpec& spec);

/// Table 2.1, equations 2.2 and 2.3.
Status substances(const ReproduceContext& context, ReportPage& page);
/// Sections 4.1.2, 4.7.1, 4.8, 5.1.1.
Status loop_of_numbers(const ReproduceContext& context, ReportPage& page);

}  // namespace sandlot::app::lpzrobots
