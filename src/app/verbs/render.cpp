/// `sandlot render`: one picture of a world.
#include <cstdio>
#include <filesystem>

#include "app/commands.h"
#include "assets/image/visible.h"
#include "assets/image/write.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "sim/world/simulation.h"

namespace sandlot::app {
namespace {

/// Longest wait for the first picture of a robot's camera.
constexpr double patience_s = 10;

Status run_to(Simulation& simulation, Time end) {
  while (simulation.now() < end && !simulation.stop_reason()) SL_TRY(simulation.tick());
  if (simulation.now() < end)
    return Error{"the run ends before --time: " + *simulation.stop_reason(), "give an earlier time"};
  return {};
}

Result<assets::Picture> take(const RenderOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(
      auto simulation,
      build(options.file,
            {.overrides = options.overrides, .paths = options.paths, .skip_missing = options.skip_missing},
            diagnostics));
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

}  // namespace

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

}  // namespace sandlot::app
