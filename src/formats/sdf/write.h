#pragma once
/// Writing SDF and URDF: XML trees as text, and worlds and models as trees.
///
/// Numbers are written so that they read back as the same double; rotations of SDF as quaternions, scaled where that is
/// needed for the reader's normalisation to give the same bits. What the SDF reader makes of the text is the Model that
/// was written, places aside.
///
/// Left out   what a format cannot express, with one warning each: controllers, seeds and engines of a
///            scenario in SDF; ball, universal and screw joints, loops and several roots in URDF are errors.
///            Meshes are named by their file; the scale of one is not known any more and written as 1, with a warning.
#include <string>

#include "files/xml.h"
#include "model/model.h"

namespace sandlot::formats {

/// The text of a document, indented by two blanks; `comment` stands at its head. Attributes and texts are escaped.
std::string xml_text(const Xml& root, const std::string& comment = "");

/// An <sdf> with one <world>.
/// Errors   a joint in a nested model that joins links outside of it.
Result<Xml> sdf_of(const model::Setup& setup, Diagnostics& diagnostics);
/// An <sdf> with one <model>.
Result<Xml> sdf_of(const model::Instance& instance, Diagnostics& diagnostics);

/// A <robot>. Link frames move to their parent joints, as URDF has it; places in the world are lost with a warning.
/// Devices become <gazebo> elements.
/// Errors   what is not a tree of fixed, revolute, continuous and prismatic joints with one root.
Result<Xml> urdf_of(const model::Instance& instance, Diagnostics& diagnostics);

}  // namespace sandlot::formats
