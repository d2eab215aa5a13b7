/// `sandlot render`: one picture of a world.
#include "app/verbs/render.h"

#include <cstdio>
#include <filesystem>

#include "app/commands.h"
#include "app/flags.h"
#include "assets/image/write.h"
#include "base/atomic_file.h"
#include "base/math.h"
#include "base/text.h"
#include "draw/viewpoint.h"

namespace sandlot::app {
namespace {

struct RenderOptions {
  std::string file, out;
  FileOptions world;
  draw::ViewpointOptions view;
  double time_s = 0;
};

/// How long a robot's camera may take for a picture.
constexpr double patience_s = 10;

Status run_to(Simulation& simulation, Time end) {
  while (simulation.now() < end && !simulation.stop_reason()) SL_TRY(simulation.tick());
  if (simulation.now() < end)
    return Error{"the run ends before --time: " + *simulation.stop_reason(), "give an earlier time"};
  return {};
}

Result<assets::Picture> take(const RenderOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(auto simulation, build(options.file, options.world, diagnostics));
  simulation->set_stop(std::nullopt);
  // Who looks for no camera should not wait for the run.
  SL_ASSIGN(draw::Viewpoint view, draw::Viewpoint::make(options.view, *simulation));
  SL_TRY(run_to(*simulation, Time::from_s(options.time_s)));
  if (!view.is_device()) return view.picture(*simulation);
  const Time last = simulation->now() + Time::from_s(patience_s);
  while (view.messages(*simulation) == 0 && simulation->now() < last) SL_TRY(simulation->tick());
  if (view.messages(*simulation) == 0)
    return Error{"the camera '" + options.view.camera + "' has sent no picture until " +
                     number_text(simulation->now().s()) + " s",
                 "give it the level that sends pictures, as with --set"};
  return view.picture(*simulation);
}

int render(const RenderOptions& options) {
  const std::string extension = std::filesystem::path(options.out).extension().string();
  const bool png = extension == ".png";
  if (!png && extension != ".jpg" && extension != ".jpeg")
    return complain({"a picture cannot be written as '" + options.out + "'", "call it .png or .jpg"});
  Diagnostics diagnostics;
  const auto picture = take(options, diagnostics);
  print_warnings(diagnostics);
  if (!picture) return complain(picture.error());
  const assets::Pixels8 pixels{picture->width, picture->height, 3, picture->rgb};
  const std::string bytes = png ? assets::png_of(pixels) : assets::jpeg_of(pixels, 92);
  if (Status status = write_file(options.out, bytes); !status) return complain(status.error());
  return exit_ok;
}

}  // namespace

void add_render_verb(CLI::App& app, int& result) {
  static RenderOptions options;
  static DurationOption time;
  static draw::ViewpointOptions view;
  static double fov_deg = 60;
  static std::string size, from, at;
  static std::vector<std::string> sets;
  static bool overhead = false;
  CLI::App* const verb = app.add_subcommand("render", "Take a picture of a world, as a PNG or JPEG file");
  verb->add_option("file", options.file, "Scenario, world or robot")->required();
  verb->add_option("--out", options.out, "The picture: .png or .jpg")->required();
  verb->add_option("--camera", view.camera,
                   "A robot's camera (robot/device), or follow:ROBOT for a view from behind it");
  verb->add_option("--from", from, "Look from this point: x,y,z in metres");
  verb->add_option("--at", at, "Look at this point, with --from");
  verb->add_flag("--overhead", overhead, "Look from above at everything");
  verb->add_option("--fov", fov_deg, "Field of view across the picture, in degrees")
      ->check(CLI::Range(1.0, 170.0))
      ->capture_default_str();
  verb->add_option("--size", size,
                   "Width and height, such as 640x480; 960x540 if left out. A robot's camera has its own");
  verb->add_option("--time", time.text, "Simulated time of the picture, such as 3s; the start if left out");
  verb->add_option("--plane", view.plane,
                   "rgb; depth, labels or instances as colours. A robot's camera: name its topic instead")
      ->capture_default_str();
  verb->add_option("--samples", view.samples, "Rays per pixel: more, smoother edges")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  verb->add_flag("--shadows,!--no-shadows", view.shadows, "Lights cast shadows (the default)");
  verb->add_option("--set", sets, "Change the scenario before it is loaded: path=value")
      ->allow_extra_args(false);
  verb->add_option("--path", options.world.paths,
                   "Folder to search for models and other files; may be given several times")
      ->allow_extra_args(false);
  verb->add_flag("--skip-missing", options.world.skip_missing,
                 "Leave out, with a warning, what a world names and nobody has: models, meshes, heightmaps");
  verb->footer(
      "Example: sandlot render scenarios/msl_field.yaml --from -6,-9,5 --at 0,0,0 --out field.png\n"
      "         sandlot render scenarios/msl_field.yaml --camera follow:cyan4 --time 2s --size 640x480 --out "
      "cyan4.png\n"
      "         sandlot render scenarios/indoor.yaml --overhead --plane instances --out map.png");
  verb->callback([&result] {
    const auto read = [&]() -> Status {
      std::optional<double> time_s;
      SL_TRY(time.read("--time", time_s));
      options.time_s = time_s.value_or(0);
      SL_TRY(read_sets(sets, options.world.overrides));
      options.view = view;
      options.view.fov_rad = fov_deg * math::pi / 180;
      SL_TRY(read_size("--size", size, options.view));
      SL_TRY(read_point("--from", from, options.view.from));
      SL_TRY(read_point("--at", at, options.view.at));
      if (overhead && !options.view.camera.empty())
        return Error{"--overhead and --camera are two views", "give one of them"};
      if (overhead) options.view.camera = "overhead";
      return {};
    };
    const Status status = read();
    result = status ? render(options) : complain(status.error());
  });
}

}  // namespace sandlot::app
