#pragma once
/// RunSpec: a run as plain data. World, input, clock and results; nothing of a command line, a terminal or a
/// server.
///
/// Errors  name the options of `sandlot run` that fields stand for (--from is `from_file`, --svg is
///         `drawing_file`).
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "draw/viewpoint.h"
#include "formats/scenario/scenario.h"

namespace sandlot {

struct SnapshotOptions {
  std::string file;               ///< "": none
  std::optional<double> at_s;     ///< unset: at the end
  std::optional<double> every_s;  ///< in addition; unset: none
  int keep = 0;                   ///< of those of `every_s` the last so many stay; 0: all
};

struct FilmOptions {
  std::string file;  ///< "": none
  draw::ViewpointOptions view;
  int rate_hz = 25;
  double speed = 1;  ///< simulated seconds per second of the film
};

struct RunSpec {
  // --- world ---
  std::string file;       ///< scenario, world or robot; "" with `from_file`
  std::string from_file;  ///< snapshot to continue from
  std::vector<formats::Override> overrides;
  std::vector<std::string> paths;  ///< folders to search first for models and other files
  bool allow_programs = false;     ///< with `from_file`: start programs that run in processes of their own
  bool skip_missing = false;       ///< leave out, with a warning, models and meshes that are not found
  std::optional<std::uint64_t> seed;
  std::optional<double> errors;  ///< factor on the errors of all devices

  // --- input ---
  std::vector<std::string> commands;  ///< console lines: "at 2s pose rover 1 2"
  std::string script_file;            ///< of such lines

  // --- end and clock; the result depends on neither `threads` nor `rate` ---
  std::optional<double> duration_s;  ///< simulated time; with `from_file` counted from there
  std::string stop_when;             ///< expression
  int threads = 1;                   ///< 0: as many as the machine has
  std::optional<double> rate;        ///< real time x factor; unset: as fast as possible
  bool paused = false;               ///< begins paused
  bool steered = false;  ///< the caller lets people pause, resume and rewind: snapshots are kept for that
  bool starts_clients = false;  ///< the caller starts the programs of clients that have a command
  bool may_be_endless = false;  ///< the caller can end the run: no warning when the scenario does not

  // --- results; "": none, or as the scenario says ---
  std::string summary_file;             ///< JSON
  std::string drawing_file;             ///< SVG from above, with paths and last scans
  std::string log_file;                 ///< CSV
  std::vector<std::string> log_values;  ///< addresses and expressions; empty: the scenario's
  std::optional<double> log_rate_hz;
  std::vector<std::string> agent_logs;  ///< "ROBOT/CONTROLLER=FILE", in addition to those of the scenario
  std::string step_times_file;          ///< CSV of wall times; they differ from run to run
  std::string record_file;              ///< MCAP
  std::vector<std::string> record_topics;
  std::string record_compression;
  SnapshotOptions snapshots;
  FilmOptions film;
};

}  // namespace sandlot
