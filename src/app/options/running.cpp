/// Options of the verbs that run something, or talk to a run: run, demo, console.
#include <CLI/CLI.hpp>

#include "app/flags.h"
#include "app/match.h"
#include "app/options/options.h"
#include "app/options/shared.h"
#include "base/text.h"
#include "base/units.h"
#include "formats/kind.h"

namespace sandlot::app {
namespace {

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
    verb.add_flag("--refbox{127.0.0.1:28097}", options.refbox.at,
                  "Be a referee box for base stations of the middle-size league: --refbox or "
                  "--refbox=ADDRESS:PORT (docs/referee_box.md)");
    verb.add_option(
        "--refbox-teams", options.refbox.teams,
        "Addresses of the teams' base stations, such as cyan=127.0.0.2,magenta=172.16.39.*; if left "
        "out, who comes first is cyan");
    verb.add_option("--refbox-protocol", options.refbox.protocols,
                    "Protocol of the base stations: json, 2009 or cyan=2009,magenta=json; json if left out");
    verb.add_flag("--paused", options.spec.paused, "Begin paused; with --port");
    verb.add_flag(
        "--verbose", options.verbose,
        "Explain what is probably wrong in the world, as `sandlot check` does; also in the log of the page");
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
        "out: max, with --port or --refbox 1");
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
    verb.add_option(
            "--agent-log", options.spec.agent_logs,
            "Write the values of an agent that learns to a text file: ROBOT/CONTROLLER=FILE; may be given "
            "several times")
        ->allow_extra_args(false);
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
    verb.add_option("--video-rate", options.spec.film.rate_hz, "Pictures per second of the film")
        ->check(CLI::Range(1, 240))
        ->capture_default_str();
    verb.add_option(
            "--video-speed", options.spec.film.speed,
            "Simulated seconds per second of the film: below 1 slow motion, with pictures between the "
            "steps, above 1 time lapse")
        ->check(CLI::Range(0.001, 1000.0))
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
    const bool has_refbox = !options.refbox.at.empty();
    if (!has_refbox && !(options.refbox.teams.empty() && options.refbox.protocols.empty()))
      return Error{"--refbox-teams and --refbox-protocol are for a referee box, but there is none",
                   "add --refbox"};
    SL_TRY(read_rate(rate.empty() && (options.serve || has_refbox) ? "1" : rate, options.spec.rate));
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

}  // namespace

void add_run(CommandLine& line) {
  RunFlags& flags = line.keep<RunFlags>();
  CLI::App* const verb = line.app.add_subcommand("run", "Run a scenario, a world or a robot");
  verb->add_option("file", flags.options.spec.file,
                   "Scenario, world or robot: " + formats::known_extensions());
  verb->add_option("--from", flags.options.spec.from_file, "Continue from a snapshot instead of a file");
  verb->add_flag("--allow-programs", flags.options.spec.allow_programs,
                 "With --from: start the programs that the snapshot names, in processes of their own");
  verb->add_option(
      "--repeat", flags.options.repeat,
      "Run it so many times, with one seed after the other, and print what all give together: mean, "
      "deviation, interval and success rate of its criteria. As many at a time as the machine has "
      "processors, or as --threads says");
  verb->add_option("--store", flags.options.store,
                   "With --repeat: SQLite file that keeps the result of each run. Seeds that are in it "
                   "are not run again, so an interrupted "
                   "series goes on");
  flags.add_to(*verb);
  flags.options.hooks = line.hooks;
  verb->footer(
      "Example: sandlot run scenarios/indoor.yaml --duration 60s --set physics=planar --svg run.svg");
  verb->callback([&line, &flags] {
    if (Status status = flags.finish(); !status) line.result = complain(status.error());
    else line.result = run(flags.options);
  });
}

