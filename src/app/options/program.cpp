/// Options of the verbs about the program itself: new, list, bench, validate, reproduce.
#include <CLI/CLI.hpp>

#include "app/options/options.h"
#include "app/options/shared.h"

namespace sandlot::app {

void add_new(CommandLine& line) {
  NewOptions& options = line.keep<NewOptions>();
  CLI::App* const new_verb = line.app.add_subcommand("new",
                                                     "Begin a project of your own, with a test: controller");
  new_verb->require_subcommand(1);
  new_verb->footer("Example: sandlot new controller wall --lang python");
  CLI::App* const controller_verb = new_verb->add_subcommand(
      "controller", "Write a program that drives a robot, a scenario for it, a test and a README");
  controller_verb->add_option("name", options.name, "Name: a letter, then letters, digits and _")->required();
  controller_verb
      ->add_option("--lang", options.language,
                   "Language: python, js or cpp; robios: a program of EyeBot in C")
      ->required();
  controller_verb->add_option("--out", options.out,
                              "Folder to write into; one with the name if left out. Files that exist are "
                              "never replaced");
  controller_verb->footer("Example: sandlot new controller wall --lang python");
  controller_verb->callback([&line, &options] { line.result = new_controller(options); });
}

void add_list(CommandLine& line) {
  ListOptions& options = line.keep<ListOptions>();
  CLI::App* const verb = line.app.add_subcommand("list",
                                                 "List the kinds of devices, controllers, engines, noise and "
                                                 "file formats, message types, and Gazebo plugins");
  verb->add_option(
      "what", options.what,
      "devices, controllers, programs, media, rules, markers, engines, noise, image_noise, "
      "depth_noise, faults, "
      "distributions, builders, formats (all of these if left out), levels, messages or plugins");
  verb->add_option("names", options.names,
                   "Only the kinds of these names, or message types: as with --verbose");
  verb->add_flag("--verbose", options.verbose, "Print every field with unit, range, default and meaning");
  add_json(*verb, options.json);
  verb->add_flag("--markdown", options.markdown, "Print as the reference page of the docs");
  verb->add_flag("--schema", options.schema, "Print the JSON schema of scenario files");
  verb->add_option("--plugin", options.plugins,
                   "Shared library whose controllers are listed too; may be given several times")
      ->allow_extra_args(false);
  verb->footer("Example: sandlot list devices camera");
  verb->callback([&line, &options] { line.result = list(options); });
}

void add_bench(CommandLine& line) {
  BenchOptions& options = line.keep<BenchOptions>();
  CLI::App* const verb = line.app.add_subcommand("bench",
                                                 "Measure Sandlot against references in the same run");
  verb->add_option("suite", options.suite,
                   "physics, wheels, pile, swarm, rays, images, loading, recording, viewer, rollers, levels, "
                   "radio, lockstep, robios, match or sox; "
                   "all when left out");
  verb->add_flag(
      "--guard", options.guard,
      "Fail when a ratio is over twice its budget, twice in a row; for machines that test changes");
  add_json(*verb, options.json);
  verb->footer("Example: sandlot bench rays --json");
  verb->callback([&line, &options] { line.result = bench(options); });
}

void add_validate(CommandLine& line) {
  ValidateOptions& options = line.keep<ValidateOptions>();
  CLI::App* const verb = line.app.add_subcommand("validate", "Run experiments whose results theory predicts");
  verb->add_option("name", options.name, "One experiment; all when left out");
  verb->add_option("--out", options.out, "Folder to write validation.md and its figures into");
  add_json(*verb, options.json);
  verb->footer("Example: sandlot validate friction");
  verb->callback([&line, &options] { line.result = validate(options); });
}

void add_reproduce(CommandLine& line) {
  ReproduceOptions& options = line.keep<ReproduceOptions>();
  CLI::App* const verb = line.app.add_subcommand(
      "reproduce", "Make the experiment of a paper, its figures and tables beside the paper's statements");
  verb->add_option("paper", options.paper, "Name of the paper: cooperation, eyesim, lpzrobots, mario, msl")
      ->required();
  verb->add_option("--out", options.out, "Folder to write index.html and its data (CSV, JSON, SVG) into")
      ->required();
  verb->add_option("--repeat", options.repeat, "Runs of each condition, with seeds that follow each other");
  verb->add_option("--at-a-time", options.at_a_time,
                   "Runs at the same time; as many as the machine has processors if left out")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--traces", options.traces,
                   "msl: files of `run --step-times` to use instead of runs; may be given several times");
  verb->add_flag("--quick", options.quick,
                 "Leave out what takes minutes: mario's loop through the vineyard, games of msl");
  verb->footer(
      "Example: sandlot reproduce cooperation --out report\n         sandlot reproduce mario --out report "
      "--quick");
  verb->callback([&line, &options] { line.result = reproduce(options); });
}

}  // namespace sandlot::app
