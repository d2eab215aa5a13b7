/// The `sandlot` command: verbs and their options. What a verb does is in the file of its name.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "app/commands.h"
#include "app/flags.h"
#include "app/verbs/calibrate.h"
#include "app/verbs/console.h"
#include "app/verbs/render.h"
#include "app/verbs/topic_export.h"
#include "base/units.h"

namespace {

using namespace sandlot;
using namespace sandlot::app;

/// "-1,1" as a range of an axis.
Status read_range(const char* flag, const std::string& text, std::optional<std::pair<double, double>>& out) {
  if (text.empty()) return {};
  const std::size_t comma = text.find(',');
  double low = 0, high = 0;
  if (comma == std::string::npos || !parse_number(text.substr(0, comma), low) ||
      !parse_number(text.substr(comma + 1), high) || !(low < high) || !std::isfinite(low) ||
      !std::isfinite(high))
    return Error{std::string(flag) + ": '" + text + "' is no range",
                 "write the lower and the upper end: -1,1"};
  out = {low, high};
  return {};
}

/// --port and what goes with it.
struct ServeFlags {
  std::optional<int> port;
  ServeOptions options;

  void add_to(CLI::App& verb) {
    verb.add_option("--port", port, "Serve the page, and Foxglove clients, on this port; 0: any that is free")
        ->check(CLI::Range(0, 65535));
    verb.add_option("--address", options.address,
                    "Address to listen at; elsewhere than on this machine a token is needed to steer")
        ->capture_default_str();
    verb.add_option("--token", options.token, "Token that allows to steer; one is made where none is given");
    verb.add_option(
            "--allow-origin", options.origins,
            "Another site whose pages may connect: https://app.example.org; may be given several times")
        ->allow_extra_args(false);
  }

  Status finish(std::optional<ServeOptions>& out) {
    if (port) {
      options.port = *port;
      out = options;
      return {};
    }
    if (!options.token.empty() || !options.origins.empty() || options.address != ServeOptions().address)
      return Error{"--address, --token and --allow-origin say who may look at the page, but there is none",
                   "add --port 8765"};
    return {};
  }
};

/// "max", "" or a factor of real time.
Status read_rate(const std::string& text, std::optional<double>& out) {
  out.reset();
  if (text.empty() || text == "max") return {};
  double factor = 0;
  if (!parse_number(text, factor) || !(factor > 0 && factor <= 1e6))
    return Error{"--rate: '" + text + "' is neither 'max' nor a positive number"};
  out = factor;
  return {};
}

struct RunFlags {
  RunOptions options;
  DurationOption duration, snapshot_at, snapshot_every;
  std::string rate;
  ServeFlags serve;
  std::vector<std::string> sets;
  std::string log_values, log_rate, video_size;
  bool headless = false;

