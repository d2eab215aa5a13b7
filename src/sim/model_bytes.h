#pragma once
/// Model structs as bytes, so that a snapshot needs no other file. Places (file:line) are not kept.
#include "base/bytes.h"
#include "model/model.h"

namespace sandlot {

/// @param instances  written with their models, each distinct model once
void write_setup(ByteWriter& w, const model::Setup& setup, std::span<const model::Instance* const> instances);
/// Reads what write_setup wrote; false when the bytes are not that or break the model's own rules.
bool read_setup(ByteReader& r, model::Setup& setup);

}  // namespace sandlot
