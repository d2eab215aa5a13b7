#pragma once
/// Verbs of the `sandlot` command. Each takes parsed options and returns an exit code: 0 ok, 1 the run
/// failed, 2 the input is wrong.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "draw/plot.h"
#include "formats/scenario/scenario.h"
#include "run/film.h"
#include "run/snapshot_files.h"
#include "run/summary.h"
#include "sim/session/run_hooks.h"

namespace sandlot::app {

inline constexpr int exit_ok = 0, exit_failed = 1, exit_bad_input = 2;

/// The whole command, from its arguments to its exit code.
/// @param hooks  C++ functions of an embedding program, for `run`; null: none
int command(int argc, char** argv, const Hooks* hooks = nullptr);

/// Address of a run for viewers.
struct ServeOptions {
  int port = 0;            ///< 0: any that is free
  bool next_free = false;  ///< when the port is taken, try the next ones
  std::string address = "127.0.0.1";
  std::string token;        ///< of administrators; "": made where one is needed
  std::string tokens_file;  ///< app/tokens.h; "": none
  std::vector<std::string> origins;
  bool udp = false;   ///< whether clients may come by UDP, too
  std::string world;  ///< file of the run, for programs that ask; "": none
  int most_clients = 64, most_per_address = 32;
};

/// Referee box of a run, for base stations of the league's teams.
struct RefboxFlags {
  std::string at;         ///< PORT or ADDRESS:PORT; "": there is none
  std::string teams;      ///< server/refbox/teams.h
  std::string protocols;  ///< as there
};

struct RunOptions {
  RunSpec spec;
  std::optional<ServeOptions> serve;
  RefboxFlags refbox;
  bool watch = false;            ///< restart programs whose files have changed
  bool verbose = false;          ///< write what `check` would report, too
  std::string program_logs;      ///< folder for what programs print; "": none
  bool json = false;             ///< print the summary as JSON instead of text
  const Hooks* hooks = nullptr;  ///< C++ functions of an embedding program
  std::optional<int> repeat;     ///< so many runs, with seeds that follow each other
  std::string store;             ///< file that keeps their results; "": none
  int at_a_time = 0;             ///< of those; 0: as many as the machine has processors
};
int run(const RunOptions& options);
/// Functions of a caller of run_once(); each may be empty.
struct RunWatch {
  /// Before programs are started. Errors: nothing is run.
  std::function<Status(Simulation&)> on_world;
  /// Some times a second of wall time. False: the run ends.
  std::function<bool()> goes_on;
  /// At the end, with the world as it is then.
  std::function<void(const Simulation&)> on_end;
};
/// One run, with its server and the programs that it starts. Prints warnings and, where asked for, progress.
Result<Summary> run_once(const RunOptions& options, bool shows_progress, const RunWatch& watch = {});

/// Folders of the Python client library, installed or in the source tree.
std::vector<std::string> client_folders();

struct DemoOptions {
  std::string name;  ///< of a scenario that comes with Sandlot; "": a match; list: print the names
  RunOptions run;    ///< its file is set there
};
int demo(const DemoOptions& options);

struct MatchSpec;
/// Plays two teams' software against each other; app/match.h.
int match(const MatchSpec& spec);

struct ReplayOptions {
  std::string file;     ///< recording
  bool verify = false;  ///< compare every tick
  bool logged = false;  ///< the controllers' orders come from the log
  std::optional<double> until_s;
  std::optional<double> from_s;  ///< with `serve`: shows the recording from there
  int threads = 1;
  SnapshotOptions snapshots;
  std::string summary_file;
  std::vector<std::string> paths;  ///< folders to search first for plugins
  bool json = false;
  std::optional<ServeOptions> serve;  ///< shows it there instead of running through it
  std::optional<double> rate = 1;     ///< then: real time x factor; unset: as fast as possible
};
int replay(const ReplayOptions& options);
/// Shows a recording to viewers, with `serve`.
int play(const ReplayOptions& options);

struct RenderOptions {
  std::string file, out;
  std::vector<formats::Override> overrides;
  std::vector<std::string> paths;  ///< folders to search first
  bool skip_missing = false;
  draw::ViewpointOptions view;
  double time_s = 0;
};
int render(const RenderOptions& options);

struct ConsoleOptions {
  std::string url;  ///< as people write it; "": this machine's
  std::string token;
  std::vector<std::string> lines;  ///< to send; empty: read from standard input
  std::string script_file;
  bool json = false;
};
int console(const ConsoleOptions& options);

struct DiffOptions {
  std::string a, b;  ///< recordings or snapshot files
  int threads = 1;
  std::size_t limit = 20;          ///< values that are shown
  std::vector<std::string> paths;  ///< folders to search first for plugins
  bool json = false;
};
int diff(const DiffOptions& options);

struct FileOptions {
  std::vector<std::string> files;
  std::vector<formats::Override> overrides;
  std::vector<std::string> paths;  ///< folders to search first
  bool skip_missing = false;       ///< of the files that the file names
  bool json = false;
  bool strict = false;  ///< check: warnings fail too
  bool values = false;  ///< info: the addresses of all values
};
int check(const FileOptions& options);
int info(const FileOptions& options);

struct ConvertOptions {
  std::string in, out;
  std::vector<std::string> paths;  ///< folders to search first
  bool force = false;              ///< replace what is there
};
int convert(const ConvertOptions& options);

struct NewOptions {
  std::string name, language;
  std::string out;  ///< folder; "": the name
};
/// Writes a project with a program that drives a robot.
int new_controller(const NewOptions& options);

struct ListOptions {
  std::string what;                ///< "" for everything
  std::vector<std::string> names;  ///< of what is listed: only these, with all there is to say of them
  bool verbose = false;
  bool json = false;
  bool markdown = false;
  std::vector<std::string> plugins;  ///< files or names; their controllers are listed too
  bool schema = false;
};
int list(const ListOptions& options);

struct PlotFilesOptions {
  std::vector<std::string> files;  ///< CSV
  std::string out;                 ///< SVG
  draw::PlotOptions figure;
};
int plot(const PlotFilesOptions& options);

struct BenchOptions {
  std::string suite;   ///< "" for all
  bool guard = false;  ///< fail at twice a budget
  bool json = false;
};
int bench(const BenchOptions& options);

struct ValidateOptions {
  std::string name;  ///< "" for all
  std::string out;   ///< folder for the page; "": none
  bool json = false;
};
int validate(const ValidateOptions& options);

struct ReproduceOptions {
  std::string paper, out;           ///< name of the paper; folder for page and tables
  std::optional<int> repeat;        ///< runs per condition; unset: as many as the paper's line says
  std::vector<std::string> traces;  ///< files of step times, in place of runs
  int at_a_time = 0;                ///< of those; 0: as many as the machine has processors
  bool quick = false;               ///< without the parts that take long
};
int reproduce(const ReproduceOptions& options);

int doctor(bool json);

struct RecordingOptions {
  std::string file;
  std::string topic;  ///< "" for all
  std::optional<double> from_s, to_s;
  std::optional<std::uint64_t> count;
  bool json = false;
  bool dry_run = false;  ///< doctor: only print what would be done
};
/// Checks whether a recording is whole, and repairs it when it is not.
int doctor_file(const RecordingOptions& options);
int topic_list(const RecordingOptions& options);
int topic_echo(const RecordingOptions& options);
int topic_hz(const RecordingOptions& options);

/// Simulation of a file. Building it finds errors that reading alone does not (joints, levels, rates).
Result<std::unique_ptr<Simulation>> build(const std::string& file, const FileOptions& options,
                                          Diagnostics& diagnostics);

/// Prints an error in the form of all verbs. @return exit_bad_input
int complain(const Error& error);
void print_warnings(const Diagnostics& diagnostics);
/// Prints an error when standard output could not be written, as on a full disk. @return the exit code then,
/// else `code`
int finish_output(int code);

}  // namespace sandlot::app
