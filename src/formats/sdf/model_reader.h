#pragma once
/// From the <model> elements of a document to model::Model.
#include <memory>

#include "formats/sdf/frames.h"
#include "formats/sdf/values.h"
#include "model/model.h"

namespace sandlot::formats {

/// Reads a model with its nested models, whose links, joints and devices are called `nested::name`.
Result<std::shared_ptr<const model::Model>> read_model(const Xml& element, const ResolvedFrames& frames,
                                                       Notes& notes);
/// Pose of a model in the world.
Result<Pose> model_pose(const Xml& element, const ResolvedFrames& frames);

/// The parts of a link, read by link_reader.cpp.
Result<model::Link> read_link(const Xml& element, const ResolvedFrames& frames, bool is_static, Notes& notes);
/// One shape of <geometry>; nothing (and a warning) for those that are not supported.
Result<std::optional<Shape>> read_shape(const Xml& owner, Notes& notes);

/// A <sensor> of a link, a <plugin> of a model, a <sandlot:device> of either; device_reader.cpp.
Result<model::DeviceDecl> read_sensor(const Xml& element, const ResolvedFrames& frames);
Result<model::DeviceDecl> read_plugin(const Xml& element);
Result<model::DeviceDecl> read_native_device(const Xml& element);
/// Gives each device a name of its own where SDF allows sharing one; an error where the file has to decide.
Status name_devices(model::Model& model);

}  // namespace sandlot::formats
