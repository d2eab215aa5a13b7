/// Options of the verbs about recordings and snapshots: replay, diff, fit, topic, doctor.
#include <CLI/CLI.hpp>

#include "app/flags.h"
#include "app/options/options.h"
#include "app/options/shared.h"
#include "app/verbs/fit.h"
#include "app/verbs/topic_export.h"
#include "run/snapshot_files.h"

namespace sandlot::app {
namespace {

struct TopicFlags {
  RecordingOptions options;
  DurationOption from, to;
};

void add_topic_verb(CommandLine& line, CLI::App& topic_verb, const char* name, const char* help,
                    const char* example, bool needs_topic, int (*act)(const RecordingOptions&)) {
  TopicFlags& flags = line.keep<TopicFlags>();
  RecordingOptions& options = flags.options;
  CLI::App* const verb = topic_verb.add_subcommand(name, help);
  verb->add_option("file", options.file, "The recording, an MCAP file")->required();
  if (act != topic_list) {
    CLI::Option* const topic = verb->add_option("topic", options.topic, "Name of the topic");
    if (needs_topic) topic->required();
    verb->add_option("--from", flags.from.text, "Begin at this time of the recording");
    verb->add_option("--to", flags.to.text, "End after this time");
  }
  if (act == topic_echo) verb->add_option("--count", options.count, "Number of messages after which to end");
  add_json(*verb, options.json);
  verb->footer(example);
  verb->callback([&line, &flags, act] {
    Status status = flags.from.read("--from", flags.options.from_s);
    if (status) status = flags.to.read("--to", flags.options.to_s);
    line.result = status ? act(flags.options) : complain(status.error());
  });
}

struct FitFlags {
  FitOptions options;
  DurationOption from, to;
  std::vector<std::string> sets;
};

struct ExportFlags {
  ExportOptions options;
  DurationOption from, to;
  std::string values;
};

void add_export(CommandLine& line, CLI::App& topic_verb) {
  ExportFlags& flags = line.keep<ExportFlags>();
  CLI::App* const verb = topic_verb.add_subcommand("export", "Write numbers of a recording as CSV");
  verb->add_option("file", flags.options.recording, "The recording, an MCAP file")->required();
  verb->add_option("--values", flags.values,
                   "Numbers, separated by commas: /topic.path, or a topic for all numbers in it")
      ->required();
  verb->add_option("--out", flags.options.out, "The CSV file")->required();
  verb->add_option("--from", flags.from.text, "Begin at this time of the recording");
  verb->add_option("--to", flags.to.text, "End after this time");
  verb->footer(
      "Example: sandlot topic export run.mcap --values '/rover/laser/ranges.ranges[90],/tf' --out run.csv");
  verb->callback([&line, &flags] {
    flags.options.values = split_list(flags.values);
    Status status = flags.from.read("--from", flags.options.from_s);
    if (status) status = flags.to.read("--to", flags.options.to_s);
    line.result = status ? topic_export(flags.options) : complain(status.error());
  });
}

struct ReplayFlags {
  ReplayOptions options;
  DurationOption until, from, snapshot_at;
  bool recompute = false;
  ServeFlags serve;
  std::string rate;

