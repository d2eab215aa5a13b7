#include "selforg/teaching.h"

#include <fmt/format.h>

namespace sandlot::selforg {

Result<CrossMotorTeaching> CrossMotorTeaching::make(std::vector<std::vector<std::size_t>> sources,
                                                    double threshold) {
  if (!(threshold >= 0 && threshold <= 1))
    return Error{"the threshold of cross-motor teaching lies in [0, 1]", ""};
  for (std::size_t i = 0; i < sources.size(); ++i)
    for (const std::size_t source : sources[i])
      if (source >= sources.size())
        return Error{
            fmt::format("motor {} has source {}, but there are {} motors", i, source, sources.size()),
            "count from 0"};
  CrossMotorTeaching made;
  made.taught_.resize(sources.size());
  made.sources_ = std::move(sources);
  made.threshold_ = threshold;
  return made;
}

Result<CrossMotorTeaching> CrossMotorTeaching::permutation(std::span<const std::size_t> permutation,
                                                           double threshold) {
  std::vector<std::vector<std::size_t>> sources;
  for (const std::size_t source : permutation) sources.push_back({source});
  return make(std::move(sources), threshold);
}

void CrossMotorTeaching::teach(Teachable& controller) {
  const auto last = controller.last_motors();
  SL_CHECK_MSG(last.size() == sources_.size(), "one list of sources per motor");
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    double sum = 0;
    for (const std::size_t source : sources_[i]) sum += last[source];
    const double mean = sources_[i].empty() ? 0 : sum / static_cast<double>(sources_[i].size());
    taught_[i] = !sources_[i].empty() && std::abs(mean) >= threshold_ ? mean : last[i];
  }
  controller.teach_motors(taught_);
}

}  // namespace sandlot::selforg
