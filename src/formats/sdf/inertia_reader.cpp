#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/text.h"
#include "formats/sdf/reading.h"
#include "geometry/mesh.h"

namespace sandlot::formats {
namespace {

constexpr Range mass_range{0, 1e8, true};
constexpr Range moment_range{-1e12, 1e12};

/// Files round their moments: a flat plate's largest is the sum of the others, up to the last digit written.
constexpr double triangle_slack = 0.01;

Eigen::Matrix3d tensor_of(Vec3 d, Vec3 p) {
  Eigen::Matrix3d out;
  out << d.x, p.x, p.y, p.x, d.y, p.z, p.y, p.z, d.z;
  return out;
}

Status check_inertia(const Xml& inertia, const model::Inertial& inertial) {
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                      tensor_of(inertial.moments, inertial.products), Eigen::EigenvaluesOnly)
                                      .eigenvalues();
  const std::string shown = number_text(moments[0]) + ", " + number_text(moments[1]) + ", " +
                            number_text(moments[2]);
  if (!(moments[0] > 0))
    return inertia.error("inertia is not physical: its principal moments are " + shown,
                         "all must be above 0");
  if (moments[0] + moments[1] < moments[2] * (1 - triangle_slack))
    return inertia.error("inertia is not physical: its principal moments are " + shown,
                         "no body has one that is larger than the sum of the others");
  return {};
}

/// The tensor about a point `c` away from the centre of mass of a body of unit mass, less that about the centre.
Eigen::Matrix3d steiner(Vec3 c) {
  const Eigen::Vector3d v(c.x, c.y, c.z);
  return v.squaredNorm() * Eigen::Matrix3d::Identity() - v * v.transpose();
}

/// A surface with holes encloses no volume: the box around it stands for it.
MassProperties solid_of(const Shape& shape) {
  const auto* const mesh = std::get_if<Mesh>(&shape);
  if (!mesh || is_closed(*mesh->mesh) || mesh->mesh->vertices.empty()) return mass_properties(shape);
  Vec3 low = mesh->mesh->vertices.front(), high = low;
  for (const Vec3& v : mesh->mesh->vertices)
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], v[i]);
      high[i] = std::max(high[i], v[i]);
    }
  MassProperties out = mass_properties(Shape{Box{high - low}});
  out.centre_m = 0.5 * (low + high);
  return out;
}

/// Of all collisions together, each of its own density. Nothing when they have no volume.
std::optional<model::Inertial> solid(const model::Link& link, const std::vector<double>& densities) {
  struct Part {
    double mass;
    Vec3 centre;
    Eigen::Matrix3d about_centre;
  };
  std::vector<Part> parts;
  double mass = 0;
  Vec3 centre;
  for (std::size_t i = 0; i < link.collisions.size(); ++i) {
    const model::Collision& collision = link.collisions[i];
    const MassProperties own = solid_of(collision.shape);
    const double m = densities[i] * std::abs(own.volume_m3);
    if (!(m > 0) || !std::isfinite(m)) continue;
    const Quat q = collision.X_LC.q;
    const Eigen::Matrix3d R = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
    const Vec3 c = collision.X_LC * own.centre_m;
    parts.push_back({m, c, m * R * tensor_of(own.moments, own.products) * R.transpose()});
    mass += m;
    centre += m * c;
  }
  if (!(mass > 0 && mass <= mass_range.max)) return {};
  model::Inertial out;
  out.mass_kg = mass;
  out.X_LCo.p = centre / mass;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Part& part : parts) sum += part.about_centre + part.mass * steiner(part.centre - out.X_LCo.p);
  out.moments = {sum(0, 0), sum(1, 1), sum(2, 2)};
  out.products = {sum(0, 1), sum(0, 2), sum(1, 2)};
  if (!(out.moments.x > 0 && out.moments.y > 0 && out.moments.z > 0) || !is_finite(out.moments)) return {};
  return out;
}

}  // namespace

Result<model::Inertial> read_inertial(const Xml& element, const model::Link& link,
                                      const std::vector<double>& densities_kgpm3, bool is_static,
                                      const Reading& in) {
  model::Inertial out;
  const Xml* const inertial = element.child("inertial");
  const std::string* const automatic = inertial ? inertial->attribute("auto") : nullptr;
  const bool computed = automatic && (*automatic == "true" || *automatic == "1");
  const std::string said = "link '" + link.name + "'";
  const auto warn = [&](const Xml& at, const std::string& what, std::string standing_in) {
    if (!is_static) in.notes.warn(at, said + what, std::move(standing_in), "inertia" + what);
  };
  if (!inertial || computed) {
    if (inertial) in.notes.unused(*inertial, "density", "mass pose inertia");
    if (auto whole = solid(link, densities_kgpm3)) {
      if (!inertial)
        warn(element, " has no <inertial>",
             "taken as solid, of the density of water: " + number_text(whole->mass_kg) + " kg");
      return *whole;
    }
    warn(element, computed ? " has no collision to compute its inertia from" : " has no <inertial>",
         "taken as 1 kg with moments of 1 kg m^2");
    return out;
  }
  in.notes.unused(*inertial, "mass pose inertia", "frame density fluid_added_mass");
  SL_TRY(read_child(*inertial, "mass", mass_range, out.mass_kg));
  SL_ASSIGN(out.X_LCo, read_child_pose(*inertial));
  if (const Xml* const added = inertial->child("fluid_added_mass"))
    in.notes.warn(*added, "<fluid_added_mass> is not used", "there is no water here");
  const Xml* const inertia = inertial->child("inertia");
  if (!inertia) {
    warn(*inertial, " has no <inertia>", "its moments are taken as 1 kg m^2");
    return out;
  }
  in.notes.unused(*inertia, "ixx ixy ixz iyy iyz izz");
  SL_TRY(read_child(*inertia, "ixx", moment_range, out.moments.x));
  SL_TRY(read_child(*inertia, "iyy", moment_range, out.moments.y));
  SL_TRY(read_child(*inertia, "izz", moment_range, out.moments.z));
  SL_TRY(read_child(*inertia, "ixy", moment_range, out.products.x));
  SL_TRY(read_child(*inertia, "ixz", moment_range, out.products.y));
  SL_TRY(read_child(*inertia, "iyz", moment_range, out.products.z));
  if (!is_static) SL_TRY(check_inertia(*inertia, out));
  return out;
}

}  // namespace sandlot::formats
