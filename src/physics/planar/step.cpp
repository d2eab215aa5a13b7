// How the planar engine moves: drives first, then walls, then discs among each other.
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

constexpr int wall_passes = 4, pair_passes = 8;
constexpr std::uint32_t no_wall = ~0u;

Area around(Vec2 a, Vec2 b, double r) {
  return {{std::min(a.x, b.x) - r, std::min(a.y, b.y) - r}, {std::max(a.x, b.x) + r, std::max(a.y, b.y) + r}};
}

double middle_of_common(Heights a, Heights b) {
  return 0.5 * (std::max(a.min_m, b.min_m) + std::min(a.max_m, b.max_m));
}

/// What is left of a commanded velocity of which a contact allowed only `actual`: never more, never backwards.
double hindered(double commanded, double actual) {
  return commanded > 0 ? std::clamp(actual, 0.0, commanded) : std::clamp(actual, commanded, 0.0);
}

}  // namespace

void PlanarEngine::step(double h_s, std::uint64_t) {
  if (!(h_s > 0)) return;
  refresh_walls();
  touches_.clear();
  start_.resize(bases_.size());
  unhindered_.resize(bases_.size());
  for (const std::uint32_t slot : order_) {
    if (!instances_[slot].moves) continue;
    Disc& disc = map_.discs()[slot];
    const Vec2 before = disc.centre;
    start_[slot] = bases_[slot].p;
    if (instances_[slot].guided) {
      lead(slot);
      continue;
    }
    drive(slot, h_s);
    unhindered_[slot] = bases_[slot].p + rotate(bases_[slot].heading, instances_[slot].offset);
    disc.centre = clear_of_walls(slot, before, unhindered_[slot]);
  }
  map_.file_discs();
  find_pairs();
  separate_pairs();
  for (const std::uint32_t slot : order_)
    if (instances_[slot].moves && !instances_[slot].guided) feel_contacts(slot, h_s);
  turn_joints(h_s);
  list_contacts();
  stale();
}

void PlanarEngine::drive(std::uint32_t slot, double h_s) {
  Base& base = bases_[slot];
  Drive& drive = drives_[slot];
  if (!drive.active) {
    base.v = {};
    base.w_radps = 0;
    return;
  }
  Vec2 turning{drive.now.w_radps, 0};
  Twist mean;
  mean.v_mps = ramp(drive.now.v_mps, drive.target.v_mps, drive.accel, h_s);
  mean.w_radps = ramp(turning, {drive.target.w_radps, 0}, drive.angular_accel, h_s).x;
  drive.now.w_radps = turning.x;
  // From the drive's frame to that of the canonical link: v_B = v_L - w x r_BL.
  const auto at_base = [&](Twist t) {
    return rotate(drive.frame, t.v_mps) + t.w_radps * Vec2{drive.arm.y, -drive.arm.x};
  };
  advance(base.p, base.heading, {at_base(mean), mean.w_radps}, h_s);
  base.v = rotate(base.heading, at_base(drive.now));
  base.w_radps = drive.now.w_radps;
}

/// Where a disc ends that moves from one place to another: pushed out of every wall it would enter.
Vec2 PlanarEngine::clear_of_walls(std::uint32_t slot, Vec2 from, Vec2 to) {
  const Disc& disc = map_.discs()[slot];
  if (!(disc.radius_m > 0)) return to;
  map_.walls_near(around(from, to, disc.radius_m), near_walls_);
  if (near_walls_.empty()) return to;
  // Strides of half a radius: the centre never gets to the far side of a wall, however thin.
  const Vec2 path = to - from;
  const double length = std::sqrt(dot(path, path)), longest = 0.5 * disc.radius_m;
  const int strides = length > longest ? static_cast<int>(std::min(std::ceil(length / longest), 1e4)) : 1;
  Vec2 centre = from;
  bool free = true;
  for (int i = 1; i <= strides; ++i) {
    // A disc that nothing hinders ends exactly where it was to go.
    centre = free && i == strides ? to : centre + (1.0 / strides) * path;
    for (int pass = 0; pass < wall_passes; ++pass)
      if (!push_out(slot, centre)) break;
      else free = false;
  }
  return centre;
}

