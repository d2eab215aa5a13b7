#pragma once
/// Playback of recordings: their velocities are put into the `playback` controllers of a setup.
///
/// A controller opens no files, and sim cannot know of recordings: whoever loads a scenario by sim/load/load.h calls this
/// afterwards; load_simulation (sandlot/embed.h) has.
#include <span>
#include <string>

#include "base/result.h"
#include "controllers/playback/playback.h"
#include "model/model.h"

namespace sandlot::record {

/// Fills `samples` of each playback controller that names a `file`.
/// @param paths  folders to search after the scenario's own
/// Errors   a file that is not there or no recording; a topic or commands that it does not hold (those it does are
///          named), or of a type that tells no velocity; rows of a table that are not four numbers.
Status resolve_playbacks(model::Setup& setup, std::span<const std::string> paths);

}  // namespace sandlot::record
