#pragma once
/// SDFormat worlds and models, versions 1.5 to 1.9 (newer ones with a warning), and URDF robots (formats/sdf/urdf.h).
///
/// Each file is taken through four checks: limits on the raw text, well-formedness (tinyxml2), names and references,
/// and each value as it is read; so every error has the line that caused it.
///
/// libsdformat is the reference in tests and bench, not the reader: it gives up a whole world for one unknown sensor,
/// has no line for most faults, complains on a process-wide console, retries every failure as URDF, computes
/// rotations with libm and takes a hundred times as long.
///
/// Frames   nested models are flattened: link `b` of nested model `a` is called `a::b`, placed in the top model.
/// Devices  sensors, model plugins and `<sandlot:device name= kind= link=>` become DeviceDecls. The `config` of the
///          former two is the element as Nodes: attributes as keys with a leading '@', repeated children as a list, the
///          text of an element with attributes as '#text'; of a sensor of a joint also '@joint'. That of a
///          sandlot:device are its children as keys, lists written `[1, 2]`.
/// Errors   one, with file and line; what is not used is named in one warning each, with its line.
/// Includes models, actors, lights and whole worlds, by everything that files/resources.h finds; merged by the proxy
///          frame rule of SDF 1.9. A path is relative to the file it stands in. A file that cannot be found is an
///          error, or with `skip_missing` a warning; a texture is a warning in any case.
/// Inertia  what has no <inertial>, or auto="true", is computed from the collisions, 1000 kg/m^3 unless a <density> says
///          otherwise; a mesh that is not closed counts as the box around it.
/// Names    a link and a joint may share one: where a frame is named, the link is meant. `::` in a name, as files that
///          flattened their nested models have it, is kept; the address is sanitised.
/// Numbers  limits, efforts, velocities, friction and ranges beyond all bounds (inf, 1e308) mean "none".
/// Actors   become moving instances; skin and animation are not drawn: without a link of its own an actor is a capsule of
///          0.25 m radius and 1.8 m height. Waypoints are relative to the actor's <pose>, as in Gazebo Sim.
/// Static   a nested model that is static in one that is not is fixed to the world, link by link.
/// Versions 1.2 to 1.4 are read as 1.5 (a warning); of 1.10 to 1.12 auto inertia, densities, cones, the optimization of
///          meshes, screw_thread_pitch, <mimic> and joints of the world are understood (a warning).
/// Limits   gearboxes are left out, joints between two models of the world refused. Not used, with a warning: <wind>,
///          <gripper>, torsional friction, bit masks, added mass, texture blending of heightmaps, plugins of links.
///          Materials are reduced to colours and one colour texture; material scripts to Gazebo Classic's own colours.
#include <string>
#include <string_view>
#include <vector>

#include "files/xml.h"
#include "formats/content.h"

namespace sandlot::formats {

struct SdfOptions {
  XmlLimits limits;
  SearchPath path = search_path();
  bool skip_missing = false;  ///< missing files are left out with a warning, not an error
};

Result<WorldContent> read_sdf(const std::string& path, Diagnostics& diagnostics,
                              const SdfOptions& options = {});
/// As above from text; `file` names it in messages.
Result<WorldContent> parse_sdf(std::string_view text, const std::string& file, Diagnostics& diagnostics,
                               const SdfOptions& options = {});

}  // namespace sandlot::formats
