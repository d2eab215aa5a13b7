/// Masses and moments that no body of the link's size can have.
#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

double trace(Vec3 v) { return v.x + v.y + v.z; }

/// The collision shapes as homogeneous solids of equal density: volume, and trace of the inertia about their common
/// centre per kg. Overlapping shapes count twice.
struct Solids {
  double volume_m3 = 0, trace_m2 = 0;
};
Solids solids_of(const model::Link& link) {
  Solids out;
  Vec3 centre;
  std::vector<std::pair<MassProperties, Vec3>> parts;
  for (const model::Collision& c : link.collisions) {
    MassProperties p = mass_properties(c.shape);
    p.volume_m3 = std::abs(p.volume_m3);
    if (!(p.volume_m3 > 0)) continue;
    parts.emplace_back(p, c.X_LC * p.centre_m);
    out.volume_m3 += p.volume_m3;
    centre += p.volume_m3 * parts.back().second;
  }
  if (!(out.volume_m3 > 0)) return out;
  centre = centre / out.volume_m3;
  for (const auto& [p, at_L] : parts)
    out.trace_m2 += p.volume_m3 / out.volume_m3 * (trace(p.moments) + 2 * dot(at_L - centre, at_L - centre));
  return out;
}

void check_link(const model::Link& link, Findings& findings) {
  const model::Inertial& inertial = link.inertial;
  const Bounds seen = bounds_in_link(link, true);
  if (seen.empty()) return;  // nothing says how large it is
  const std::string name = "link '" + link.name + "'";
  const double mass = inertial.mass_kg;
  const Vec3 I = inertial.moments;
  const double largest = std::max({I.x, I.y, I.z});

  // Each moment is the integral of a squared distance over the mass: at most mass R^2, R the farthest point's distance.
  Bounds around_centre;
  around_centre.include(seen.low - inertial.X_LCo.p);
  around_centre.include(seen.high - inertial.X_LCo.p);
  const Vec3 far{std::max(std::abs(around_centre.low.x), std::abs(around_centre.high.x)),
                 std::max(std::abs(around_centre.low.y), std::abs(around_centre.high.y)),
                 std::max(std::abs(around_centre.low.z), std::abs(around_centre.high.z))};
  const double most = mass * dot(far, far);
  const Solids solids = solids_of(link);
  const std::string computed = solids.volume_m3 > 0 ? " (its collision shapes as solids have about " +
                                                          short_text(mass * solids.trace_m2 / 3) + ")"
                                                    : "";
  // Twice that: a unit inertia on a metre of box is sloppy and harmless.
  if (largest > 2 * most) {
    const bool untouched = mass == 1 && I == Vec3{1, 1, 1};
    findings.add("inertia",
                 untouched
                     ? name + " has the inertia that stands for 'not given': 1 kg and 1 kg m^2"
                     : name + " has a moment of inertia of " + short_text(largest) +
                           " kg m^2, and no body of its mass and size has more than " + short_text(most),
                 (untouched ? "write <inertial> with its own mass and moments"
                            : "give moments in kg m^2 about the centre of mass") +
                     computed,
                 link.place);
  } else if (solids.trace_m2 > 0 && trace(I) < 1e-3 * mass * solids.trace_m2) {
    // A homogeneous solid is the yardstick: no machine has its mass a thirtieth as far out (the root of a thousandth).
    findings.add("inertia",
                 name + " has moments of inertia of " + short_text(trace(I) / 3) +
                     " kg m^2 on average, less than a thousandth of what its collision shapes have as solids",
                 "give about " + short_text(mass * solids.trace_m2 / 3) + " kg m^2", link.place);
  }

  // Whoever gives more than a solid has means something hollow, which may be as light as it likes: a ball, whose shell has
  // 5/3 of it, a tube. A quarter more is what rounding and the shape's simplification may do.
  const bool hollow = trace(I) > 1.25 * mass * solids.trace_m2;

  // The densest metal has 22,600 kg/m^3, air 1.2. Too dense: the box around all that is seen or touched holds too little
  // volume; too light: the solid shapes, which hold no more than they say.
  const Vec3 size = seen.size();
  const double box = size.x * size.y * size.z;
  if (box > 0 && mass > 25000 * box)
    findings.add("density",
                 name + " has a mass of " + short_text(mass) + " kg in a box of " + length_text(size.x) +
                     " x " + length_text(size.y) + " x " + length_text(size.z) + ": denser than any metal",
                 "masses are in kg: is this one in grams (" + short_text(mass / 1000) +
                     " kg), or is the size too small?",
                 link.place);
  else if (solids.volume_m3 > 0 && mass < 1.0 * solids.volume_m3 && !hollow)
    findings.add("density",
                 name + " has a mass of " + short_text(mass) + " kg in " + short_text(solids.volume_m3) +
                     " m^3 of collision shapes: lighter than air",
                 "masses are in kg and lengths in m: is the size in mm, or the mass missing?", link.place);

  const double outside = seen.distance_m(inertial.X_LCo.p);
  if (outside > 1e-3)
    findings.add("centre_of_mass",
                 name + " has its centre of mass " + length_text(outside) + " outside all it consists of",
                 "the <pose> of <inertial> is relative to the link", link.place);
}

