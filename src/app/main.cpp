/// The `sandlot` command: its verbs and their options. app/verbs has what they do, a file for each.
///
/// long file: CLI11 takes 3.6 s to compile, so that the options of all verbs are in one file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "app/commands.h"
#include "app/demos.h"
#include "app/flags.h"
#include "app/verbs/calibrate.h"
#include "app/verbs/topic_export.h"
#include "base/math.h"
#include "base/text.h"
#include "base/units.h"
#include "formats/kind.h"
#include "run/snapshot_files.h"

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
    return Error{std::string(flag) + ": '" + text + "' is not a range",
                 "write the lower and the upper end: -1,1"};
  out = {low, high};
  return {};
}

// --- options of several verbs ---

void add_paths(CLI::App& verb, std::vector<std::string>& paths) {
  verb.add_option("--path", paths, "Folder to search for models and other files; may be given several times")
      ->allow_extra_args(false);
}

void add_sets(CLI::App& verb, std::vector<std::string>& sets) {
  verb.add_option("--set", sets, "Change the scenario before it is loaded: path=value")
      ->allow_extra_args(false);
}

void add_skip_missing(CLI::App& verb, bool& skip) {
  verb.add_flag("--skip-missing", skip,
                "Leave out, with a warning, files that a world names and that are not found: models, meshes, "
                "heightmaps");
}

void add_json(CLI::App& verb, bool& json) { verb.add_flag("--json", json, "Print as JSON"); }

