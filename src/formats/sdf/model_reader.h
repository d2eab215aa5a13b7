#pragma once
/// Reader of the <model> elements of a document, to model::Model.
#include <memory>

#include "formats/sdf/reading.h"
#include "model/model.h"

namespace sandlot::formats {

/// Reads a model with its nested models, whose links, joints and devices are called `nested::name`.
/// @param world_joints  joints of the world whose child is in this model
Result<std::shared_ptr<const model::Model>> read_model(const Xml& element,
                                                       const std::vector<const Xml*>& world_joints,
                                                       const Reading& in);

/// A link with its collisions and visuals; link_reader.cpp.
Result<model::Link> read_link(const Xml& element, bool is_static, const Reading& in);

/// A <sensor> of a link, a <plugin> of a model, a <sandlot:device> of either; device_reader.cpp.
Result<model::DeviceDecl> read_sensor(const Xml& element, const Reading& in);
Result<model::DeviceDecl> read_plugin(const Xml& element);
Result<model::DeviceDecl> read_native_device(const Xml& element);
/// Gives each device a name of its own where SDF allows sharing one; an error where the file has to decide.
Status name_devices(model::Model& model);

}  // namespace sandlot::formats
