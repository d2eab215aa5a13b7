#pragma once
/// Model structs as bytes, so that a snapshot needs no other file. Places (file:line) are not kept.
#include "base/bytes.h"
#include "model/model.h"

namespace sandlot {

/// @param instances  written with their models, each distinct model once
void write_setup(ByteWriter& w, const model::Setup& setup, std::span<const model::Instance* const> instances);
/// Reads what write_setup wrote; false when the bytes are not that or break the model's own rules.
bool read_setup(ByteReader& r, model::Setup& setup);

/// One instance with its model, as a request to spawn carries it.
void write_instance(ByteWriter& w, const model::Instance& instance);
bool read_instance(ByteReader& r, model::Instance& instance);
void write_device(ByteWriter& w, const model::DeviceDecl& device);
bool read_device(ByteReader& r, model::DeviceDecl& device);
void write_node(ByteWriter& w, const Node& node);
bool read_node(ByteReader& r, Node& node);

}  // namespace sandlot
