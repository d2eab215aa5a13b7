#pragma once
/// Playback of recordings: their velocities are put into the `playback` controllers of a setup.
///
/// A controller opens no files, and sim cannot know of recordings: programs load scenarios by load_with_playbacks(), and an
/// embedding program by load_simulation (sandlot/embed.h).
#include <span>
#include <string>

#include "base/result.h"
#include "controllers/playback/playback.h"
#include "model/model.h"
#include "sim/load/load.h"

namespace sandlot::record {

/// Fills `samples` of each playback controller that names a `file`.
/// @param paths  folders to search after the scenario's own
/// Errors   a file that is not there or no recording; a topic or commands that it does not hold (those it does are
///          named), or of a type that tells no velocity; rows of a table that are not four numbers.
Status resolve_playbacks(model::Setup& setup, std::span<const std::string> paths);

/// sim/load/load.h's load(), with its playbacks filled.
Result<model::Setup> load_with_playbacks(const std::string& file, const LoadOptions& options,
                                         Diagnostics& diagnostics);

}  // namespace sandlot::record
