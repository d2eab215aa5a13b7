#pragma once
/// Film of a run, taken while it runs: one picture every speed / rate of simulated time, from a viewpoint. A speed below 1 is slow
/// motion, above 1 time lapse.
///
/// Pictures between two ticks show the bodies on the way (draw/moment.h); a robot's camera shows its latest picture.
/// The run waits for each picture and is not changed by it. A robot's camera that has not sent a picture yet
/// delays the beginning of the film.
#include <optional>
#include <string>

#include "draw/moment.h"
#include "record/video/video.h"
#include "run/spec.h"

namespace sandlot {

class Film {
 public:
  /// Takes the first picture. Errors   in the options; a file that cannot be written.
  static Result<Film> begin(const FilmOptions& options, Simulation& simulation);

  /// Call after each tick.
  Status take_due_pictures(Simulation& simulation);
  Status finish();

  const std::string& file() const { return options_.file; }
  std::uint64_t pictures() const { return writer_ ? writer_->pictures() : 0; }

 private:
  Film(FilmOptions options, draw::Viewpoint view, Time begin)
      : options_(std::move(options)), view_(std::move(view)), begin_(begin) {}
  Time time_of(std::uint64_t picture) const;

  FilmOptions options_;
  draw::Viewpoint view_;
  Time begin_;
  std::uint64_t due_ = 0;  ///< the number of the picture that comes next
  std::optional<draw::TickPoses>
      before_;  ///< after the tick before, of a view that shows moments between ticks
  std::optional<VideoWriter> writer_;
  int width_ = 0, height_ = 0;
};

}  // namespace sandlot