void add_demo(CommandLine& line) {
  RunFlags& flags = line.keep<RunFlags>();
  std::string& name = line.keep<std::string>();
  CLI::App* const verb = line.app.add_subcommand(
      "demo", "Show a match of robot soccer, or another scenario that comes with Sandlot, on a page");
  verb->add_option("name", name,
                   "Name of a file in scenarios/; list: print the names; left out: a match, at the level of "
                   "detail that this machine runs in real time");
  flags.add_to(*verb);
  verb->footer(
      "Example: sandlot demo                                     and open the page it names\n"
      "         sandlot demo yard                                a yard full of robots\n"
      "         sandlot demo indoor --headless --duration 20s    only the summary");
  verb->callback([&line, &flags, &name] {
    ServeFlags& serve = flags.serve;
    // The usual port, or one near it: a demo should begin.
    if (!serve.port && !flags.headless) serve.port = 8765, serve.options.next_free = true;
    Status status = flags.finish();
    if (!status) return void(line.result = complain(status.error()));
    line.result = demo({name, flags.options});
  });
}

void add_match(CommandLine& line) {
  RunFlags& flags = line.keep<RunFlags>();
  MatchSpec& spec = line.keep<MatchSpec>();
  CLI::App* const verb = line.app.add_subcommand("match",
                                                 "Play two teams of robot soccer against each other");
  verb->add_option("first", spec.teams[0], "Folder of the team that begins at negative x, with a team.yaml")
      ->required();
  verb->add_option("second", spec.teams[1], "Folder of the other team")->required();
  verb->add_option("--level", spec.sense, "Level of the robots' senses")
      ->check(CLI::IsMember({"image", "objects", "world"}));
  verb->add_option("--drive", spec.drive, "Level of the robots' drives")
      ->check(CLI::IsMember({"ideal", "contact", "roller"}));
  verb->add_option("--physics", spec.engine, "Engine: planar knows no lobs and no rollers")
      ->check(CLI::IsMember({"rigid", "planar"}));
  verb->add_option("--size", spec.size, "Size of the field in metres")
      ->check(CLI::IsMember({"22x14", "18x12", "12x8"}));
  verb->add_flag("--swap", spec.swap, "Exchange the sides");
  flags.add_to(*verb);
  verb->get_option("--duration")
      ->description("Time of play in both halves together, such as '4 min'; the scenario's if left out");
  verb->footer(
      "Example: sandlot match teams/passing teams/run_and_kick --duration '4 min' --record match.mcap\n"
      "         sandlot match teams/passing my_team --port 8765      and open the page it names");
  verb->callback([&line, &flags, &spec] {
    Status status = flags.finish();
    if (status) status = read_half(flags.duration, spec.half_s);
    if (!status) return void(line.result = complain(status.error()));
    spec.run = flags.options;
    spec.run.spec.duration_s.reset();  // that of the game, not of the run: the clock may stand
    line.result = match(spec);
  });
}

void add_console(CommandLine& line) {
  ConsoleOptions& options = line.keep<ConsoleOptions>();
  CLI::App* const verb = line.app.add_subcommand("console", "Talk to a run that was started with --port");
  verb->add_option("address", options.url,
                   "Port, HOST:PORT, or the address that the run printed; 8765 on this machine");
  verb->add_option("--command", options.lines,
                   "Send this line instead of reading lines; may be given several times")
      ->allow_extra_args(false);
  verb->add_option("--script", options.script_file, "Send the lines of a file; ends at the first that fails");
  verb->add_option("--token", options.token,
                   "Token of the run, where it has one; or SANDLOT_TOKEN in the environment");
  verb->add_flag("--json", options.json, "Answers as JSON, one object per line");
  verb->footer(
      "Exit code 0, 1 when a line failed, 2 when there is no run to talk to. docs/console.md has the "
      "commands.\n"
      "Example: sandlot console --command 'set */laser.noise.white 2 cm' --command 'show rover.pose.x'");
  verb->callback([&line, &options] { line.result = console(options); });
}

}  // namespace sandlot::app
