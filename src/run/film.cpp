#include "run/film.h"

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

Status Film::take_due_pictures(Simulation& simulation) {
  const auto time_of = [&](std::uint64_t number) {
    return begin_ + Time::from_ns(static_cast<std::int64_t>(number * 1'000'000'000u /
                                                            static_cast<unsigned>(options_.rate_hz)));
  };
  while (simulation.now() >= time_of(due_)) {
    // A tick longer than the time between pictures shows one of them several times.
    ++due_;
    SL_ASSIGN(const assets::Picture picture, view_.picture(simulation));
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
  return {};
}

Status Film::finish() {
  if (!writer_)
    return Error{"there is nothing in '" + options_.file + "': the camera has sent no picture",
                 "give it the level that sends pictures, or a longer --duration"};
  return writer_->finish();
}

}  // namespace sandlot
