/// SDF and URDF are two formats with one reader: URDF is translated into a tree of SDF.
#include "formats/kind.h"
#include "formats/sdf/document.h"
#include "formats/sdf/sdf.h"
#include "formats/sdf/write.h"

namespace sandlot::formats {
namespace {

SdfOptions sdf_options(const ReadOptions& options) {
  return {.limits = {}, .path = options.path, .skip_missing = options.skip_missing};
}

Result<WorldContent> read_content(std::string_view text, const std::string& file, const ReadOptions& options,
                                  Diagnostics& diagnostics) {
  return parse_sdf(text, file, diagnostics, sdf_options(options));
}

Result<Xml> read_tree(std::string_view text, const std::string& file, const ReadOptions& options,
                      Diagnostics& diagnostics) {
  Notes notes(diagnostics);
  return load_document(text, file, notes, sdf_options(options));
}

constexpr std::string_view sdf_extensions[] = {".sdf", ".world"};
constexpr std::string_view urdf_extensions[] = {".urdf", ".xacro"};

}  // namespace

extern const FormatKind sdf_format, urdf_format;

constinit const FormatKind sdf_format{
    .name = "sdf",
    .help = "Worlds and models of Gazebo: SDFormat 1.2 to 1.12.",
    .contents = "worlds and models",
    .extensions = sdf_extensions,
    .max_bytes = XmlLimits{}.max_bytes,
    .world = read_content,
    .sdf_tree = read_tree,
    .write_world = [](const model::Setup& setup, Diagnostics& d) { return sdf_of(setup, d); },
    .write_model = [](const model::Instance& instance, Diagnostics& d) { return sdf_of(instance, d); },
};

constinit const FormatKind urdf_format{
    .name = "urdf",
    .help = "Robots of ROS, with <gazebo> and <ros2_control>; xacro must be expanded first.",
    .contents = "robots",
    .extensions = urdf_extensions,
    .max_bytes = XmlLimits{}.max_bytes,
    .world = read_content,
    .sdf_tree = read_tree,
    .write_model = urdf_of,
};

}  // namespace sandlot::formats
