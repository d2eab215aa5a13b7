/// Chapter 2 of the thesis: what substances do in contact, measured with the blocks and balls of scenarios/materials.yaml.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/papers/lpzrobots.h"
#include "base/math.h"
#include "model/substance.h"
#include "physics/substance.h"

namespace sandlot::app::lpzrobots {
namespace {

// worlds/materials.sdf: balls of 0.3 kg on a plate of metal(0.5), blocks of 1 kg on a ramp of the same at 30 degrees.
constexpr double g_mps2 = 9.81, ball_kg = 0.3, ball_radius_m = 0.12, plate_m = 0.2, block_kg = 1,
                 ramp_rad = std::numbers::pi / 6;
constexpr int corners = 4;  ///< contact points of a block
constexpr double duration_s = 6, creep_from_s = 3;

struct Matter {
  const char *name, *text;
};
constexpr Matter matters[] = {{"metal", "metal(0.5)"},
                              {"plastic", "plastic"},
                              {"rubber", "rubber(20)"},
                              {"foam", "foam(10)"},
                              {"snow", "snow(0.5)"}};

}  // namespace

Status substances(const ReproduceContext& context, ReportPage& page) {
  std::vector<std::string> values;
  for (const Matter& each : matters) {
    values.push_back(fmt::format("{}_ball.pose.z", each.name));
    values.push_back(fmt::format("{}_block.pose.x", each.name));
  }
  SL_ASSIGN(const LoggedRun run, context.logged({.condition = {"substances", "materials", {}},
                                                 .values = values,
                                                 .rate_hz = 10,
                                                 .duration_s = duration_s}));
  SL_ASSIGN(const model::NamedSubstance metal, model::substance_from("metal(0.5)"));
  std::vector<std::vector<std::string>> rows;
  const std::size_t last = run.values.columns[0].size() - 1;
  const auto first = last - static_cast<std::size_t>((duration_s - creep_from_s) * 10);
  for (std::size_t i = 0; i < std::size(matters); ++i) {
    SL_ASSIGN(const model::NamedSubstance own, model::substance_from(matters[i].text));
    const SubstancePair pair = combine(own.substance, metal.substance);
    const std::vector<double>&height = run.values.columns[1 + 2 * i], &way = run.values.columns[2 + 2 * i];
    const double deep_mm = 1000 * ball_kg * g_mps2 / pair.stiffness_N_per_m;
    const double measured_mm = 1000 * (plate_m + ball_radius_m - height[last]);
    const bool slides = pair.mu < math::tan(ramp_rad);
    const double creep_mmps = 1000 * pair.slip * block_kg * g_mps2 * math::sin(ramp_rad) / corners;
    const double crept_mmps = 1000 * (way[last] - way[first]) / (creep_from_s * math::cos(ramp_rad));
    // What slides has left the ramp after some seconds: it moved by more than half of the ramp's length.
    const bool slid = way[last] - way[0] > 1.5;
    rows.push_back({matters[i].text, fmt::format("{:g}", pair.mu), slides ? "slides" : "stays",
                    slid ? "slides" : "stays", fmt::format("{:.4g} N/m", pair.stiffness_N_per_m),
                    fmt::format("{:.3f} mm", deep_mm), fmt::format("{:.3f} mm", measured_mm),
                    slides ? "-" : fmt::format("{:.2f} mm/s", creep_mmps),
                    slides ? "-" : fmt::format("{:.2f} mm/s", crept_mmps)});
  }
  page.heading("Section 2.1.4: substances");
  page.paragraph(
      "Table 2.1 and equation 2.2, measured in scenarios/materials.yaml on metal(0.5): blocks of 1 kg on a "
      "ramp of 30 "
      "degrees slide where r1 r2 is below tan 30 deg = 0.577, and creep elsewhere, since slip is a speed per "
      "force at "
      "each of the four corners; balls of 0.3 kg rest m g / kp deep. kp has the factor 100 of LpzRobots' "
      "code, which the "
      "thesis does not print (kd 50).");
  page.table({"substance", "r1 r2", "by the law", "measured", "kp by (2.2)", "rests deep, by the law",
              "measured", "creeps, by the law", "measured"},
             rows);
  page.paragraph(
      "Equation 2.3, the damping, shows in how high a ball bounces: tests hold it to the closed form of a "
      "spring that does not pull (Matter.HowFastItBouncesOff... in src/physics/rigid).");
  return {};
}

}  // namespace sandlot::app::lpzrobots
