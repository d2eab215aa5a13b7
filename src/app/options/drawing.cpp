/// Options of the verbs that draw: render, plot.
#include <CLI/CLI.hpp>
#include <cmath>

#include "app/flags.h"
#include "app/options/options.h"
#include "app/options/shared.h"
#include "base/math.h"
#include "base/text.h"

namespace sandlot::app {
namespace {

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

struct PlotTexts {
  std::string y, x_range, y_range;
};

}  // namespace

void add_render(CommandLine& line) {
  RenderFlags& flags = line.keep<RenderFlags>();
  CLI::App* const verb = line.app.add_subcommand("render",
                                                 "Take a picture of a world, as a PNG or JPEG file");
  flags.add_to(*verb);
  verb->footer(
      "Example: sandlot render scenarios/msl_field.yaml --from -6,-9,5 --at 0,0,0 --out field.png\n"
      "         sandlot render scenarios/msl_field.yaml --camera follow:cyan4 --time 2s --size 640x480 --out "
      "cyan4.png\n"
      "         sandlot render scenarios/indoor.yaml --overhead --plane instances --out map.png");
  verb->callback([&line, &flags] {
    const Status status = flags.finish();
    line.result = status ? render(flags.options) : complain(status.error());
  });
}

void add_plot(CommandLine& line) {
  PlotFilesOptions& options = line.keep<PlotFilesOptions>();
  PlotTexts& text = line.keep<PlotTexts>();
  CLI::App* const verb = line.app.add_subcommand("plot", "Draw columns of CSV files as lines, as an SVG");
  verb->add_option("files", options.files, "CSV files (a line of names, then numbers) and logs of agents")
      ->required();
  verb->add_option("--out", options.out, "SVG file to write")->required();
  verb->add_option("--x", options.figure.x, "Column of the horizontal axis")->capture_default_str();
  verb->add_option("--y", text.y,
                   "Columns to draw, with commas between them and * for any letters; all others if left out");
  verb->add_option("--title", options.figure.title, "Title of the figure");
  verb->add_option("--x-label", options.figure.x_label, "Label of the horizontal axis");
  verb->add_option("--y-label", options.figure.y_label, "Label of the vertical axis");
  verb->add_option("--x-range", text.x_range, "Range of the horizontal axis: 0,10");
  verb->add_option("--y-range", text.y_range, "Range of the vertical axis: -1,1");
  verb->add_option("--label", options.figure.labels, "Name of a line in the legend; once per line, in order")
      ->allow_extra_args(false);
  verb->add_option("--color", options.figure.colours,
                   "Colour of a line, such as red or '#1f77b4'; once per line, in order")
      ->allow_extra_args(false);
  verb->footer("Example: sandlot plot run.csv --y 'rover.pose.x,rover.pose.y' --out run.svg");
  verb->callback([&line, &options, &text] {
    options.figure.y = split_list(text.y);
    Status status = read_range("--x-range", text.x_range, options.figure.x_range);
    if (status) status = read_range("--y-range", text.y_range, options.figure.y_range);
    line.result = status ? plot(options) : complain(status.error());
  });
}

}  // namespace sandlot::app
