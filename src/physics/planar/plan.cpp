#include "physics/planar/plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/mesh.h"
#include "kinematics/tree.h"

namespace sandlot::planar {
namespace {

using kinematics::KinematicTree;
using model::JointType;
using Branch = KinematicTree::Branch;
constexpr std::uint32_t no_link = KinematicTree::none;
/// Shapes that reach this near to the lowest point stand on the ground.
constexpr double ground_tolerance_m = 5e-4;

Vec2 flat_on_plane(Vec3 v) { return {v.x, v.y}; }
double length(Vec2 v) { return std::sqrt(dot(v, v)); }
double cross_of(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

/// Moment of inertia of a link about an axis (unit, in L) through its centre of mass.
double inertia_about(const model::Inertial& inertial, Vec3 axis_L) {
  const Vec3 a = rotate_inverse(inertial.X_LCo.q, axis_L), m = inertial.moments, p = inertial.products;
  return m.x * a.x * a.x + m.y * a.y * a.y + m.z * a.z * a.z +
         2 * (p.x * a.x * a.y + p.y * a.x * a.z + p.z * a.y * a.z);
}

struct Builder {
  const model::Model& model;
  Plan plan;
  KinematicTree tree;
  std::vector<bool> below_wheel;  ///< by link: a wheel, or a link that a wheel carries

  Vec3 axis_H(const model::Joint& j) const {
    return rotate(plan.X_HL[j.child].q, rotate(j.X_CJ.q, j.axis_J));
  }
  Vec3 origin_H(const model::Joint& j) const { return plan.X_HL[j.child] * j.X_CJ.p; }

  void find_bottom() {
    double bottom = std::numeric_limits<double>::infinity();
    for (std::size_t l = 0; l < model.links.size(); ++l)
      for (const model::Collision& c : model.links[l].collisions)
        if (const Heights h = heights_of(c.shape, plan.X_HL[l] * c.X_LC); !h.empty())
          bottom = std::min(bottom, h.min_m);
    for (const model::Joint& j : model.joints)
      if (j.rollers) bottom = std::min(bottom, origin_H(j).z - j.rollers->radius_m);
    plan.bottom_m = std::isfinite(bottom) ? bottom : 0;
  }

  /// Radius and surface of the round shape with which a link rolls about this joint's axis; 0: it does not.
  double tyre(const model::Joint& j, const model::Surface*& surface,
              const model::Collision** collision = nullptr) const {
    const Vec3 axis = axis_H(j), origin = origin_H(j);
    if (std::abs(axis.z) > 0.05) return 0;
    const auto reaches = [&](double radius) {
      return std::abs(origin.z - radius - plan.bottom_m) < ground_tolerance_m;
    };
    if (j.rollers) {
      surface = &j.rollers->surface;
      return reaches(j.rollers->radius_m) ? j.rollers->radius_m : 0;
    }
    for (const model::Collision& c : model.links[j.child].collisions) {
      const Pose X = plan.X_HL[j.child] * c.X_LC;
      const Vec3 off = X.p - origin, aside = off - dot(off, axis) * axis;
      if (norm(aside) > 1e-3) continue;
      const bool along = std::abs(dot(rotate(X.q, {0, 0, 1}), axis)) > 0.999;
      double radius = 0;
      if (const auto* ball = std::get_if<Sphere>(&c.shape)) radius = ball->radius_m;
      else if (const auto* can = std::get_if<Cylinder>(&c.shape); can && along) radius = can->radius_m;
      else if (const auto* pill = std::get_if<Capsule>(&c.shape); pill && along) radius = pill->radius_m;
      if (!(radius > 0) || !reaches(radius)) continue;
      surface = &c.surface;
      if (collision) *collision = &c;
      return radius;
    }
    return 0;
  }

  /// True when one wheel hangs on branch `b`, with its rollers and a fork of links that nothing can touch.
  bool carries_a_wheel(std::size_t b) const {
    std::vector<bool> beyond(model.links.size(), false), wheel(model.links.size(), false);
    beyond[tree.branches[b].link] = true;
    int wheels = 0;
    for (std::size_t k = b; k < tree.branches.size(); ++k) {
      const Branch& each = tree.branches[k];
      if (k != b && (each.parent == no_link || !beyond[each.parent])) continue;
      beyond[each.link] = true;
      wheel[each.link] = k != b && wheel[each.parent];
      if (wheel[each.link]) continue;
      const model::Surface* surface = nullptr;
      if (k != b && each.joint != no_link && turns(model.joints[each.joint]) && each.outwards &&
          tyre(model.joints[each.joint], surface) > 0) {
        wheel[each.link] = true;
        ++wheels;
      } else if (!model.links[each.link].collisions.empty()) {
        return false;
      }
    }
    return wheels == 1;
  }
  static bool turns(const model::Joint& j) {
    return j.type == JointType::revolute || j.type == JointType::continuous;
  }

  void sort_joints() {
    plan.group_of_link.assign(model.links.size(), 0);
    below_wheel.assign(model.links.size(), false);
    plan.groups.emplace_back();
    std::vector<std::uint32_t> steering(model.links.size(), model::Joint::no_joint);
    for (std::size_t b = 1; b < tree.branches.size(); ++b) {
      const Branch& branch = tree.branches[b];
      std::uint32_t& group = plan.group_of_link[branch.link];
      group = branch.parent == no_link ? 0 : plan.group_of_link[branch.parent];
      if (branch.parent != no_link) {
        steering[branch.link] = steering[branch.parent];
        below_wheel[branch.link] = below_wheel[branch.parent];
      }
      if (branch.joint == no_link) continue;
      const model::Joint& j = model.joints[branch.joint];
      if (below_wheel[branch.link] || j.mimic) continue;
      const Vec3 axis = axis_H(j);
      const model::Surface* surface = nullptr;
      const double sign = branch.outwards ? 1 : -1;
      if (turns(j) && branch.outwards) {
        const model::Collision* collision = nullptr;
        if (const double radius = tyre(j, surface, &collision); radius > 0) {
          below_wheel[branch.link] = true;
          add_wheel(branch.joint, group, steering[branch.link], radius, surface);
          plan.wheels.back().collision = collision;
          plan.plain = plan.plain && is_plain(*surface);
          continue;
        }
      }
      if (turns(j) && std::abs(axis.z) > 0.999) {
        const double up = axis.z > 0 ? 1 : -1;
        if (branch.outwards && carries_a_wheel(b)) {
          steering[branch.link] = branch.joint;
          plan.constraints.push_back(
              {JointPlan::Kind::steering, branch.joint, group, group, flat_on_plane(origin_H(j)), {}, up, 0});
          continue;
        }
        part(b, JointPlan::Kind::pivot, group, {}, sign * up);
      } else if (j.type == JointType::prismatic && std::abs(axis.z) < 0.05) {
        const Vec2 a = flat_on_plane(axis);
        part(b, JointPlan::Kind::slider, group, (sign / length(a)) * a, 1);
      }
    }
  }

  void part(std::size_t b, JointPlan::Kind kind, std::uint32_t& group, Vec2 axis, double sign) {
    if (plan.groups.size() >= 255) return;
    const auto child = static_cast<std::uint32_t>(plan.groups.size());
    plan.constraints.push_back({kind, tree.branches[b].joint, group, child,
                                flat_on_plane(origin_H(model.joints[tree.branches[b].joint])), axis, sign,
                                0});
    plan.groups.emplace_back().root = tree.branches[b].link;
    group = child;
  }

  void add_wheel(std::uint32_t joint, std::uint32_t group, std::uint32_t steering, double radius,
                 const model::Surface* surface) {
    const model::Joint& j = model.joints[joint];
    WheelPlan wheel{.joint = joint, .group = group, .steering = steering};
    const Vec3 axis = axis_H(j);
    wheel.axle = (1 / length(flat_on_plane(axis))) * flat_on_plane(axis);
    wheel.at = flat_on_plane(origin_H(j));
    wheel.radius_m = radius;
    wheel.surface = surface;
    const model::Link& link = model.links[j.child];
    const Vec3 arm = plan.X_HL[j.child] * link.inertial.X_LCo.p - origin_H(j),
               aside = arm - dot(arm, axis) * axis;
    wheel.inertia_kgm2 = inertia_about(link.inertial, rotate_inverse(plan.X_HL[j.child].q, axis)) +
                         link.inertial.mass_kg * dot(aside, aside);
    if (j.rollers) {
      const model::RollerWheel& r = *j.rollers;
      const double out = r.radius_m - r.roller_radius_m;
      wheel.inertia_kgm2 += r.count * r.rows * r.roller_mass_kg * out * out;
      wheel.rollers = true;
      wheel.bearing_Nm = r.bearing_friction_Nm;
      // About the outward radius, which at the ground points down.
      const auto [s, c] = math::sincos(r.angle_rad);
      wheel.grip = {c * wheel.axle.x + s * wheel.axle.y, c * wheel.axle.y - s * wheel.axle.x};
    }
    plan.wheels.push_back(wheel);
  }

  void weigh() {
    for (std::size_t l = 0; l < model.links.size(); ++l) {
      RigidGroupPlan& group = plan.groups[plan.group_of_link[l]];
      const model::Inertial& i = model.links[l].inertial;
      const double before = group.mass_kg;
      const Vec2 com = flat_on_plane(plan.X_HL[l] * i.X_LCo.p);
      const double own = inertia_about(i, rotate_inverse(plan.X_HL[l].q, {0, 0, 1}));
      if (!(i.mass_kg > 0)) continue;
      group.mass_kg += i.mass_kg;
      const Vec2 apart = com - group.com_H;
      group.inertia_kgm2 += own + before * i.mass_kg / group.mass_kg * dot(apart, apart);
      group.com_H = group.com_H + (i.mass_kg / group.mass_kg) * apart;
    }
    for (RigidGroupPlan& group : plan.groups) {
      if (!(group.mass_kg > 0)) group.mass_kg = 1e-9, group.com_H = flat_on_plane(plan.X_HL[group.root].p);
      if (!(group.inertia_kgm2 > 1e-12 * group.mass_kg)) group.inertia_kgm2 = 1e-12 * group.mass_kg;
    }
    for (JointPlan& constraint : plan.constraints) {
      if (constraint.kind != JointPlan::Kind::steering) continue;
      for (std::size_t b = 1; b < tree.branches.size(); ++b) {
        bool beyond = false;
        for (std::size_t at = b; tree.branches[at].parent != no_link && !beyond;
             at = tree.branch_of[tree.branches[at].parent])
          beyond = tree.branches[at].joint == constraint.joint;
        if (!beyond) continue;
        const model::Inertial& i = model.links[tree.branches[b].link].inertial;
        const Vec2 arm = flat_on_plane(plan.X_HL[tree.branches[b].link] * i.X_LCo.p) - constraint.at_H;
        constraint.inertia_kgm2 += inertia_about(
                                       i, rotate_inverse(plan.X_HL[tree.branches[b].link].q, {0, 0, 1})) +
                                   i.mass_kg * dot(arm, arm);
      }
      constraint.inertia_kgm2 = std::max(constraint.inertia_kgm2, 1e-9);
    }
  }

  void outline(std::uint32_t index) {
    RigidGroupPlan& group = plan.groups[index];
    std::vector<Outline> outlines;
    std::vector<Vec3> corners;
    for (std::uint32_t l = 0; l < model.links.size(); ++l) {
      if (plan.group_of_link[l] != index) continue;
      const model::Link& link = model.links[l];
      for (std::uint32_t c = 0; c < link.collisions.size(); ++c) {
        const model::Collision& collision = link.collisions[c];
        Pose X = plan.X_HL[l] * collision.X_LC;
        X.p -= Vec3{group.com_H.x, group.com_H.y, 0};
        outlines.clear();
        Shape shape = collision.shape;
        if (const auto* mesh = std::get_if<Mesh>(&shape)) {
          add_hull(*mesh->mesh, X, outlines, group.edges);
        } else {
          add_outlines(shape, X, outlines, group.edges);
        }
        for (const Outline& o : outlines) group.parts.push_back({o, l, c, &collision.surface});
        stand(group, collision, X, l);
      }
    }
    for (const WheelPlan& wheel : plan.wheels) {
      const model::Joint& j = model.joints[wheel.joint];
      if (wheel.group != index || !j.rollers) continue;
      // The rollers as the cylinder around them.
      const double width = (j.rollers->rows - 1) * j.rollers->row_spacing_m + 2 * j.rollers->roller_radius_m;
      const Vec2 ahead{wheel.axle.y, -wheel.axle.x}, at = wheel.at - group.com_H;
      const double z = origin_H(j).z;
      const Quat q = quat_from_rpy(0, 0, math::atan2(ahead.y, ahead.x));
      outlines.clear();
      add_outlines(Box{{2 * wheel.radius_m, width, 2 * wheel.radius_m}}, {{at.x, at.y, z}, q}, outlines,
                   group.edges);
      for (const Outline& o : outlines) group.parts.push_back({o, j.child, ~0u, wheel.surface});
    }
    merge(group);
    enclose(group);
  }

  static void add_hull(const TriangleMesh& mesh, const Pose& X, std::vector<Outline>& outlines,
                       std::vector<Edge>& edges) {
    std::vector<Vec2> points;
    Heights heights;
    for (const Vec3& v : mesh.vertices) {
      const Vec3 p = X * v;
      points.push_back({p.x, p.y});
      heights.add({p.z, p.z});
    }
    if (!points.empty()) add_polygon(std::move(points), heights, outlines, edges);
  }

  /// Notes what a shape stands on, unless it is part of a wheel.
  void stand(RigidGroupPlan& group, const model::Collision& collision, const Pose& X, std::uint32_t link) {
    if (below_wheel[link] || !collision.surface.touches) return;
    const Heights h = heights_of(collision.shape, X);
    if (h.empty() || h.min_m > plan.bottom_m + ground_tolerance_m) return;
    Support s{.at = {X.p.x, X.p.y}, .surface = &collision.surface, .collision = &collision, .link = link};
    plan.plain = plan.plain && is_plain(collision.surface);
    const Vec3 axis = rotate(X.q, {0, 0, 1});
    if (const auto* ball = std::get_if<Sphere>(&collision.shape)) {
      s.ball_radius_m = ball->radius_m;
    } else if (const auto* can = std::get_if<Cylinder>(&collision.shape); can && std::abs(axis.z) > 0.999) {
      s.mean_radius_m = 2.0 / 3 * can->radius_m;
      s.mean_distance_m = mean_distance(s.at, can->radius_m);
      group.supports.push_back(s);
      return;
    } else {
      // The corners that reach the ground, or the whole shadow where none does.
      std::vector<Outline> outlines;
      std::vector<Edge> edges;
      if (const auto* mesh = std::get_if<Mesh>(&collision.shape)) add_hull(*mesh->mesh, X, outlines, edges);
      else add_outlines(collision.shape, X, outlines, edges);
      if (!outlines.empty() && outlines.back().edge_count > 0) {
        const auto [centre, about_centre, about_com] = means(outlines.back(), edges);
        s.at = centre;
        s.mean_radius_m = about_centre;
        s.mean_distance_m = about_com;
        group.supports.push_back(s);
        return;
      }
    }
    s.mean_distance_m = length(s.at);
    group.supports.push_back(s);
  }

  /// Mean distance of a disc's points from the origin: rings of equal area and width.
  static double mean_distance(Vec2 at, double radius) {
    if (dot(at, at) < 1e-12 * radius * radius) return 2.0 / 3 * radius;
    double sum = 0;
    constexpr int rings = 8, rays = 16;
    for (int r = 0; r < rings; ++r)
      for (int a = 0; a < rays; ++a) {
        const auto [s, c] = math::sincos(math::tau * (a + 0.5) / rays);
        const double out = radius * std::sqrt((r + 0.5) / rings);
        sum += length(at + out * Vec2{c, s});
      }
    return sum / (rings * rays);
  }

  /// Centroid of a polygon, and the mean distances of its points from there and from the origin, by triangles
  /// cut into small ones.
  struct Means {
    Vec2 centroid;
    double about_centroid, about_origin;
  };
  static Means means(const Outline& o, std::span<const Edge> edges) {
    double area = 0;
    Vec2 centroid;
    const auto each = [&](auto&& visit) {
      const Vec2 a = edges[o.first_edge].from;
      for (std::uint32_t i = 1; i + 1 < o.edge_count; ++i)
        visit(a, edges[o.first_edge + i].from, edges[o.first_edge + i + 1].from);
    };
    each([&](Vec2 a, Vec2 b, Vec2 c) {
      const double twice = cross_of(b - a, c - a);
      area += twice;
      centroid = centroid + (twice / 3) * (a + b + c);
    });
    centroid = (1 / area) * centroid;
    double near = 0, far = 0;
    each([&](Vec2 a, Vec2 b, Vec2 c) {
      constexpr int n = 24;
      const double part = cross_of(b - a, c - a) / (n * n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j)
          for (int k = 0; k < (j < n - i - 1 ? 2 : 1); ++k) {
            const double u = (i + (k ? 2.0 : 1.0) / 3) / n, v = (j + (k ? 2.0 : 1.0) / 3) / n;
            const Vec2 p = a + u * (b - a) + v * (c - a);
            near += part * length(p - centroid);
            far += part * length(p);
          }
    });
    return {centroid, near / area, far / area};
  }

  /// Whether the circle hides all of `o` from above.
  static bool hides(const Outline& circle, const Outline& o, std::span<const Edge> edges) {
    const double most = circle.radius_m * (1 + 1e-9);
    if (o.edge_count == 0) return length(o.centre - circle.centre) + o.radius_m <= most;
    for (std::uint32_t i = 0; i < o.edge_count; ++i)
      if (length(edges[o.first_edge + i].from - circle.centre) > most) return false;
    return true;
  }

  static void merge(RigidGroupPlan& group) {
    std::uint32_t widest = no_link;
    for (std::uint32_t i = 0; i < group.parts.size(); ++i) {
      const Outline& o = group.parts[i].outline;
      if (o.edge_count == 0 && (widest == no_link || o.radius_m > group.parts[widest].outline.radius_m))
        widest = i;
    }
    if (widest == no_link) return;
    Part main = group.parts[widest];
    const Heights own = main.outline.heights;
    const double thick = own.max_m - own.min_m;
    std::vector<Part> rest;
    std::vector<Edge> edges;
    for (std::uint32_t i = 0; i < group.parts.size(); ++i) {
      Part part = group.parts[i];
      if (i == widest) continue;
      const Heights h = part.outline.heights;
      if (part.surface->touches == main.surface->touches && h.min_m >= own.min_m - thick &&
          h.max_m <= own.max_m + 2 * thick && hides(main.outline, part.outline, group.edges)) {
        main.outline.heights.add(h);
        main.collision = ~0u;
        continue;
      }
      const auto from = group.edges.begin() + part.outline.first_edge;
      part.outline.first_edge = static_cast<std::uint32_t>(edges.size());
      edges.insert(edges.end(), from, from + part.outline.edge_count);
      rest.push_back(part);
    }
    rest.insert(rest.begin(), main);
    group.parts = std::move(rest);
    group.edges = std::move(edges);
  }

  static void enclose(RigidGroupPlan& group) {
    std::erase_if(group.parts, [](const Part& p) { return !p.surface->touches; });
    if (group.parts.empty()) return;
    Vec2 low = group.parts[0].outline.centre, high = low;
    group.core_m = std::numeric_limits<double>::infinity();
    const auto each = [&](auto&& visit) {
      for (const Part& part : group.parts) {
        if (part.outline.edge_count == 0) visit(part.outline.centre, part.outline.radius_m);
        for (std::uint32_t i = 0; i < part.outline.edge_count; ++i)
          visit(group.edges[part.outline.first_edge + i].from, 0.0);
      }
    };
    each([&](Vec2 p, double r) {
      low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r)};
      high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r)};
    });
    group.centre = 0.5 * (low + high);
    if (group.parts.size() == 1 && group.parts[0].outline.edge_count == 0)
      group.centre = group.parts[0].outline.centre;
    each([&](Vec2 p, double r) { group.radius_m = std::max(group.radius_m, length(p - group.centre) + r); });
    for (const Part& part : group.parts) {
      group.heights.add(part.outline.heights);
      double inscribed = part.outline.radius_m;
      if (part.outline.edge_count > 0)
        inscribed = -nearest(part.outline, group.edges, part.outline.centre).distance_m;
      group.core_m = std::min(group.core_m, std::max(inscribed, 1e-4));
    }
    group.disc = group.parts.size() == 1 && group.parts[0].outline.edge_count == 0;
    if (group.radius_m > 0) group.reach_share_m = std::min(0.1 * group.radius_m, 0.5 * group.core_m) + 1e-4;
  }

  /// Every group carries itself; one without supports is carried by its parent.
  void share() {
    std::vector<double> mass(plan.groups.size());
    std::vector<Vec2> com(plan.groups.size());
    for (std::size_t i = 0; i < mass.size(); ++i)
      mass[i] = plan.groups[i].mass_kg, com[i] = plan.groups[i].com_H;
    const auto stands = [&](std::uint32_t i) {
      return !plan.groups[i].supports.empty() ||
             std::any_of(plan.wheels.begin(), plan.wheels.end(),
                         [&](const WheelPlan& w) { return w.group == i; });
    };
    const auto carry = [&](std::uint32_t from, std::uint32_t to) {
      const double sum = mass[from] + mass[to];
      com[to] = (1 / sum) * (mass[from] * com[from] + mass[to] * com[to]);
      mass[to] = sum;
      mass[from] = 0;
    };
    for (std::size_t k = plan.constraints.size(); k-- > 0;) {
      const JointPlan& l = plan.constraints[k];
      if (l.kind != JointPlan::Kind::steering && !stands(l.child)) carry(l.child, l.parent);
    }
    for (std::uint32_t i = 0; i < plan.groups.size(); ++i) {
      RigidGroupPlan& group = plan.groups[i];
      std::vector<Vec2> points;
      for (const Support& s : group.supports) points.push_back(s.at + group.com_H - com[i]);
      for (const WheelPlan& w : plan.wheels)
        if (w.group == i) points.push_back(w.at - com[i]);
      std::vector<double> shares(points.size());
      share_weight(mass[i], points, shares);
      std::size_t next = 0;
      for (Support& s : group.supports) s.weight_kg = shares[next++];
      for (WheelPlan& w : plan.wheels)
        if (w.group == i) {
          w.weight_kg = shares[next++];
          w.at = w.at - group.com_H;
        }
      group.rolls = group.supports.size() == 1 && points.size() == 1 && group.supports[0].ball_radius_m > 0;
    }
    for (WheelPlan& w : plan.wheels)
      for (const JointPlan& l : plan.constraints)
        if (w.steering == l.joint) {
          w.steering_at = l.at_H - plan.groups[w.group].com_H;
          w.steering_sign = l.sign;
          w.steering_kgm2 = l.inertia_kgm2;
        }
  }
};

}  // namespace

