#pragma once
/// Preparation of a run: from a RunSpec to the world before its first tick, its log and its recording.
#include <memory>
#include <optional>

#include "record/recorder.h"
#include "run/spec.h"
#include "sim/world/simulation.h"

namespace sandlot {

struct PreparedRun {
  std::unique_ptr<Simulation> simulation;
  SimulationOptions options;  ///< of this world and those that replace it
  std::optional<model::LogDecl> log;
  std::optional<RecordOptions> recording;
};

/// @param controllers  kinds of the caller's own, in addition to the built-in ones and those of plugins
/// Errors   in the files and the spec; fields that do not go together; a result that would overwrite another
///          one, or the scenario.
Result<PreparedRun> prepare(const RunSpec& spec, std::span<const ControllerKind* const> controllers,
                            Diagnostics& diagnostics);

/// Applies to a world what is part of a run but of no snapshot: the event of `stop_when`. Call it for each
/// world that replaces the first one, too.
Status configure(Simulation& simulation, const RunSpec& spec);

}  // namespace sandlot