/// Options of a server: --port, --address, --token, --tokens, --allow-origin, --udp.
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
    verb.add_option("--tokens", options.tokens_file,
                    "File with tokens of administrators, spectators, robots and teams; docs/clients.md");
    verb.add_option("--most-clients", options.most_clients,
                    "Clients and viewers that may be connected at once")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    verb.add_option("--most-per-address", options.most_per_address,
                    "Connections that another machine may have at once")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    verb.add_option(
            "--allow-origin", options.origins,
            "Another site whose pages may connect: https://app.example.org; may be given several times")
        ->allow_extra_args(false);
    verb.add_flag("--udp", options.udp, "Take clients by UDP, too, at the same port; docs/clients.md");
  }

  Status finish(std::optional<ServeOptions>& out) {
    if (port) {
      options.port = *port;
      out = options;
      return {};
    }
    if (!options.token.empty() || !options.tokens_file.empty() || !options.origins.empty() || options.udp ||
        options.address != ServeOptions().address)
      return Error{
          "--address, --token, --tokens, --allow-origin and --udp say who may look at the page, but there is "
          "none",
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
  CLI::Option* threads = nullptr;

  void add_to(CLI::App& verb) {
    CLI::Option* const without = verb.add_flag("--headless", headless, "Run without a page");
    serve.add_to(verb);
    verb.get_option("--port")->excludes(without);
    verb.add_flag("--paused", options.spec.paused, "Begin paused; with --port");
    verb.add_option("--command", options.spec.commands,
                    "A console line for the run, such as 'at 2s pose rover 1 2'; may be given several times")
        ->allow_extra_args(false);
    verb.add_option("--script", options.spec.script_file,
                    "File of console lines for the run, each as in --command");
    verb.add_option("--duration", duration.text,
                    "Simulated time after which the run ends, such as 30s or '2 min'");
    verb.add_option(
        "--rate", rate,
        "max: as fast as possible; 1: in real time; 0.5, 2 ...: that many times real time. If left "
        "out: max, with --port 1");
    verb.add_option("--seed", options.spec.seed, "Seed of all random numbers, instead of the scenario's");
    verb.add_option("--errors", options.spec.errors,
                    "Factor on the errors of all devices, in addition to factors in the scenario; 0: exact")
        ->check(CLI::Range(0.0, 1000.0));
    threads = verb.add_option("--threads", options.spec.threads,
                              "Threads; 0: as many as the machine has. The result does not depend on it")
                  ->check(CLI::Range(0, 1024))
                  ->capture_default_str();
    verb.add_option("--set", sets,
                    "Change the scenario before it is loaded: path=value, such as physics=planar or "
                    "'robots[0].pose=[1, 2, 0]'")
        ->allow_extra_args(false);
    add_paths(verb, options.spec.paths);
    verb.add_option("--summary", options.spec.summary_file, "Write the summary of the run as JSON");
    add_skip_missing(verb, options.spec.skip_missing);
    verb.add_option("--stop-when", options.spec.stop_when,
                    "End the run when this expression over addresses holds, such as 'rover.pose.x > 3'");
    verb.add_option("--log", options.spec.log_file, "Write values to this CSV file while it runs");
    verb.add_option("--log-values", log_values,
                    "Values to log: addresses and expressions with commas between them (docs/values.md)");
    verb.add_option("--log-rate", log_rate,
                    "Lines per simulated second, such as '10 Hz'; one per tick if left out");
    verb.add_option("--step-times", options.spec.step_times_file,
                    "Write the wall time of each tick to this CSV file");
    verb.add_option("--svg", options.spec.drawing_file,
                    "Draw the world from above with paths and last scans");
    verb.add_option("--snapshot", options.spec.snapshots.file,
                    "Write a snapshot: at the end, or at --snapshot-at");
    verb.add_option("--snapshot-at", snapshot_at.text, "Simulated time of the snapshot");
    verb.add_option("--snapshot-every", snapshot_every.text,
                    "Interval of simulated time at which further snapshots are written, such as 10s: the "
                    "--snapshot file with the time in its name");
    verb.add_option("--snapshot-keep", options.spec.snapshots.keep,
                    "Number of the latest --snapshot-every files that are kept; 0: all")
        ->check(CLI::Range(0, 1'000'000));
    verb.add_option("--record", options.spec.record_file, "Record the run as an MCAP file");
    verb.add_option("--record-topics", options.spec.record_topics,
                    "Record these topics only, such as '/rover/*'; may be given several times")
        ->allow_extra_args(false);
    verb.add_option("--record-compression", options.spec.record_compression,
                    "Compression of the recording's chunks")
        ->check(CLI::IsMember({"none", "lz4", "zstd"}));
    verb.add_option("--video", options.spec.film.file, "Film the run: an .mp4, .mov or .mkv file");
    verb.add_option("--camera", options.spec.film.view.camera,
                    "Camera of the film: a robot's camera (robot/device), follow:ROBOT for a view from "
                    "behind it, or overhead");
    verb.add_option("--video-size", video_size,
                    "Width and height, such as 640x480; 960x540 if left out. A robot's camera has its own");
    verb.add_option("--video-rate", options.spec.film.rate_hz,
                    "Pictures per simulated second, and per second of the film")
        ->check(CLI::Range(1, 240))
        ->capture_default_str();
    verb.add_flag("--watch", options.watch,
                  "Restart programs that the run has started when a file of theirs changes");
    verb.add_option("--program-logs", options.program_logs,
                    "Folder for what programs that the run has started print: a file for each");
    verb.add_flag("--json", options.json, "Print the summary as JSON");
  }

  Status finish() {
    SL_TRY(duration.read("--duration", options.spec.duration_s));
    SL_TRY(snapshot_at.read("--snapshot-at", options.spec.snapshots.at_s));
    SL_TRY(snapshot_every.read("--snapshot-every", options.spec.snapshots.every_s));
    SL_TRY(serve.finish(options.serve));
    SL_TRY(read_size("--video-size", video_size, options.spec.film.view));
    if (options.spec.paused && !options.serve)
      return Error{"--paused: nobody could let the run go on", "add --port 8765"};
    SL_TRY(read_rate(rate.empty() && options.serve ? "1" : rate, options.spec.rate));
    options.spec.log_values = split_list(log_values);
    if (threads->count() > 0) options.at_a_time = options.spec.threads;
    if (!log_rate.empty()) {
      auto hz = parse_quantity(log_rate, "Hz");
      if (!hz) return Error{"--log-rate: " + hz.error().what, hz.error().fix};
      if (!(*hz >= 0 && *hz <= 1e6))
        return Error{"--log-rate: must be in [0, 1e6] Hz, is " + number_text(*hz)};
      options.spec.log_rate_hz = *hz;
    }
    return read_sets(sets, options.spec.overrides);
  }
};

struct RenderFlags {
  RenderOptions options;
  DurationOption time;
  double fov_deg = 60;
  std::string size, from, at;
  std::vector<std::string> sets;
  bool overhead = false;

  void add_to(CLI::App& verb) {
    draw::ViewpointOptions& view = options.view;
    verb.add_option("file", options.file, "Scenario, world or robot")->required();
    verb.add_option("--out", options.out, "The picture: .png or .jpg")->required();
    verb.add_option("--camera", view.camera,
                    "A robot's camera (robot/device), or follow:ROBOT for a view from behind it");
    verb.add_option("--from", from, "Look from this point: x,y,z in metres");
    verb.add_option("--at", at, "Look at this point, with --from");
    verb.add_flag("--overhead", overhead, "Look from above at everything");
    verb.add_option("--fov", fov_deg, "Field of view across the picture, in degrees")
        ->check(CLI::Range(1.0, 170.0))
        ->capture_default_str();
    verb.add_option("--size", size,
                    "Width and height, such as 640x480; 960x540 if left out. A robot's camera has its own");
    verb.add_option("--time", time.text, "Simulated time of the picture, such as 3s; the start if left out");
    verb.add_option("--plane", view.plane,
                    "rgb; depth, labels or instances as colours. A robot's camera: name its topic instead")
        ->capture_default_str();
    verb.add_option("--samples", view.samples, "Rays per pixel: more, smoother edges")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    verb.add_flag("--shadows,!--no-shadows", view.shadows, "Lights cast shadows (the default)");
    add_sets(verb, sets);
    add_paths(verb, options.paths);
    add_skip_missing(verb, options.skip_missing);
  }

  Status finish() {
    std::optional<double> time_s;
    SL_TRY(time.read("--time", time_s));
    options.time_s = time_s.value_or(0);
    SL_TRY(read_sets(sets, options.overrides));
    options.view.fov_rad = fov_deg * math::pi / 180;
    SL_TRY(read_size("--size", size, options.view));
    SL_TRY(read_point("--from", from, options.view.from));
    SL_TRY(read_point("--at", at, options.view.at));
    if (overhead && !options.view.camera.empty())
      return Error{"--overhead and --camera are two views", "give one of them"};
    if (overhead) options.view.camera = "overhead";
    return {};
  }
};

/// Help with ranges and defaults in words: "--threads INT (0 to 1024; 1 if left out)".
class HelpText final : public CLI::Formatter {
 public:
  HelpText() { label("SUBCOMMAND", "VERB"); }
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    const std::string name = Formatter::make_option_name(option, is_positional);
    return name.substr(0, name.find('{'));  // "--shadows,--no-shadows{false}"
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text, notes;
    const auto note = [&](const std::string& each) { notes += (notes.empty() ? "" : "; ") + each; };
    if (option->get_type_size() != 0) {
      const std::string type = option->get_type_name();  // "INT:INT in [0 - 1024]", "TEXT:{none,lz4}"
      const std::size_t colon = type.find(':'), begin = type.find('['), middle = type.find(" - ");
      text = " " + type.substr(0, colon);
      if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
      if (begin < middle && middle != std::string::npos)
        note(type.substr(begin + 1, middle - begin - 1) + " to " +
             type.substr(middle + 3, type.find(']') - middle - 3));
      else if (colon != std::string::npos) note(type.substr(colon + 1));
      if (option->get_required()) note("required");
      if (!option->get_default_str().empty()) note(option->get_default_str() + " if left out");
    }
    for (const CLI::Option* other : option->get_excludes()) note("not with " + other->get_name());
    return notes.empty() ? text : text + " (" + notes + ")";
  }
};