void share_weight(double weight_kg, std::span<const Vec2> points, std::span<double> shares) {
  std::vector<bool> used(points.size(), true);
  for (std::size_t round = 0; round < points.size(); ++round) {
    // N_i = a + b x_i + c y_i, from sums over the points; a little regularised, because they may lie on a
    // line.
    double n = 0, sx = 0, sy = 0, xx = 0, xy = 0, yy = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!used[i]) continue;
      const Vec2 p = points[i];
      n += 1, sx += p.x, sy += p.y, xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
    }
    const double small = 1e-9 * (xx + yy) + 1e-12;
    xx += small, yy += small;
    const double cx = xx - sx * sx / n, cxy = xy - sx * sy / n, cy = yy - sy * sy / n;
    const double det = cx * cy - cxy * cxy;
    // From n a + sx b + sy c = weight and both moments 0.
    const double rx = -sx * weight_kg / n, ry = -sy * weight_kg / n;
    const double b = (rx * cy - ry * cxy) / det, c = (ry * cx - rx * cxy) / det;
    const double a = (weight_kg - sx * b - sy * c) / n;
    double lowest = -1e-9 * weight_kg;
    std::size_t pulls = points.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      shares[i] = used[i] ? a + b * points[i].x + c * points[i].y : 0;
      if (shares[i] < lowest) lowest = shares[i], pulls = i;
    }
    if (pulls == points.size() || n <= 1) break;
    used[pulls] = false;
  }
  double sum = 0;
  for (double& s : shares) sum += s = std::max(s, 0.0);
  for (double& s : shares) s = sum > 0 ? s * weight_kg / sum : weight_kg / static_cast<double>(shares.size());
}

Plan make_plan(const model::Model& model, Quat tilt, double z_m) {
  Builder b{.model = model, .plan = {}, .tree = kinematics::spanning_tree(model), .below_wheel = {}};
  const Pose X_HM = Pose{{0, 0, z_m}, tilt} * inverse(model.links[0].X_ML);
  for (const model::Link& link : model.links) b.plan.X_HL.push_back(X_HM * link.X_ML);
  b.find_bottom();
  b.sort_joints();
  b.weigh();
  for (std::uint32_t i = 0; i < b.plan.groups.size(); ++i) b.outline(i);
  b.share();
  return std::move(b.plan);
}

}  // namespace sandlot::planar