/// One pass over the walls in `near_walls_`; true if any of them moved the disc.
bool PlanarEngine::push_out(std::uint32_t slot, Vec2& centre) {
  const Disc& disc = map_.discs()[slot];
  bool pushed = false;
  for (const std::uint32_t k : near_walls_) {
    const Wall& wall = map_.walls()[k];
    if (!meet(disc.heights, wall.outline.heights, spec_.clearance_m)) continue;
    const Vec2 out = centre - wall.outline.centre;
    const double reach = wall.outline.radius_m + disc.radius_m;
    if (!(dot(out, out) < reach * reach)) continue;
    const Nearest near = nearest(wall.outline, map_.edges(), centre);
    const double depth = disc.radius_m - near.distance_m;
    if (!(depth > 0)) continue;
    touch(slot, wall.instance, k, wall.body, centre - disc.radius_m * near.normal,
          middle_of_common(disc.heights, wall.outline.heights), near.normal, depth);
    centre = centre + depth * near.normal;
    pushed = true;
  }
  return pushed;
}

void PlanarEngine::find_pairs() {
  pairs_.clear();
  map_.for_pairs([&](std::uint32_t a, std::uint32_t b) {
    const Disc &x = map_.discs()[a], &y = map_.discs()[b];
    // Near ones too: a push within the step may make them touch.
    const double reach = x.radius_m + y.radius_m + 0.1 * std::min(x.radius_m, y.radius_m);
    const Vec2 d = y.centre - x.centre;
    if (!(dot(d, d) < reach * reach) || !meet(x.heights, y.heights, spec_.clearance_m)) return;
    if (instances_[a].created > instances_[b].created) std::swap(a, b);
    pairs_.push_back({instances_[a].created << 32 | (instances_[b].created & 0xffffffffu), a, b});
  });
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& x, const Pair& y) { return x.key < y.key; });
  pairs_.erase(
      std::unique(pairs_.begin(), pairs_.end(), [](const Pair& x, const Pair& y) { return x.key == y.key; }),
      pairs_.end());
}

/// Passes over all pairs in order of creation. A pass that moves nothing means that no later one would, so stopping
/// there changes nothing, for nobody.
void PlanarEngine::separate_pairs() {
  for (int pass = 0; pass < pair_passes; ++pass) {
    bool moved = false;
    for (const Pair& pair : pairs_) moved = separate(pair) || moved;
    if (!moved) return;
  }
}

bool PlanarEngine::separate(const Pair& pair) {
  Disc &a = map_.discs()[pair.a], &b = map_.discs()[pair.b];
  const auto overlap = [&](Vec2& normal) {
    const Vec2 d = b.centre - a.centre;
    const double distance = std::sqrt(dot(d, d));
    normal = distance > 0 ? (1 / distance) * d : Vec2{1, 0};
    return a.radius_m + b.radius_m - distance;
  };
  Vec2 n;
  const double depth = overlap(n);
  // Below rounding of the positions a push would only shuffle last bits from step to step.
  const double least = 1e-12 * (a.radius_m + b.radius_m);
  if (!(depth > least)) return false;
  touch(pair.b, pair.a, no_wall, a.body, a.centre + a.radius_m * n, middle_of_common(a.heights, b.heights), n,
        depth);
  const double wa = instances_[pair.a].inverse_mass_per_kg, wb = instances_[pair.b].inverse_mass_per_kg;
  if (wa + wb == 0) return false;  // two on their paths
  const double share = wa / (wa + wb);
  const Vec2 a_free = a.centre - (share * depth) * n, b_free = b.centre + ((1 - share) * depth) * n;
  if (wa > 0) a.centre = clear_of_walls(pair.a, a.centre, a_free);
  if (wb > 0) b.centre = clear_of_walls(pair.b, b.centre, b_free);
  // Where a wall holds one of them, the other gives way alone.
  const double rest = overlap(n);
  if (rest > least && wa > 0 && wb > 0) {
    if (!(b.centre == b_free)) a.centre = clear_of_walls(pair.a, a.centre, a.centre - rest * n);
    else if (!(a.centre == a_free)) b.centre = clear_of_walls(pair.b, b.centre, b.centre + rest * n);
  }
  return true;
}