  void add_to(CLI::App& verb) {
    CLI::Option* const without = verb.add_flag("--headless", headless, "Run without a page");
    serve.add_to(verb);
    verb.get_option("--port")->excludes(without);
    verb.add_flag("--paused", options.paused, "Begin paused; with --port");
    verb.add_option("--command", options.lines,
                    "A console line for the run, such as 'at 2s pose rover 1 2'; may be given several times")
        ->allow_extra_args(false);
    verb.add_option("--script", options.script_file, "A file of such lines");
    verb.add_option("--duration", duration.text,
                    "Simulated time after which the run ends, such as 30s or '2 min'");
    verb.add_option(
        "--rate", rate,
        "max: as fast as possible; 1: in real time; 0.5, 2 ...: that many times real time. If left "
        "out: max, with --port 1");
    verb.add_option("--seed", options.seed, "Seed of all random numbers, instead of the scenario's");
    verb.add_option("--errors", options.errors,
                    "Factor on the errors of all devices, beside those in the scenario; 0: exact")
        ->check(CLI::Range(0.0, 1000.0));
    verb.add_option("--threads", options.threads,
                    "Threads; 0: as many as the machine has. The result does not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    verb.add_option("--set", sets,
                    "Change the scenario before it is loaded: path=value, such as physics=planar or "
                    "'robots[0].pose=[1, 2, 0]'")
        ->allow_extra_args(false);
    verb.add_option("--path", options.paths,
                    "Folder to search for models and other files; may be given several times")
        ->allow_extra_args(false);
    verb.add_option("--summary", options.summary_file, "Write the summary of the run as JSON");
    verb.add_flag("--skip-missing", options.skip_missing,
                  "Leave out, with a warning, what a world names and nobody has: models, meshes, heightmaps");
    verb.add_option("--stop-when", options.stop_when,
                    "End the run when this expression over addresses holds, such as 'rover.pose.x > 3'");
    verb.add_option("--log", options.log_file, "Write values to this CSV file while it runs");
    verb.add_option("--log-values", log_values,
                    "What to log: addresses and expressions with commas between them (docs/values.md)");
    verb.add_option("--log-rate", log_rate,
                    "Lines per simulated second, such as '10 Hz'; one per tick if left out");
    verb.add_option("--svg", options.svg_file, "Draw the world from above with paths and last scans");
    verb.add_option("--snapshot", options.snapshots.file,
                    "Write a snapshot: at the end, or at --snapshot-at");
    verb.add_option("--snapshot-at", snapshot_at.text, "Simulated time of the snapshot");
    verb.add_option("--snapshot-every", snapshot_every.text,
                    "And one each time so much was simulated, such as 10s: FILE with the time in its name");
    verb.add_option("--snapshot-keep", options.snapshots.keep,
                    "Of those of --snapshot-every only the last so many stay; 0: all")
        ->check(CLI::Range(0, 1'000'000));
    verb.add_option("--record", options.record_file, "Record the run as an MCAP file");
    verb.add_option("--record-topics", options.record_topics,
                    "Record these topics only, such as '/rover/*'; may be given several times")
        ->allow_extra_args(false);
    verb.add_option("--record-compression", options.record_compression,
                    "Compression of the recording's chunks")
        ->check(CLI::IsMember({"none", "lz4", "zstd"}));
    verb.add_option("--video", options.film.file, "Film the run: an .mp4, .mov or .mkv file");
    verb.add_option(
        "--camera", options.film.view.camera,
        "What films: a robot's camera (robot/device), follow:ROBOT for a view from behind it, or overhead");
    verb.add_option("--video-size", video_size,
                    "Width and height, such as 640x480; 960x540 if left out. A robot's camera has its own");
    verb.add_option("--video-rate", options.film.rate_hz,
                    "Pictures per simulated second, and per second of the film")
        ->check(CLI::Range(1, 240))
        ->capture_default_str();
    verb.add_flag("--json", options.json, "Print the summary as JSON");
  }

  Status finish() {
    SL_TRY(duration.read("--duration", options.duration_s));
    SL_TRY(snapshot_at.read("--snapshot-at", options.snapshots.at_s));
    SL_TRY(snapshot_every.read("--snapshot-every", options.snapshots.every_s));
    SL_TRY(check(options.snapshots));
    SL_TRY(serve.finish(options.serve));
    SL_TRY(read_size("--video-size", video_size, options.film.view));
    if (options.film.file.empty() != options.film.view.camera.empty())
      return Error{"--video and --camera go together: the film, and what takes it",
                   "add --camera overhead, or --video run.mp4"};
    if (options.paused && !options.serve)
      return Error{"--paused: nobody could let the run go on", "add --port 8765"};
    SL_TRY(read_rate(rate.empty() && options.serve ? "1" : rate, options.rate));
    options.log_values = split_list(log_values);
    if (!log_rate.empty()) {
      auto hz = parse_quantity(log_rate, "Hz");
      if (!hz) return Error{"--log-rate: " + hz.error().what, hz.error().fix};
      if (!(*hz >= 0 && *hz <= 1e6))
        return Error{"--log-rate: must be in [0, 1e6] Hz, is " + number_text(*hz)};
      options.log_rate_hz = *hz;
    }
    return read_sets(sets, options.overrides);
  }
};

}  // namespace