  Status finish() {
    SL_TRY(until.read("--until", options.until_s));
    SL_TRY(from.read("--from", options.from_s));
    SL_TRY(snapshot_at.read("--snapshot-at", options.snapshots.at_s));
    SL_TRY(check_snapshot_options(options.snapshots));
    SL_TRY(serve.finish(options.serve));
    SL_TRY(read_rate(rate.empty() ? "1" : rate, options.rate));
    if (options.from_s && !options.serve)
      return Error{"--from is for looking at the recording", "add --port 8765"};
    if (!rate.empty() && !options.serve)
      return Error{"--rate is for looking at the recording", "add --port 8765"};
    return {};
  }
};

}  // namespace

void add_replay(CommandLine& line) {
  ReplayFlags& flags = line.keep<ReplayFlags>();
  ReplayOptions& options = flags.options;
  CLI::App* const verb = line.app.add_subcommand("replay", "Run a recording again, and prove it");
  verb->add_option("file", options.file, "Recording (.mcap)")->required();
  verb->add_flag("--verify", options.verify, "Compare every tick; exit code 1 at the first difference");
  CLI::Option* const recompute_flag = verb->add_flag("--recompute", flags.recompute,
                                                     "Controllers run again (unless --logged)");
  verb->add_flag("--logged", options.logged, "Controllers do not run: their orders come from the log")
      ->excludes(recompute_flag);
  verb->add_option("--until", flags.until.text, "Simulated time at which to end, such as 10s");
  verb->add_option("--from", flags.from.text,
                   "With --port: simulated time to begin at, paused, such as '62.5 s'");
  verb->add_option("--threads", options.threads, "Threads; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("--snapshot", options.snapshots.file, "Write a snapshot: at the end, or at --snapshot-at");
  verb->add_option("--snapshot-at", flags.snapshot_at.text, "Simulated time of the snapshot");
  verb->add_option("--summary", options.summary_file, "Write the result as JSON");
  verb->add_option("--path", options.paths, "Folder to search for plugins; may be given several times")
      ->allow_extra_args(false);
  flags.serve.add_to(*verb);
  verb->add_option("--rate", flags.rate, "With --port: 1 is real time; max: as fast as possible");
  add_json(*verb, options.json);
  verb->footer(
      "Example: sandlot replay r.mcap --verify\n         sandlot replay r.mcap --port 8765\n         sandlot "
      "replay r.mcap --port 8765 --from 60s");
  verb->callback([&line, &flags] {
    const Status status = flags.finish();
    line.result = status ? replay(flags.options) : complain(status.error());
  });
}

void add_diff(CommandLine& line) {
  DiffOptions& options = line.keep<DiffOptions>();
  CLI::App* const verb = line.app.add_subcommand("diff",
                                                 "Find where two recordings or snapshots begin to differ");
  verb->add_option("a", options.a, "Recording (.mcap) or snapshot")->required();
  verb->add_option("b", options.b, "Recording (.mcap) or snapshot")->required();
  verb->add_option("--limit", options.limit, "Most values to show")->capture_default_str();
  verb->add_option("--threads", options.threads, "Threads; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("--path", options.paths, "Folder to search for plugins; may be given several times")
      ->allow_extra_args(false);
  add_json(*verb, options.json);
  verb->footer(
      "Exit code 0: no difference in the ticks that both have, 1: a difference, 2: they cannot be compared.\n"
      "Example: sandlot diff a.mcap b.mcap");
  verb->callback([&line, &options] { line.result = diff(options); });
}

void add_fit(CommandLine& line) {
  FitFlags& flags = line.keep<FitFlags>();
  FitOptions& options = flags.options;
  CLI::App* const verb = line.app.add_subcommand("fit",
                                                 "Find the parameters with which a recorded run is met");
  verb->add_option("file", options.file, "The scenario that was recorded")->required();
  verb->add_option("--recording", options.recording,
                   "The recording, an MCAP file; or a table of a real robot's run, a CSV file with a column "
                   "'time' in seconds")
      ->required();
  verb->add_option("--parameter", options.parameters,
                   "Address, as for --set, and limits of a parameter: ADDRESS=LOW:HIGH, with :log on a "
                   "logarithmic scale; may be given several times")
      ->allow_extra_args(false)
      ->required();
  verb->add_option(
          "--compare", options.compare,
          "Number of a topic and its scale: TOPIC.FIELD[:SCALE]; may be given several times; left out: "
          "speeds of motors and odometry. With a table VALUE=COLUMN[:SCALE], such as "
          "cart.joints.left_wheel_joint.velocity=speed")
      ->allow_extra_args(false);
  verb->add_option("--runs", options.runs, "Most runs")->check(CLI::Range(2, 100000))->capture_default_str();
  verb->add_option("--screening", options.screening, "Runs all over the limits before the search")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  verb->add_option("--from", flags.from.text, "Compare from this time of the recording");
  verb->add_option("--to", flags.to.text, "Compare up to this time");
  verb->add_option("--out", options.out, "File for the values, as --set words");
  add_sets(*verb, flags.sets);
  add_paths(*verb, options.paths);
  add_json(*verb, options.json);
  verb->footer(
      "Exit code 0: converged, 1: ended before, 2: the input is wrong. --set of a parameter is where it "
      "starts.\n"
      "Example: sandlot fit scenarios/motor_ramp.yaml --recording run.mcap --parameter "
      "robots[0].devices.left_motor.velocity.p=0.1:10:log");
  verb->callback([&line, &flags] {
    Status status = flags.from.read("--from", flags.options.from_s);
    if (status) status = flags.to.read("--to", flags.options.to_s);
    if (status) status = read_sets(flags.sets, flags.options.overrides);
    line.result = status ? fit(flags.options) : complain(status.error());
  });
}

void add_topic(CommandLine& line) {
  CLI::App* const verb = line.app.add_subcommand("topic", "Look into a recording: list, echo, hz, export");
  verb->require_subcommand(1);
  verb->footer("Example: sandlot topic list run.mcap");
  add_topic_verb(line, *verb, "list", "The topics of a recording with types and counts",
                 "Example: sandlot topic list run.mcap", false, topic_list);
  add_topic_verb(line, *verb, "echo", "Print the messages of a topic",
                 "Example: sandlot topic echo run.mcap /rover/laser/ranges --from 2s --count 1", true,
                 topic_echo);
  add_topic_verb(line, *verb, "hz", "Rates of messages", "Example: sandlot topic hz run.mcap", false,
                 topic_hz);
  add_export(line, *verb);
}

void add_doctor(CommandLine& line) {
  RecordingOptions& options = line.keep<RecordingOptions>();
  CLI::App* const verb = line.app.add_subcommand(
      "doctor", "Check this build and machine, or check a recording and repair it when it is not whole");
  verb->add_option("file", options.file,
                   "A recording (MCAP) or a snapshot; this build and machine if left out");
  verb->add_flag("--dry-run", options.dry_run, "Print what would be done to the recording, without doing it");
  add_json(*verb, options.json);
  verb->footer(
      "Exit code 0: whole, or repaired; 1: not whole (--dry-run); 2: no recording.\n"
      "Example: sandlot doctor run.mcap");
  verb->callback([&line, &options] {
    line.result = options.file.empty() ? doctor(options.json) : doctor_file(options);
  });
}

}  // namespace sandlot::app
