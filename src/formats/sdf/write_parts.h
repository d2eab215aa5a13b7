#pragma once
/// Shared parts of the writers of SDF and URDF; for formats/sdf/write*.cpp only.
#include <optional>
#include <string>

#include "files/xml.h"
#include "model/model.h"

namespace sandlot::formats::writing {

inline constexpr double unlimited = 1e16;

Xml element(std::string name, std::string text = "");
Xml& add(Xml& parent, Xml child);
Xml& add(Xml& parent, std::string name, std::string text = "");
void add_number(Xml& parent, std::string name, double x);

std::string text_of(Vec3 v);
std::string text_of(const Color& color);
/// A vector that normalised() takes to exactly `unit` (or as near as any).
std::string direction_text(Vec3 unit);
/// Adds a <pose> of SDF unless it is the identity.
void add_pose(Xml& parent, const Pose& X);

/// The <surface> of a collision; nothing when all is as by default.
std::optional<Xml> surface_of(const model::Surface& surface);
/// The shape as SDF's <geometry> has it.
Xml geometry_of(const Shape& shape, const std::string& owner, const Place& place, Diagnostics& diagnostics);
std::optional<Xml> material_of(const model::Material& material);
Xml light_of(const model::Light& light);
/// Limits of infinity are left out.
Xml safety_of(const model::SafetyLimits& limits);
Xml rollers_of(const model::RollerWheel& wheel);
Xml inertial_of(const model::Inertial& inertial);

/// A declared device: <sandlot:device>, or the <sensor> or <plugin> it was read from.
/// @param X_pose  where it stands in the element that it is put into
Xml device_of(const model::DeviceDecl& device, const Pose& X_pose);
inline bool is_native(const model::DeviceDecl& device) { return !device.kind.empty(); }
bool is_sensor(const model::DeviceDecl& device);
/// Name of the joint that a sensor was declared in; "" for those of links.
std::string joint_of(const model::DeviceDecl& device);

}  // namespace sandlot::formats::writing