int sandlot::app::command(int argc, char** argv, const Hooks* hooks) {
  CLI::App app{"Sandlot simulates many mobile robots with real sensors, and gives the same answer twice.",
               "sandlot"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "sandlot " SANDLOT_VERSION);
  app.footer("Try: sandlot demo    Every verb explains itself: sandlot run --help");
  int result = exit_ok;

  RunFlags run_flags;
  CLI::App* const run_verb = app.add_subcommand("run",
                                                "Run a scenario (.yaml), a world (.sdf) or a robot (.urdf)");
  run_verb->add_option("file", run_flags.options.file, "Scenario, world or robot");
  run_verb->add_option("--from", run_flags.options.from_file, "Go on from a snapshot instead of a file");
  run_flags.add_to(*run_verb);
  run_flags.options.hooks = hooks;
  run_verb->footer(
      "Example: sandlot run scenarios/indoor.yaml --duration 60s --set physics=planar --svg run.svg");
  run_verb->callback([&] {
    if (Status status = run_flags.finish(); !status) result = complain(status.error());
    else if (run_flags.options.file.empty() == run_flags.options.from_file.empty())
      result = complain({"run needs either a file or --from", "sandlot run scenarios/indoor.yaml"});
    else result = run(run_flags.options);
  });

  RunFlags demo_flags;
  std::string demo_name = "demo";
  CLI::App* const demo_verb = app.add_subcommand("demo",
                                                 "Show a scenario that comes with Sandlot, on a page");
  demo_verb->add_option("name", demo_name, "Name of a file in scenarios/; list: say which there are")
      ->capture_default_str();
  demo_flags.add_to(*demo_verb);
  demo_verb->footer(
      "Example: sandlot demo                                     and open the page it names\n"
      "         sandlot demo indoor --headless --duration 20s    only the summary");
  demo_verb->callback([&] {
    if (demo_name == "list") return void(result = list_demos());
    ServeFlags& serve = demo_flags.serve;
    // The usual port, or one near it: a demo should begin.
    if (!serve.port && !demo_flags.headless) serve.port = 8765, serve.options.next_free = true;
    Status status = demo_flags.finish();
    if (!status) return void(result = complain(status.error()));
    auto file = demo_file(demo_name);
    if (!file) return void(result = complain(file.error()));
    demo_flags.options.file = *file;
    result = run(demo_flags.options);
  });

  add_console_verb(app, result);
  add_render_verb(app, result);

  FileOptions file_options;
  std::vector<std::string> file_sets;
  const auto add_file_verb = [&](const char* name, const char* help, const char* example,
                                 int (*act)(const FileOptions&)) -> CLI::App* {
    CLI::App* const verb = app.add_subcommand(name, help);
    verb->add_option("files", file_options.files, "Scenarios or worlds")->required();
    verb->add_option("--set", file_sets, "Change the scenario before it is loaded: path=value")
        ->allow_extra_args(false);
    verb->add_flag(
        "--skip-missing", file_options.skip_missing,
        "Leave out, with a warning, what a world names and nobody has: models, meshes, heightmaps");
    verb->add_option("--path", file_options.paths,
                     "Folder to search for models and other files; may be given several times")
        ->allow_extra_args(false);
    verb->add_flag("--json", file_options.json, "Print as JSON");
    verb->footer(example);
    verb->callback([&, act] {
      if (Status status = read_sets(file_sets, file_options.overrides); !status)
        result = complain(status.error());
      else result = act(file_options);
    });
    return verb;
  };
  CLI::App* const check_verb = add_file_verb(
      "check", "Find what is wrong or suspicious in files, with line and remedy",
      "Exit code 2 when a file is wrong, 0 when there are only warnings.\n"
      "Example: sandlot check --strict scenarios/*.yaml",
      check);
  check_verb->add_flag("--strict", file_options.strict, "Warnings count as errors: exit code 2");
  CLI::App* const info_verb = add_file_verb(
      "info", "Print the tree of a scenario, world or snapshot: links, joints, devices, topics",
      "Example: sandlot info scenarios/indoor.yaml", info);
  info_verb->add_flag("--values", file_options.values,
                      "Print the address of every value instead, with unit and value at the start");

  PlotFilesOptions plot_options;
  std::string plot_y, plot_x_range, plot_y_range;
  CLI::App* const plot_verb = app.add_subcommand("plot", "Draw columns of CSV files as lines, as an SVG");
  plot_verb->add_option("files", plot_options.files, "CSV files: a line of names, then numbers")->required();
  plot_verb->add_option("--out", plot_options.out, "SVG file to write")->required();
  plot_verb->add_option("--x", plot_options.figure.x, "Column of the horizontal axis")->capture_default_str();
  plot_verb->add_option("--y", plot_y, "Columns to draw, with commas between them; all others if left out");
  plot_verb->add_option("--title", plot_options.figure.title, "Title of the figure");
  plot_verb->add_option("--x-label", plot_options.figure.x_label, "Label of the horizontal axis");
  plot_verb->add_option("--y-label", plot_options.figure.y_label, "Label of the vertical axis");
  plot_verb->add_option("--x-range", plot_x_range, "What the horizontal axis shows: 0,10");
  plot_verb->add_option("--y-range", plot_y_range, "What the vertical axis shows: -1,1");
  plot_verb
      ->add_option("--label", plot_options.figure.labels,
                   "Name of a line in the legend; once per line, in order")
      ->allow_extra_args(false);
  plot_verb
      ->add_option("--color", plot_options.figure.colours,
                   "Colour of a line, such as red or '#1f77b4'; once per line, in order")
      ->allow_extra_args(false);
  plot_verb->footer("Example: sandlot plot run.csv --y 'rover.pose.x,rover.pose.y' --out run.svg");
  plot_verb->callback([&] {
    plot_options.figure.y = split_list(plot_y);
    Status status = read_range("--x-range", plot_x_range, plot_options.figure.x_range);
    if (status) status = read_range("--y-range", plot_y_range, plot_options.figure.y_range);
    result = status ? plot(plot_options) : complain(status.error());
  });

  ReplayOptions replay_options;
  DurationOption until, replay_snapshot_at;
  bool recompute = false;
  CLI::App* const replay_verb = app.add_subcommand("replay", "Run a recording again, and prove it");
  replay_verb->add_option("file", replay_options.file, "Recording (.mcap)")->required();
  replay_verb->add_flag("--verify", replay_options.verify,
                        "Compare every tick; exit code 1 at the first difference");
  CLI::Option* const recompute_flag = replay_verb->add_flag("--recompute", recompute,
                                                            "Controllers run again (unless --logged)");
  replay_verb
      ->add_flag("--logged", replay_options.logged, "Controllers do not run: their orders come from the log")
      ->excludes(recompute_flag);
  replay_verb->add_option("--until", until.text, "Simulated time at which to end, such as 10s");
  replay_verb->add_option("--threads", replay_options.threads, "Threads; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  replay_verb->add_option("--snapshot", replay_options.snapshots.file,
                          "Write a snapshot: at the end, or at --snapshot-at");
  replay_verb->add_option("--snapshot-at", replay_snapshot_at.text, "Simulated time of the snapshot");
  replay_verb->add_option("--summary", replay_options.summary_file, "Write what was found as JSON");
  replay_verb
      ->add_option("--path", replay_options.paths, "Folder to search for plugins; may be given several times")
      ->allow_extra_args(false);
  ServeFlags replay_serve;
  std::string replay_rate;
  replay_serve.add_to(*replay_verb);
  replay_verb->add_option("--rate", replay_rate, "With --port: 1 is real time; max: as fast as possible");
  replay_verb->add_flag("--json", replay_options.json, "Print as JSON");
  replay_verb->footer("Example: sandlot replay r.mcap --verify\n         sandlot replay r.mcap --port 8765");
  replay_verb->callback([&] {
    Status status = until.read("--until", replay_options.until_s);
    if (status) status = replay_snapshot_at.read("--snapshot-at", replay_options.snapshots.at_s);
    if (status) status = check(replay_options.snapshots);
    if (status) status = replay_serve.finish(replay_options.serve);
    if (status) status = read_rate(replay_rate.empty() ? "1" : replay_rate, replay_options.rate);
    if (status && !replay_rate.empty() && !replay_options.serve)
      status = Error{"--rate is for looking at the recording", "add --port 8765"};
    result = status ? replay(replay_options) : complain(status.error());
  });

  DiffOptions diff_options;
  CLI::App* const diff_verb = app.add_subcommand("diff",
                                                 "Find where two recordings or snapshots begin to differ");
  diff_verb->add_option("a", diff_options.a, "Recording (.mcap) or snapshot")->required();
  diff_verb->add_option("b", diff_options.b, "Recording (.mcap) or snapshot")->required();
  diff_verb->add_option("--limit", diff_options.limit, "Show so many values at most")->capture_default_str();
  diff_verb->add_option("--threads", diff_options.threads, "Threads; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  diff_verb
      ->add_option("--path", diff_options.paths, "Folder to search for plugins; may be given several times")
      ->allow_extra_args(false);
  diff_verb->add_flag("--json", diff_options.json, "Print as JSON");
  diff_verb->footer(
      "Exit code 0: no difference in the ticks that both have, 1: a difference, 2: they cannot be compared.\n"
      "Example: sandlot diff a.mcap b.mcap");
  diff_verb->callback([&] { result = diff(diff_options); });

  ConvertOptions convert_options;
  CLI::App* const convert_verb = app.add_subcommand(
      "convert", "Turn URDF, SDF and scenarios into each other, by the extensions of the files");
  convert_verb->add_option("in", convert_options.in, "What is there: .urdf, .sdf, .world or .yaml")
      ->required();
  convert_verb->add_option("out", convert_options.out, "What it becomes: .sdf, .world, .urdf or .yaml")
      ->required();
  convert_verb->add_flag("--force", convert_options.force, "Replace the file when it exists");
  convert_verb
      ->add_option("--path", convert_options.paths,
                   "Folder to search for models and other files; may be given several times")
      ->allow_extra_args(false);
  convert_verb->footer("Example: sandlot convert robot.urdf robot.sdf");
  convert_verb->callback([&] { result = convert(convert_options); });

  CalibrateOptions calibrate_options;
  std::vector<std::string> calibrate_sets;
  CLI::App* const calibrate_verb = app.add_subcommand(
      "calibrate", "Measure the errors of a detector in a camera's pictures, as keys of its level `objects`");
  calibrate_verb->add_option("file", calibrate_options.file, "Scenario with the camera and things to see")
      ->required();
  calibrate_verb->add_option("--camera", calibrate_options.camera, "The camera: robot/device")->required();
  calibrate_verb->add_option("--samples", calibrate_options.samples, "Pictures")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  calibrate_verb
      ->add_option("--label", calibrate_options.labels,
                   "Things with this label only; may be given several times")
      ->allow_extra_args(false);
  calibrate_verb
      ->add_option("--max-range", calibrate_options.max_range_m,
                   "Things are put as far away as this, in metres")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  calibrate_verb
      ->add_option("--detector", calibrate_options.detector,
                   "picture: finds things by their colours; objects: the camera's level `objects` itself")
      ->check(CLI::IsMember({"picture", "objects"}))
      ->capture_default_str();
  calibrate_verb->add_flag("--as-it-runs", calibrate_options.as_it_runs,
                           "Let the scenario run with its controllers instead of moving things about");
  calibrate_verb->add_option("--seed", calibrate_options.seed,
                             "Seed of all random numbers, instead of the scenario's");
  calibrate_verb->add_option("--set", calibrate_sets, "Change the scenario before it is loaded: path=value")
      ->allow_extra_args(false);
  calibrate_verb
      ->add_option("--path", calibrate_options.paths,
                   "Folder to search for models and other files; may be given several times")
      ->allow_extra_args(false);
  calibrate_verb->add_option("--out", calibrate_options.out,
                             "Write the keys to this file instead, to be included");
  calibrate_verb->add_option(
      "--pictures", calibrate_options.pictures,
      "Folder that gets the first twelve pictures: frames about what was found, crosses where things are");
  calibrate_verb->add_flag("--json", calibrate_options.json, "Print as JSON");
  calibrate_verb->footer(
      "Exit code 0: measured, 1: there was nothing to be seen, 2: the input is wrong.\n"
      "Example: sandlot calibrate scenarios/ball.yaml --camera seeker/eye --samples 500 --out eye.yaml");
  calibrate_verb->callback([&] {
    const Status sets = read_sets(calibrate_sets, calibrate_options.overrides);
    result = sets ? calibrate(calibrate_options) : complain(sets.error());
  });

  ListOptions list_options;
  CLI::App* const list_verb = app.add_subcommand(
      "list", "List the kinds of devices, controllers, engines and noise, message types, and Gazebo plugins");
  list_verb->add_option(
      "what", list_options.what,
      "devices, controllers, engines, noise (these four when left out), levels, messages or plugins");
  list_verb->add_flag("--verbose", list_options.verbose, "With every field: unit, range, default, meaning");
  list_verb->add_flag("--json", list_options.json, "Print as JSON");
  list_verb->add_flag("--markdown", list_options.markdown, "Print as the reference page of the docs");
  list_verb->add_flag("--schema", list_options.schema, "Print the JSON schema of scenario files");
  list_verb
      ->add_option("--plugin", list_options.plugins,
                   "Shared library whose controllers are listed too; may be given several times")
      ->allow_extra_args(false);
  list_verb->footer("Example: sandlot list devices --verbose");
  list_verb->callback([&] { result = list(list_options); });

  BenchOptions bench_options;
  CLI::App* const bench_verb = app.add_subcommand("bench",
                                                  "Measure Sandlot against references in the same run");
  bench_verb->add_option("name", bench_options.name, "Rows whose name contains this; all when left out");
  bench_verb->add_flag("--json", bench_options.json, "Print as JSON");
  bench_verb->footer("Example: sandlot bench ranges --json");
  bench_verb->callback([&] { result = bench(bench_options); });

  ValidateOptions validate_options;
  CLI::App* const validate_verb = app.add_subcommand("validate",
                                                     "Run experiments of which theory knows the result");
  validate_verb->add_option("name", validate_options.name, "One experiment; all when left out");
  validate_verb->add_option("--out", validate_options.out,
                            "Folder to write validation.md and its figures into");
  validate_verb->add_flag("--json", validate_options.json, "Print as JSON");
  validate_verb->footer("Example: sandlot validate friction");
  validate_verb->callback([&] { result = validate(validate_options); });

  RecordingOptions recording_options;
  DurationOption from, to;
  CLI::App* const topic_verb = app.add_subcommand("topic", "Look into a recording: list, echo, hz, export");
  topic_verb->require_subcommand(1);
  topic_verb->footer("Example: sandlot topic list run.mcap");
  const auto add_topic_verb = [&](const char* name, const char* help, const char* example, bool needs_topic,
                                  int (*act)(const RecordingOptions&)) {
    CLI::App* const verb = topic_verb->add_subcommand(name, help);
    verb->add_option("file", recording_options.file, "The recording, an MCAP file")->required();
    if (act != topic_list) {
      CLI::Option* const topic = verb->add_option("topic", recording_options.topic, "Name of the topic");
      if (needs_topic) topic->required();
      verb->add_option("--from", from.text, "Begin at this time of the recording");
      verb->add_option("--to", to.text, "End after this time");
    }
    if (act == topic_echo) verb->add_option("--count", recording_options.count, "End after so many messages");
    verb->add_flag("--json", recording_options.json, "Print as JSON");
    verb->footer(example);
    verb->callback([&, act] {
      Status status = from.read("--from", recording_options.from_s);
      if (status) status = to.read("--to", recording_options.to_s);
      result = status ? act(recording_options) : complain(status.error());
    });
  };
  add_topic_verb("list", "The topics of a recording with types and counts",
                 "Example: sandlot topic list run.mcap", false, topic_list);
  add_topic_verb("echo", "Print the messages of a topic",
                 "Example: sandlot topic echo run.mcap /rover/laser/ranges --from 2s --count 1", true,
                 topic_echo);
  add_topic_verb("hz", "How often messages came", "Example: sandlot topic hz run.mcap", false, topic_hz);

  ExportOptions export_options;
  std::string export_values;
  CLI::App* const export_verb = topic_verb->add_subcommand("export", "Write numbers of a recording as CSV");
  export_verb->add_option("file", export_options.recording, "The recording, an MCAP file")->required();
  export_verb
      ->add_option("--values", export_values,
                   "Numbers, parted by commas: /topic.path, or a topic for all numbers in it")
      ->required();
  export_verb->add_option("--out", export_options.out, "The CSV file")->required();
  export_verb->add_option("--from", from.text, "Begin at this time of the recording");
  export_verb->add_option("--to", to.text, "End after this time");
  export_verb->footer(
      "Example: sandlot topic export run.mcap --values '/rover/laser/ranges.ranges[90],/tf' --out run.csv");
  export_verb->callback([&] {
    export_options.values = split_list(export_values);
    Status status = from.read("--from", export_options.from_s);
    if (status) status = to.read("--to", export_options.to_s);
    result = status ? topic_export(export_options) : complain(status.error());
  });

  bool doctor_json = false;
  CLI::App* const doctor_verb = app.add_subcommand(
      "doctor", "Check this build and machine, or check a recording and repair it when it is not whole");
  doctor_verb->add_option("file", recording_options.file,
                          "A recording (MCAP) or a snapshot; this build and machine if left out");
  doctor_verb->add_flag("--dry-run", recording_options.dry_run,
                        "Only say what would be done to the recording");
  doctor_verb->add_flag("--json", doctor_json, "Print as JSON");
  doctor_verb->footer(
      "Exit code 0: whole, or repaired; 1: not whole (--dry-run); 2: no recording.\n"
      "Example: sandlot doctor run.mcap");
  doctor_verb->callback([&] {
    recording_options.json = doctor_json;
    result = recording_options.file.empty() ? doctor(doctor_json) : doctor_file(recording_options);
  });

  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return fmt::format("error: {}; --help shows what there is\n", error.what());
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_ok : exit_bad_input;
  } catch (const std::system_error&) {
    // fmt::print() throws when the output takes no more.
    return finish_output(exit_failed);
  }
  return finish_output(result);
}
