/// The `sandlot` command: its verbs in the order of its help, and what is wrong in a line. app/options has the
/// options of the verbs, app/verbs what they do.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <system_error>

#include "app/commands.h"
#include "app/options/options.h"
#include "base/text.h"
#include "base/units.h"

namespace {

using namespace sandlot;
using namespace sandlot::app;

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
  CommandLine line{app, result, hooks};
  for (void (*const add)(CommandLine&) :
       {add_run,  add_demo, add_match,  add_tournament, add_console,   add_render, add_check,
        add_info, add_plot, add_replay, add_diff,       add_convert,   add_new,    add_calibrate,
        add_fit,  add_list, add_bench,  add_validate,   add_reproduce, add_topic,  add_doctor})
    add(line);
  const auto all = [](const CLI::App*) { return true; };
  for (CLI::App* const verb : app.get_subcommands(all)) {
    verb->group("Verbs");
    for (CLI::App* const each : verb->get_subcommands(all)) each->group("Verbs");
  }
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
