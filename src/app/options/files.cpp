/// Options of the verbs about scenarios, worlds and models: check, info, convert, calibrate.
#include <CLI/CLI.hpp>

#include "app/flags.h"
#include "app/options/options.h"
#include "app/options/shared.h"
#include "app/verbs/calibrate.h"
#include "formats/kind.h"

namespace sandlot::app {
namespace {

/// A verb about files, with the options that all of these have.
CLI::App& add_file_verb(CommandLine& line, FileOptions& options, const char* name, const char* help,
                        const char* example, int (*act)(const FileOptions&)) {
  auto& sets = line.keep<std::vector<std::string>>();
  CLI::App* const verb = line.app.add_subcommand(name, help);
  verb->add_option("files", options.files, "Scenarios or worlds")->required();
  add_sets(*verb, sets);
  add_skip_missing(*verb, options.skip_missing);
  add_paths(*verb, options.paths);
  add_json(*verb, options.json);
  verb->footer(example);
  verb->callback([&line, &options, &sets, act] {
    if (Status status = read_sets(sets, options.overrides); !status) line.result = complain(status.error());
    else line.result = act(options);
  });
  return *verb;
}

}  // namespace

void add_check(CommandLine& line) {
  FileOptions& options = line.keep<FileOptions>();
  add_file_verb(line, options, "check", "Find what is wrong or suspicious in files, with line and remedy",
                "Exit code 2 when a file is wrong, 0 when there are only warnings.\n"
                "Example: sandlot check --strict scenarios/*.yaml",
                check)
      .add_flag("--strict", options.strict, "Warnings count as errors: exit code 2");
}

void add_info(CommandLine& line) {
  FileOptions& options = line.keep<FileOptions>();
  add_file_verb(line, options, "info",
                "Print the tree of a scenario, world or snapshot: links, joints, devices, topics",
                "Example: sandlot info scenarios/indoor.yaml", info)
      .add_flag("--values", options.values,
                "Print the address of every value instead, with unit and value at the start");
}

void add_convert(CommandLine& line) {
  ConvertOptions& options = line.keep<ConvertOptions>();
  CLI::App* const verb = line.app.add_subcommand(
      "convert", "Turn URDF, SDF and scenarios into each other, by the extensions of the files");
  verb->add_option("in", options.in, "File to read: " + formats::known_extensions())->required();
  verb->add_option("out", options.out, "File to write, in another format")->required();
  verb->add_flag("--force", options.force, "Replace the file when it exists");
  add_paths(*verb, options.paths);
  verb->footer("Example: sandlot convert robot.urdf robot.sdf");
  verb->callback([&line, &options] { line.result = convert(options); });
}

void add_calibrate(CommandLine& line) {
  CalibrateOptions& options = line.keep<CalibrateOptions>();
  auto& sets = line.keep<std::vector<std::string>>();
  CLI::App* const verb = line.app.add_subcommand(
      "calibrate", "Measure the errors of a detector in a camera's pictures, as keys of its level `objects`");
  verb->add_option("file", options.file, "Scenario with the camera and objects to be seen")->required();
  verb->add_option("--camera", options.camera, "The camera: robot/device")->required();
  verb->add_option("--samples", options.samples, "Pictures")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_option("--label", options.labels, "Label of the objects to use; may be given several times")
      ->allow_extra_args(false);
  verb->add_option("--max-range", options.max_range_m,
                   "Largest distance at which objects are placed, in metres")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  verb->add_option("--detector", options.detector,
                   "picture: finds objects by their colours; objects: the camera's level `objects` itself")
      ->check(CLI::IsMember({"picture", "objects"}))
      ->capture_default_str();
  verb->add_flag("--as-it-runs", options.as_it_runs,
                 "Let the scenario run with its controllers instead of placing objects at random");
  verb->add_option("--seed", options.seed, "Seed of all random numbers, instead of the scenario's");
  add_sets(*verb, sets);
  add_paths(*verb, options.paths);
  verb->add_option("--out", options.out, "Write the keys to this file, which a scenario can include");
  verb->add_option(
      "--pictures", options.pictures,
      "Folder for the first twelve pictures: frames around detections, crosses at the true positions");
  add_json(*verb, options.json);
  verb->footer(
      "Exit code 0: measured, 1: there was nothing to be seen, 2: the input is wrong.\n"
      "Example: sandlot calibrate scenarios/ball.yaml --camera seeker/eye --samples 500 --out eye.yaml");
  verb->callback([&line, &options, &sets] {
    const Status status = read_sets(sets, options.overrides);
    line.result = status ? calibrate(options) : complain(status.error());
  });
}

}  // namespace sandlot::app