/// Links that fixed joints make one body bear the same number; the last entry is the world's.
std::vector<std::uint32_t> lumps_of(const model::Model& model) {
  std::vector<std::uint32_t> lump(model.links.size() + 1);
  for (std::uint32_t i = 0; i < lump.size(); ++i) lump[i] = i;
  const auto root = [&](std::uint32_t i) {
    while (lump[i] != i) i = lump[i] = lump[lump[i]];
    return i;
  };
  const auto world = static_cast<std::uint32_t>(model.links.size());
  for (const model::Joint& joint : model.joints)
    if (joint.type == model::JointType::fixed)
      lump[root(joint.child)] = root(joint.parent == model::world_link ? world : joint.parent);
  for (std::uint32_t i = 0; i < lump.size(); ++i) lump[i] = root(i);
  return lump;
}

/// Joints other than fixed ones pass forces between bodies; a solver that works on their mass matrix loses as many
/// digits as their masses differ, and an iterative one needs about as many iterations as the ratio.
void check_ratios(const model::Model& model, const std::vector<std::uint32_t>& lump, Findings& findings) {
  const auto root = [&](std::uint32_t i) { return lump[i]; };
  std::vector<double> mass(lump.size(), 0);
  for (std::uint32_t i = 0; i < model.links.size(); ++i) mass[root(i)] += model.links[i].inertial.mass_kg;
  const std::uint32_t still = lump.back();  // what is fixed to the world has no mass that counts
  for (const model::Joint& joint : model.joints) {
    if (joint.type == model::JointType::fixed || joint.parent == model::world_link) continue;
    if (root(joint.parent) == still || root(joint.child) == still) continue;
    const double a = mass[root(joint.parent)], b = mass[root(joint.child)];
    const double ratio = std::max(a, b) / std::min(a, b);
    if (ratio > 1000)
      findings.add("mass_ratio",
                   "joint '" + joint.name + "' joins " + short_text(a) + " kg and " + short_text(b) +
                       " kg: the heavier is " + short_text(ratio) + " times the lighter",
                   "keep the ratio below 1000, or fix the small part to the large one", joint.place);
  }
}

}  // namespace

void check_inertia(const Simulation& simulation, Findings& findings) {
  std::set<const model::Model*> known;  // only asked, never walked through
  for (const model::Instance* instance : simulation.instances()) {
    const model::Model& model = *instance->model;
    if (model.is_static || instance->motion || !known.insert(&model).second) continue;
    const std::vector<std::uint32_t> lump = lumps_of(model);
    for (std::uint32_t i = 0; i < model.links.size(); ++i)
      if (lump[i] != lump.back()) check_link(model.links[i], findings);
    check_ratios(model, lump, findings);
  }
}

}  // namespace sandlot::lint_rules