/// What is wrong in a command line, and the nearest verb or option in place of an unknown one.
std::string usage_error(const CLI::App* app, const CLI::Error& error) {
  const CLI::App* verb = app;
  std::string name = "sandlot";
  while (!verb->get_subcommands().empty()) {
    verb = verb->get_subcommands().front();
    name += " " + verb->get_name();
  }
  const std::vector<const CLI::App*> verbs = verb->get_subcommands([](const CLI::App*) { return true; });
  const std::string help = name + " --help lists the " + (verbs.empty() ? "options" : "verbs");
  // An unknown word is the likely cause of whatever else is missing.
  const std::vector<std::string> unknown = app->remaining(true);
  for (const std::string& word : unknown) {
    std::vector<std::string> known;
    std::string what;
    if (starts_with(word, "-")) {
      what = "there is no option '" + word.substr(0, word.find('=')) + "'";
      for (const CLI::Option* option : verb->get_options())
        for (const std::string& each : option->get_lnames()) known.push_back("--" + each);
    } else if (!verbs.empty()) {
      what = "there is no verb '" + word + "'";
      for (const CLI::App* each : verbs) known.push_back(each->get_name());
    } else {
      continue;  // perhaps the value of an unknown option
    }
    const std::string near = nearest(word.substr(0, word.find('=')), known);
    return what + "; " + (near.empty() ? help : "did you mean '" + near + "'?");
  }
  if (!unknown.empty()) return "'" + unknown.front() + "' is one word too many; " + help;
  if (!verbs.empty()) return "a verb is needed; " + help;
  // The library's own words, where they leave open what would be right: "--errors: Value -1 not in range 0.000000 to 1.000000",
  // in newer versions "[0 - 1000]".
  const std::string what = error.what(), option = what.substr(0, what.find(':')), type = error.get_name();
  if (type == "ArgumentMismatch" && what.find(" missing") != std::string::npos)
    return option + " needs a value; " + help;
  if (type == "ArgumentMismatch" && what.find("At Most") != std::string::npos)
    return option + " is given more than once; " + help;
  const std::size_t value = what.find(": Value "), range = what.find(" not in range ");
  if (value < range && range != std::string::npos) {
    std::string limits = what.substr(range + 14);
    if (limits.starts_with('[') && limits.ends_with(']')) limits = limits.substr(1, limits.size() - 2);
    const bool dash = limits.find(" - ") != std::string::npos;
    const std::size_t between = limits.find(dash ? " - " : " to ");
    double low = 0, high = 0;
    if (between != std::string::npos && parse_number(limits.substr(0, between), low) &&
        parse_number(limits.substr(between + (dash ? 3 : 4)), high))
      return fmt::format("{}: must be in [{}, {}], is {}", option, number_text(low), number_text(high),
                         what.substr(value + 8, range - value - 8));
  }
  if (const std::size_t equals = what.find(" = "); type == "ConversionError" && equals != std::string::npos) {
    const std::size_t flag = what.find(": ") + 2;
    return what.substr(flag, equals - flag) + ": '" + what.substr(equals + 3) + "' is not a number; " + help;
  }
  return what + "; " + help;
}

}  // namespace

