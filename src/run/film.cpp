#include "run/film.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "assets/image/visible.h"
#include "sim/world/simulation.h"

namespace sandlot {

Result<Film> Film::begin(const FilmOptions& options, Simulation& simulation) {
  SL_ASSIGN(draw::Viewpoint view, draw::Viewpoint::make(options.view, simulation));
  // The size of a robot's camera is known with its first picture; the rest can be checked now.
  SL_TRY(VideoWriter::check(
      {options.file, options.view.width.value_or(960), options.view.height.value_or(540), options.rate_hz}));
  if (std::ofstream out(options.file, std::ios::binary | std::ios::app); !out)
    return Error{"cannot write '" + options.file + "': " + std::strerror(errno)};
  Film film(options, std::move(view), simulation.now());
  SL_TRY(film.take_due_pictures(simulation));
  return film;
}

Time Film::time_of(std::uint64_t picture) const {
  // A thousandth of a nanosecond keeps whole ones from being rounded down.
  const double ns = static_cast<double>(picture) * options_.speed / options_.rate_hz * 1e9 + 1e-3;
  return begin_ + Time::from_ns(static_cast<std::int64_t>(ns));
}

Status Film::take_due_pictures(Simulation& simulation) {
  const Time now = simulation.now();
  std::optional<draw::TickPoses> after;
  if (!view_.is_device()) after = draw::TickPoses::of(simulation);
  for (Time at; now >= (at = time_of(due_)); ++due_) {
    std::optional<draw::Moment> moment;
    if (before_ && at < now) moment = draw::moment_between(*before_, *after, std::max(at, before_->at));
    SL_ASSIGN(const assets::Picture picture, view_.picture(simulation, moment ? &*moment : nullptr));
    if (picture.rgb.empty()) continue;
    if (!writer_) {
      SL_ASSIGN(writer_,
                VideoWriter::create({options_.file, picture.width, picture.height, options_.rate_hz}));
      width_ = picture.width;
      height_ = picture.height;
    } else if (picture.width != width_ || picture.height != height_) {
      return Error{"the camera's pictures have changed their size, and those of a film cannot"};
    }
    SL_TRY(writer_->add(picture.rgb));
  }
  before_ = std::move(after);
  return {};
}

Status Film::finish() {
  if (!writer_)
    return Error{"there is nothing in '" + options_.file + "': the camera has sent no picture",
                 "give it the level that sends pictures, or a longer --duration"};
  return writer_->finish();
}

}  // namespace sandlot