/// Takes the disc's displacement over to its base, and the velocity that was lost from its drive.
void PlanarEngine::feel_contacts(std::uint32_t slot, double h_s) {
  const Vec2 push = map_.discs()[slot].centre - unhindered_[slot];
  if (push == Vec2{}) return;
  Base& base = bases_[slot];
  base.p = base.p + push;
  base.v = (1 / h_s) * (base.p - start_[slot]);
  Drive& drive = drives_[slot];
  if (!drive.active) return;
  const Vec2 arm_W = rotate(base.heading, drive.arm);
  const Vec2 v_L = base.v + base.w_radps * Vec2{-arm_W.y, arm_W.x};
  const Vec2 actual = rotate_back(base.heading * drive.frame, v_L);
  drive.now.v_mps = {hindered(drive.now.v_mps.x, actual.x), hindered(drive.now.v_mps.y, actual.y)};
}

void PlanarEngine::turn_joints(double h_s) {
  for (std::size_t k = 0; k < motors_.size(); ++k) {
    const Motor& motor = motors_[k];
    JointState& joint = joint_states_[k];
    joint.velocity = 0;
    if (!motor.active) continue;
    const double before = joint.position;
    const double velocity = std::clamp(motor.velocity, -motor.max_velocity, motor.max_velocity);
    const double goal = before + velocity * h_s;
    joint.position = std::clamp(goal, std::min(motor.lower, before), std::max(motor.upper, before));
    joint.velocity = joint.position == goal ? velocity : (joint.position - before) / h_s;
  }
}

void PlanarEngine::touch(std::uint32_t slot, std::uint32_t other, std::uint32_t wall,
                         std::uint32_t other_body, Vec2 point, double z_m, Vec2 from_other, double depth_m) {
  const std::uint64_t mine = instances_[slot].created, theirs = instances_[other].created;
  const BodyId me = body_id(map_.discs()[slot].body), them = body_id(other_body);
  const bool they_first = theirs < mine;
  const double sign = they_first ? 1 : -1;
  touches_.push_back({they_first ? theirs : mine,
                      they_first ? mine : theirs,
                      wall,
                      {they_first ? them : me,
                       they_first ? me : them,
                       {point.x, point.y, z_m},
                       {sign * from_other.x, sign * from_other.y, 0},
                       depth_m}});
}

/// One contact per pair of shapes, the deepest of those met on the way.
void PlanarEngine::list_contacts() {
  const auto same = [](const Touch& x, const Touch& y) {
    return x.first == y.first && x.second == y.second && x.wall == y.wall;
  };
  std::sort(touches_.begin(), touches_.end(), [](const Touch& x, const Touch& y) {
    if (x.first != y.first) return x.first < y.first;
    if (x.second != y.second) return x.second < y.second;
    if (x.wall != y.wall) return x.wall < y.wall;
    if (x.contact.depth_m != y.contact.depth_m) return x.contact.depth_m > y.contact.depth_m;
    if (x.contact.point_W.x != y.contact.point_W.x) return x.contact.point_W.x < y.contact.point_W.x;
    return x.contact.point_W.y < y.contact.point_W.y;
  });
  contacts_.clear();
  for (std::size_t i = 0; i < touches_.size(); ++i)
    if (i == 0 || !same(touches_[i - 1], touches_[i])) contacts_.push_back(touches_[i].contact);
}

}  // namespace sandlot::planar
