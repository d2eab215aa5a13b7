#pragma once
/// What a run needs before its first tick: the world, and what to log and to record of it.
#include <memory>
#include <optional>

#include "app/commands.h"
#include "record/recorder.h"
#include "sim/world/simulation.h"

namespace sandlot::app {

struct Prepared {
  std::unique_ptr<Simulation> simulation;
  SimulationOptions options;  ///< it was made with these; its successors are too
  std::optional<model::LogDecl> log;
  std::optional<RecordOptions> recording;
};

/// Errors   in the files and options; options that do not go together; a result that would overwrite another one, or the
///          scenario.
Result<Prepared> prepare(const RunOptions& options, Diagnostics& diagnostics);

/// What configures a run without being in its snapshots: the event of --stop-when. For a world that takes the place of
/// another one, too.
Status configure(Simulation& simulation, const RunOptions& options);

}  // namespace sandlot::app