int sandlot::app::command(int argc, char** argv, const Hooks* hooks) {
  CLI::App app{"Sandlot simulates many mobile robots with real sensors, and gives the same answer twice.",
               "sandlot"};
  app.formatter(std::make_shared<HelpText>());
  app.require_subcommand(1);
  app.set_version_flag("--version", "sandlot " SANDLOT_VERSION);
  app.footer("Try: sandlot demo    Every verb explains itself: sandlot run --help");
  int result = exit_ok;

  RunFlags run_flags;
  CLI::App* const run_verb = app.add_subcommand("run", "Run a scenario, a world or a robot");
  run_verb->add_option("file", run_flags.options.spec.file,
                       "Scenario, world or robot: " + formats::known_extensions());
  run_verb->add_option("--from", run_flags.options.spec.from_file,
                       "Continue from a snapshot instead of a file");
  run_verb->add_flag("--allow-programs", run_flags.options.spec.allow_programs,
                     "With --from: start the programs that the snapshot names, in processes of their own");
  run_verb->add_option(
      "--repeat", run_flags.options.repeat,
      "Run it so many times, with one seed after the other, and print what all give together: mean, "
      "deviation, interval and success rate of its criteria. As many at a time as the machine has "
      "processors, or as --threads says");
  run_verb->add_option("--store", run_flags.options.store,
                       "With --repeat: SQLite file that keeps the result of each run. Seeds that are in it "
                       "are not run again, so an interrupted "
                       "series goes on");
  run_flags.add_to(*run_verb);
  run_flags.options.hooks = hooks;
  run_verb->footer(
      "Example: sandlot run scenarios/indoor.yaml --duration 60s --set physics=planar --svg run.svg");
  run_verb->callback([&] {
    if (Status status = run_flags.finish(); !status) result = complain(status.error());
    else result = run(run_flags.options);
  });

  RunFlags demo_flags;
  std::string demo_name = "demo";
  CLI::App* const demo_verb = app.add_subcommand("demo",
                                                 "Show a scenario that comes with Sandlot, on a page");
  demo_verb->add_option("name", demo_name, "Name of a file in scenarios/; list: print the names")
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
    demo_flags.options.spec.file = *file;
    result = run(demo_flags.options);
  });

  ConsoleOptions console_options;
  CLI::App* const console_verb = app.add_subcommand("console", "Talk to a run that was started with --port");
  console_verb->add_option("address", console_options.url,
                           "Port, HOST:PORT, or the address that the run printed; 8765 on this machine");
  console_verb
      ->add_option("--command", console_options.lines,
                   "Send this line instead of reading lines; may be given several times")
      ->allow_extra_args(false);
  console_verb->add_option("--script", console_options.script_file,
                           "Send the lines of a file; ends at the first that fails");
  console_verb->add_option("--token", console_options.token,
                           "Token of the run, where it has one; or SANDLOT_TOKEN in the environment");
  console_verb->add_flag("--json", console_options.json, "Answers as JSON, one object per line");
  console_verb->footer(
      "Exit code 0, 1 when a line failed, 2 when there is no run to talk to. docs/console.md has the "
      "commands.\n"
      "Example: sandlot console --command 'set */laser.noise.white 2 cm' --command 'show rover.pose.x'");
  console_verb->callback([&] { result = console(console_options); });

  RenderFlags render_flags;
  CLI::App* const render_verb = app.add_subcommand("render",
                                                   "Take a picture of a world, as a PNG or JPEG file");
  render_flags.add_to(*render_verb);
  render_verb->footer(
      "Example: sandlot render scenarios/msl_field.yaml --from -6,-9,5 --at 0,0,0 --out field.png\n"
      "         sandlot render scenarios/msl_field.yaml --camera follow:cyan4 --time 2s --size 640x480 --out "
      "cyan4.png\n"
      "         sandlot render scenarios/indoor.yaml --overhead --plane instances --out map.png");
  render_verb->callback([&] {
    const Status status = render_flags.finish();
    result = status ? render(render_flags.options) : complain(status.error());
  });

  FileOptions file_options;
  std::vector<std::string> file_sets;
  const auto add_file_verb = [&](const char* name, const char* help, const char* example,
                                 int (*act)(const FileOptions&)) -> CLI::App* {
    CLI::App* const verb = app.add_subcommand(name, help);
    verb->add_option("files", file_options.files, "Scenarios or worlds")->required();
    add_sets(*verb, file_sets);
    add_skip_missing(*verb, file_options.skip_missing);
    add_paths(*verb, file_options.paths);
    add_json(*verb, file_options.json);
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
  plot_verb->add_option("--x-range", plot_x_range, "Range of the horizontal axis: 0,10");
  plot_verb->add_option("--y-range", plot_y_range, "Range of the vertical axis: -1,1");
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
  replay_verb->add_option("--summary", replay_options.summary_file, "Write the result as JSON");
  replay_verb
      ->add_option("--path", replay_options.paths, "Folder to search for plugins; may be given several times")
      ->allow_extra_args(false);
  ServeFlags replay_serve;
  std::string replay_rate;
  replay_serve.add_to(*replay_verb);
  replay_verb->add_option("--rate", replay_rate, "With --port: 1 is real time; max: as fast as possible");
  add_json(*replay_verb, replay_options.json);
  replay_verb->footer("Example: sandlot replay r.mcap --verify\n         sandlot replay r.mcap --port 8765");
  replay_verb->callback([&] {
    Status status = until.read("--until", replay_options.until_s);
    if (status) status = replay_snapshot_at.read("--snapshot-at", replay_options.snapshots.at_s);
    if (status) status = check_snapshot_options(replay_options.snapshots);
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
  diff_verb->add_option("--limit", diff_options.limit, "Most values to show")->capture_default_str();
  diff_verb->add_option("--threads", diff_options.threads, "Threads; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  diff_verb
      ->add_option("--path", diff_options.paths, "Folder to search for plugins; may be given several times")
      ->allow_extra_args(false);
  add_json(*diff_verb, diff_options.json);
  diff_verb->footer(
      "Exit code 0: no difference in the ticks that both have, 1: a difference, 2: they cannot be compared.\n"
      "Example: sandlot diff a.mcap b.mcap");
  diff_verb->callback([&] { result = diff(diff_options); });

  ConvertOptions convert_options;
  CLI::App* const convert_verb = app.add_subcommand(
      "convert", "Turn URDF, SDF and scenarios into each other, by the extensions of the files");
  convert_verb->add_option("in", convert_options.in, "File to read: " + formats::known_extensions())
      ->required();
  convert_verb->add_option("out", convert_options.out, "File to write, in another format")->required();
  convert_verb->add_flag("--force", convert_options.force, "Replace the file when it exists");
  add_paths(*convert_verb, convert_options.paths);
  convert_verb->footer("Example: sandlot convert robot.urdf robot.sdf");
  convert_verb->callback([&] { result = convert(convert_options); });

  NewOptions new_options;
  CLI::App* const new_verb = app.add_subcommand("new",
                                                "Begin a project of your own, with a test: controller");
  new_verb->require_subcommand(1);
  new_verb->footer("Example: sandlot new controller wall --lang python");
  CLI::App* const new_controller_verb = new_verb->add_subcommand(
      "controller", "Write a program that drives a robot, a scenario for it, a test and a README");
  new_controller_verb->add_option("name", new_options.name, "Name: a letter, then letters, digits and _")
      ->required();
  new_controller_verb->add_option("--lang", new_options.language, "Language: python, js or cpp")->required();
  new_controller_verb->add_option("--out", new_options.out,
                                  "Folder to write into; one with the name if left out. Files that exist are "
                                  "never replaced");
  new_controller_verb->footer("Example: sandlot new controller wall --lang python");
  new_controller_verb->callback([&] { result = new_controller(new_options); });

  CalibrateOptions calibrate_options;
  std::vector<std::string> calibrate_sets;
  CLI::App* const calibrate_verb = app.add_subcommand(
      "calibrate", "Measure the errors of a detector in a camera's pictures, as keys of its level `objects`");
  calibrate_verb
      ->add_option("file", calibrate_options.file, "Scenario with the camera and objects to be seen")
      ->required();
  calibrate_verb->add_option("--camera", calibrate_options.camera, "The camera: robot/device")->required();
  calibrate_verb->add_option("--samples", calibrate_options.samples, "Pictures")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  calibrate_verb
      ->add_option("--label", calibrate_options.labels,
                   "Label of the objects to use; may be given several times")
      ->allow_extra_args(false);
  calibrate_verb
      ->add_option("--max-range", calibrate_options.max_range_m,
                   "Largest distance at which objects are placed, in metres")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  calibrate_verb
      ->add_option("--detector", calibrate_options.detector,
                   "picture: finds objects by their colours; objects: the camera's level `objects` itself")
      ->check(CLI::IsMember({"picture", "objects"}))
      ->capture_default_str();
  calibrate_verb->add_flag("--as-it-runs", calibrate_options.as_it_runs,
                           "Let the scenario run with its controllers instead of placing objects at random");
  calibrate_verb->add_option("--seed", calibrate_options.seed,
                             "Seed of all random numbers, instead of the scenario's");
  add_sets(*calibrate_verb, calibrate_sets);
  add_paths(*calibrate_verb, calibrate_options.paths);
  calibrate_verb->add_option("--out", calibrate_options.out,
                             "Write the keys to this file, which a scenario can include");
  calibrate_verb->add_option(
      "--pictures", calibrate_options.pictures,
      "Folder for the first twelve pictures: frames around detections, crosses at the true positions");
  add_json(*calibrate_verb, calibrate_options.json);
  calibrate_verb->footer(
      "Exit code 0: measured, 1: there was nothing to be seen, 2: the input is wrong.\n"
      "Example: sandlot calibrate scenarios/ball.yaml --camera seeker/eye --samples 500 --out eye.yaml");
  calibrate_verb->callback([&] {
    const Status sets = read_sets(calibrate_sets, calibrate_options.overrides);
    result = sets ? calibrate(calibrate_options) : complain(sets.error());
  });

  ListOptions list_options;
  CLI::App* const list_verb = app.add_subcommand("list",
                                                 "List the kinds of devices, controllers, engines, noise and "
                                                 "file formats, message types, and Gazebo plugins");
  list_verb->add_option("what", list_options.what,
                        "devices, controllers, programs, media, rules, markers, engines, noise, image_noise, "
                        "depth_noise, faults, "
                        "builders, formats (all of these if left out), levels, messages or plugins");
  list_verb->add_option("names", list_options.names,
                        "Only the kinds of these names, or message types: as with --verbose");
  list_verb->add_flag("--verbose", list_options.verbose,
                      "Print every field with unit, range, default and meaning");
  add_json(*list_verb, list_options.json);
  list_verb->add_flag("--markdown", list_options.markdown, "Print as the reference page of the docs");
  list_verb->add_flag("--schema", list_options.schema, "Print the JSON schema of scenario files");
  list_verb
      ->add_option("--plugin", list_options.plugins,
                   "Shared library whose controllers are listed too; may be given several times")
      ->allow_extra_args(false);
  list_verb->footer("Example: sandlot list devices camera");
  list_verb->callback([&] { result = list(list_options); });

  BenchOptions bench_options;
  CLI::App* const bench_verb = app.add_subcommand("bench",
                                                  "Measure Sandlot against references in the same run");
  bench_verb->add_option(
      "suite", bench_options.suite,
      "physics, wheels, pile, swarm, rays, images, loading, recording, viewer, rollers or levels; all when "
      "left out");
  bench_verb->add_flag(
      "--guard", bench_options.guard,
      "Fail when a ratio is over twice its budget, twice in a row; for machines that test changes");
  add_json(*bench_verb, bench_options.json);
  bench_verb->footer("Example: sandlot bench rays --json");
  bench_verb->callback([&] { result = bench(bench_options); });

  ValidateOptions validate_options;
  CLI::App* const validate_verb = app.add_subcommand("validate",
                                                     "Run experiments whose results theory predicts");
  validate_verb->add_option("name", validate_options.name, "One experiment; all when left out");
  validate_verb->add_option("--out", validate_options.out,
                            "Folder to write validation.md and its figures into");
  add_json(*validate_verb, validate_options.json);
  validate_verb->footer("Example: sandlot validate friction");
  validate_verb->callback([&] { result = validate(validate_options); });

  ReproduceOptions reproduce_options;
  CLI::App* const reproduce_verb = app.add_subcommand(
      "reproduce", "Make the experiment of a paper, its figures and tables beside the paper's statements");
  reproduce_verb->add_option("paper", reproduce_options.paper, "Name of the paper: cooperation, msl")
      ->required();
  reproduce_verb
      ->add_option("--out", reproduce_options.out, "Folder to write index.html and the tables (CSV) into")
      ->required();
  reproduce_verb->add_option("--repeat", reproduce_options.repeat,
                             "Runs of each condition, with seeds that follow each other");
  reproduce_verb
      ->add_option("--at-a-time", reproduce_options.at_a_time,
                   "Runs at the same time; as many as the machine has processors if left out")
      ->check(CLI::NonNegativeNumber);
  reproduce_verb->add_option(
      "--traces", reproduce_options.traces,
      "msl: files of `run --step-times` to use instead of runs; may be given several times");
  reproduce_verb->footer(
      "Example: sandlot reproduce cooperation --out report\n         sandlot reproduce msl --out report");
  reproduce_verb->callback([&] { result = reproduce(reproduce_options); });

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
    if (act == topic_echo)
      verb->add_option("--count", recording_options.count, "Number of messages after which to end");
    add_json(*verb, recording_options.json);
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
  add_topic_verb("hz", "Rates of messages", "Example: sandlot topic hz run.mcap", false, topic_hz);

  ExportOptions export_options;
  std::string export_values;
  CLI::App* const export_verb = topic_verb->add_subcommand("export", "Write numbers of a recording as CSV");
  export_verb->add_option("file", export_options.recording, "The recording, an MCAP file")->required();
  export_verb
      ->add_option("--values", export_values,
                   "Numbers, separated by commas: /topic.path, or a topic for all numbers in it")
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
                        "Print what would be done to the recording, without doing it");
  add_json(*doctor_verb, doctor_json);
  doctor_verb->footer(
      "Exit code 0: whole, or repaired; 1: not whole (--dry-run); 2: no recording.\n"
      "Example: sandlot doctor run.mcap");
  doctor_verb->callback([&] {
    recording_options.json = doctor_json;
    result = recording_options.file.empty() ? doctor(doctor_json) : doctor_file(recording_options);
  });

  for (CLI::App* const verb : app.get_subcommands([](CLI::App*) { return true; })) verb->group("Verbs");
  for (CLI::App* const group : {topic_verb, new_verb})
    for (CLI::App* const verb : group->get_subcommands([](CLI::App*) { return true; })) verb->group("Verbs");
  app.failure_message([](const CLI::App* program, const CLI::Error& error) {
    return fmt::format("error: {}\n", usage_error(program, error));
  });
  try {
    // `sandlot help run` is `sandlot run --help`.
    std::vector<char*> words(argv, argv + argc);
    std::string help = "--help";
    if (argc > 1 && std::string_view(argv[1]) == "help") {
      words.erase(words.begin() + 1);
      words.push_back(help.data());
    }
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_ok : exit_bad_input;
  } catch (const std::system_error& error) {
    // fmt::print() throws when the output takes no more, which finish_output() reports. Whatever else throws must not
    // end the program without a word.
    if (!std::ferror(stdout)) std::fprintf(stderr, "error: %s\n", error.what());
    return finish_output(exit_failed);
  }
  return finish_output(result);
}
