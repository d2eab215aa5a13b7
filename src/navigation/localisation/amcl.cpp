#include "navigation/localisation/amcl.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "navigation/localisation/distance_field.h"

namespace sandlot::navigation::amcl {
namespace {

constexpr Time amcl_last_stamp{4'000'000'000'000'000'000};

/// Uses of random numbers within an event.
enum : std::uint64_t { amcl_use_motion = 1, amcl_use_recovery = 2, amcl_use_resampling = 3 };

Stream amcl_stream(const State& state) {
  return Stream(state.seed, entity_key("amcl"), Purpose::controller, state.events);
}
Stream amcl_stream(const Stream& event, std::uint64_t use, std::size_t particle) {
  return event.fork(use << 32 | particle);
}

void amcl_restart(State& state) {
  ++state.events;
  state.updates = 0;
  state.has_odometry = false;
  state.slow = state.fast = 0;
  state.estimate = {};
}

/// Lower triangle L with L L' = covariance; false when that is not positive semi-definite.
bool amcl_root(const Covariance3& P, double (&L)[3][3]) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      L[i][j] = 0;
      const double a = P[3 * i + j], b = P[3 * j + i];
      if (!(std::abs(a) <= 1e12) || std::abs(a - b) > 1e-6 * (std::abs(a) + std::abs(b))) return false;
    }
  for (std::size_t j = 0; j < 3; ++j) {
    double pivot = P[4 * j];
    for (std::size_t k = 0; k < j; ++k) pivot -= L[j][k] * L[j][k];
    const double slack = 1e-9 * std::abs(P[4 * j]);
    if (pivot < -slack || P[4 * j] < 0) return false;
    L[j][j] = std::sqrt(std::max(pivot, 0.0));
    for (std::size_t i = j + 1; i < 3; ++i) {
      double rest = P[3 * i + j];
      for (std::size_t k = 0; k < j; ++k) rest -= L[i][k] * L[j][k];
      if (L[j][j] > std::sqrt(slack)) L[i][j] = rest / L[j][j];
      else if (rest * rest > 1e-6 * P[4 * i] * P[4 * j] + 1e-300) return false;
    }
  }
  return true;
}

Outcome amcl_count(State& state, Outcome outcome) {
  ++state.counts[static_cast<std::size_t>(outcome)];
  return state.last = outcome;
}

/// Takes note of the odometry. What stands against the use of a scan, but for its beams; `updated` when nothing does.
Outcome amcl_admit(const Spec& spec, State& state, const Moment& moment, Time stamp) {
  if (state.particles.empty()) return Outcome::uninitialised;
  if (stamp < Time{} || stamp > amcl_last_stamp || moment.odometry_stamp < Time{} ||
      moment.odometry_stamp > amcl_last_stamp)
    return Outcome::bad_stamp;
  if (std::abs((moment.odometry_stamp - stamp).s()) > spec.odometry_age_s) return Outcome::unsynchronised;
  if (!is_bounded(moment.X_OB)) return Outcome::bad_odometry;
  if (!state.has_odometry) return Outcome::updated;
  const bool rewound = stamp <= state.at && (state.at - stamp).s() > spec.time_jump_s;
  if (stamp <= state.at && !rewound) return Outcome::late;
  const Pose2 since = relative(state.latest_X_OB, moment.X_OB);
  const bool jumped = math::hypot(since.x, since.y) > spec.odometry_jump_m;
  if (jumped || rewound) {
    // What was driven until the jump still counts.
    const Pose2 driven = relative(state.X_OB, state.latest_X_OB);
    state.X_OB = compose(moment.X_OB, inverse(driven));
    if (!is_bounded(state.X_OB))
      state.X_OB = moment.X_OB;  // at the limit, where a saved state would be refused
    state.at = stamp;
  }
  state.latest_X_OB = moment.X_OB;
  if (jumped || rewound) return rewound ? Outcome::rewound : Outcome::jumped;
  const Pose2 step = relative(state.X_OB, moment.X_OB);
  const double drive = math::hypot(step.x, step.y);
  // The first scan after an initialisation is used wherever the robot is.
  if (state.updates > 0 && drive < spec.update_min_d_m && std::abs(step.theta) < spec.update_min_a_rad)
    return Outcome::waiting;
  return Outcome::updated;
}

/// Mean and covariance of the heaviest cluster.
Estimate amcl_estimate(const State& state, Workspace& work) {
  work.bins.clear();
  for (std::size_t i = 0; i < state.particles.size(); ++i)
    work.bin[i] = work.bins.add(state.particles[i].pose, state.particles[i].weight);
  const PoseBins::Clusters clusters = work.bins.find_clusters();
  Estimate out{.known = true, .clusters = clusters.count};
  double x = 0, y = 0, sine = 0, cosine = 0;
  for (std::size_t i = 0; i < state.particles.size(); ++i) {
    if (work.bins.cluster_of(work.bin[i]) != clusters.best) continue;
    const auto& [pose, weight] = state.particles[i];
    const auto [s, c] = math::sincos(pose.theta);
    out.share += weight;
    x += weight * pose.x, y += weight * pose.y, sine += weight * s, cosine += weight * c;
    out.fit += weight * work.fit[i];
  }
  out.fit /= out.share;
  out.pose = {x / out.share, y / out.share, math::atan2(sine, cosine)};
  for (std::size_t i = 0; i < state.particles.size(); ++i) {
    if (work.bins.cluster_of(work.bin[i]) != clusters.best) continue;
    const auto& [pose, weight] = state.particles[i];
    const double off[3] = {pose.x - out.pose.x, pose.y - out.pose.y,
                           math::wrap_angle(pose.theta - out.pose.theta)};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) out.covariance[3 * r + c] += weight / out.share * off[r] * off[c];
  }
  return out;
}

/// Best of some random poses for a scan.
Pose2 amcl_recovered(const Model& model, const Workspace& work, Stream& random) {
  Pose2 best = model.free_pose(random);
  double best_fit = model.mean_log_likelihood(work.scan.p_B, best);
  for (int k = 1; k < model.spec().recovery_candidates; ++k) {
    const Pose2 pose = model.free_pose(random);
    const double fit = model.mean_log_likelihood(work.scan.p_B, pose);
    if (fit > best_fit) best = pose, best_fit = fit;
  }
  return best;
}

/// Draws the particles again: as many as KLD-sampling wants, a share of them anew from the map.
void amcl_resample(const Model& model, State& state, Workspace& work, const Stream& event) {
  const Spec& spec = model.spec();
  const std::size_t before = state.particles.size();
  work.weights.resize(before);
  for (std::size_t i = 0; i < before; ++i) work.weights[i] = state.particles[i].weight;
  Stream random = amcl_stream(event, amcl_use_resampling, 0);
  const double offset = random.uniform();
  // A first drawing of full size counts the bins.
  work.picks.resize(static_cast<std::size_t>(spec.max_particles));
  resample_low_variance(work.weights, offset, work.picks);
  work.bins.clear();
  for (std::size_t k = 0; k < work.picks.size(); ++k)
    if (k == 0 || work.picks[k] != work.picks[k - 1]) work.bins.add(state.particles[work.picks[k]].pose, 1);
  const double wanted = kld_particles(work.bins.occupied(), spec.kld_error, spec.kld_quantile);
  const auto count = static_cast<std::size_t>(
      std::clamp(wanted, static_cast<double>(spec.min_particles), static_cast<double>(spec.max_particles)));
  const double lost = spec.alpha_slow > 0 ? std::clamp(1 - state.fast / state.slow, 0.0, 1.0) : 0;
  const auto injected = static_cast<std::size_t>(std::floor(lost * static_cast<double>(count) + 0.5));
  work.picks.resize(count - injected);
  if (!work.picks.empty()) resample_low_variance(work.weights, offset, work.picks);
  work.drawn.clear();
  const double weight = 1 / static_cast<double>(count);
  for (const std::uint32_t pick : work.picks) work.drawn.push_back({state.particles[pick].pose, weight});
  for (std::size_t i = 0; i < injected; ++i) {
    Stream one = amcl_stream(event, amcl_use_recovery, i);
    work.drawn.push_back({amcl_recovered(model, work, one), weight});
  }
  state.injected += injected;
  state.particles.swap(work.drawn);
}

}  // namespace

std::span<const EnumName<Outcome>> enum_names(Outcome) {
  static constexpr EnumName<Outcome> names[] = {{"updated", Outcome::updated},
                                                {"waiting", Outcome::waiting},
                                                {"uninitialised", Outcome::uninitialised},
                                                {"jumped", Outcome::jumped},
                                                {"rewound", Outcome::rewound},
                                                {"late", Outcome::late},
                                                {"bad_stamp", Outcome::bad_stamp},
                                                {"unsynchronised", Outcome::unsynchronised},
                                                {"bad_odometry", Outcome::bad_odometry},
                                                {"bad_scan", Outcome::bad_scan},
                                                {"bad_mount", Outcome::bad_mount},
                                                {"no_beams", Outcome::no_beams}};
  return names;
}

Status Spec::check(const Node& node, const std::string& path) const {
  const auto number = [](int x) { return std::to_string(x); };
  if (min_particles > max_particles)
    return node.error(
        "min_particles is " + number(min_particles) + ", max_particles " + number(max_particles),
        "min_particles must not be above max_particles", path + "/min_particles");
  if (!(laser_min_range_m < laser_max_range_m))
    return node.error("laser_min_range is not below laser_max_range", "a shorter laser_min_range",
                      path + "/laser_min_range");
  if (free_percent >= occupied_percent)
    return node.error("free is " + number(free_percent) + " %, occupied " + number(occupied_percent) + " %",
                      "free must lie below occupied", path + "/free");
  if (alpha_slow > 0 && alpha_slow >= alpha_fast)
    return node.error("recovery_alpha_slow is not below recovery_alpha_fast",
                      "a smaller recovery_alpha_slow, 0 for no recovery", path + "/recovery_alpha_slow");
  return {};
}

Result<Model> Model::make(const Spec& spec, const GridMap& map) {
  SL_TRY(check_ranges(spec));
  SL_TRY(spec.check(Node{}, ""));
  SL_ASSIGN(const DistanceField field,
            DistanceField::make(map, spec.occupied_percent, spec.likelihood_max_distance_m));
  Model out(spec, map.geometry);
  const double anywhere = spec.z_rand / spec.laser_max_range_m;
  const auto log_p = [&](double distance_m) {
    const double d = distance_m / spec.sigma_hit_m;
    return math::log(spec.z_hit * math::exp(-d * d / 2) + anywhere);
  };
  out.log_lowest_ = log_p(spec.likelihood_max_distance_m);
  const std::span<const float> distances = field.distances();
  out.log_likelihood_.resize(distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i) {
    out.log_likelihood_[i] = static_cast<float>(log_p(static_cast<double>(distances[i])));
    if (map.occupancy[i] >= 0 && map.occupancy[i] <= spec.free_percent)
      out.free_.push_back(static_cast<std::uint32_t>(i));
  }
  if (out.free_.empty())
    return Error{"the map has no free cell", "the robot must be in one: at least one cell of " +
                                                 std::to_string(spec.free_percent) + " % or less"};
  return out;
}

double Model::log_likelihood(Vec2 end_M) const {
  const auto cell = frame_.cell(end_M);
  return cell ? static_cast<double>(log_likelihood_[geometry_.index(*cell)]) : log_lowest_;
}

double Model::mean_log_likelihood(std::span<const Vec2> points_B, const Pose2& X_MB) const {
  // All in cells, in the grid's frame: one turn and one look-up a beam.
  const Vec2 at = frame_.to_grid({X_MB.x, X_MB.y});
  const auto [s, c] = math::sincos(X_MB.theta - geometry_.origin.theta);
  const double per_m = 1 / geometry_.resolution_m, sine = s * per_m, cosine = c * per_m;
  const double width = geometry_.width, height = geometry_.height;
  const auto stride = static_cast<std::size_t>(geometry_.width);
  double sum = 0;
  for (const Vec2 p : points_B) {
    const double x = at.x + cosine * p.x - sine * p.y, y = at.y + sine * p.x + cosine * p.y;
    const bool on_map = x >= 0 && y >= 0 && x < width && y < height;
    sum += on_map ? static_cast<double>(
                        log_likelihood_[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)])
                  : log_lowest_;
  }
  return sum / static_cast<double>(points_B.size());
}

Pose2 Model::free_pose(Stream& random) const {
  const std::size_t index = free_[random.below(static_cast<std::uint32_t>(free_.size()))];
  const auto width = static_cast<std::size_t>(geometry_.width);
  const double u = random.uniform(), v = random.uniform();
  const Vec2 p = frame_.to_map(
      {static_cast<double>(index % width) + u, static_cast<double>(index / width) + v});
  return {p.x, p.y, math::wrap_angle(random.uniform(-math::pi, math::pi))};
}

bool State::fits(const Model& model) const {
  if (particles.size() > static_cast<std::size_t>(model.spec().max_particles)) return false;
  double sum = 0;
  for (const Particle& each : particles) {
    if (!is_bounded(each.pose) || !(each.weight >= 0 && each.weight <= 1)) return false;
    sum += each.weight;
  }
  return (particles.empty() || std::abs(sum - 1) < 1e-6) && is_bounded(X_OB) && is_bounded(latest_X_OB) &&
         is_bounded(estimate.pose) && slow >= 0 && slow <= 2 && fast >= 0 && fast <= 2;
}

Workspace::Workspace(const Model& model) : bins(static_cast<std::size_t>(model.spec().max_particles)) {
  const auto particles = static_cast<std::size_t>(model.spec().max_particles);
  scan.p_B.reserve(static_cast<std::size_t>(model.spec().max_beams));
  drawn.reserve(particles);
  weights.reserve(particles);
  fit.reserve(particles);
  picks.reserve(particles);
  bin.resize(particles);
}

State begin(std::uint64_t seed) {
  State state;
  state.seed = seed;
  return state;
}

Status set_pose(const Model& model, State& state, const Pose2& X_MB, const Covariance3& covariance) {
  if (!is_bounded(X_MB)) return Error{"the initial pose is not finite", "x, y and theta below 1e6"};
  const GridFrame frame(model.geometry());
  if (!frame.cell({X_MB.x, X_MB.y}))
    return Error{"the initial pose " + point_text({X_MB.x, X_MB.y}) + " lies off the map",
                 "a pose on the map"};
  double L[3][3];
  if (!amcl_root(covariance, L))
    return Error{"the initial covariance is not a covariance",
                 "nine finite numbers, symmetric and positive semi-definite"};
  amcl_restart(state);
  const auto count = static_cast<std::size_t>(model.spec().max_particles);
  state.particles.reserve(count);
  state.particles.resize(count);
  const Stream event = amcl_stream(state);
  for (std::size_t i = 0; i < count; ++i) {
    Stream random = amcl_stream(event, amcl_use_motion, i);
    const double n0 = random.normal(), n1 = random.normal(), n2 = random.normal();
    const auto bounded = [](double x) { return std::clamp(x, -1e6, 1e6); };
    state.particles[i] = {{bounded(X_MB.x + L[0][0] * n0), bounded(X_MB.y + L[1][0] * n0 + L[1][1] * n1),
                           math::wrap_angle(X_MB.theta + L[2][0] * n0 + L[2][1] * n1 + L[2][2] * n2)},
                          1 / static_cast<double>(count)};
  }
  state.estimate = {.known = true, .pose = X_MB, .covariance = covariance, .share = 1, .clusters = 1};
  return {};
}

void spread(const Model& model, State& state) {
  amcl_restart(state);
  const auto count = static_cast<std::size_t>(model.spec().max_particles);
  state.particles.reserve(count);
  state.particles.resize(count);
  const Stream event = amcl_stream(state);
  for (std::size_t i = 0; i < count; ++i) {
    Stream random = amcl_stream(event, amcl_use_motion, i);
    state.particles[i] = {model.free_pose(random), 1 / static_cast<double>(count)};
  }
}

Outcome update(const Model& model, State& state, Workspace& work, const Moment& moment,
               const msg::LaserScan& scan) {
  const Spec& spec = model.spec();
  const Time stamp = scan.header.stamp;
  const Outcome outcome = amcl_admit(spec, state, moment, stamp);
  if (outcome != Outcome::updated) return amcl_count(state, outcome);
  const ScanFault fault = take_points(
      scan, moment.X_BL, {spec.laser_min_range_m, spec.laser_max_range_m, spec.max_beams}, work.scan);
  if (fault == ScanFault::bad_scan) return amcl_count(state, Outcome::bad_scan);
  if (fault == ScanFault::bad_mount) return amcl_count(state, Outcome::bad_mount);
  if (fault == ScanFault::no_beams) return amcl_count(state, Outcome::no_beams);

  ++state.events;
  const std::size_t count = state.particles.size();
  const Stream event = amcl_stream(state);
  const MotionSampler move(spec.motion_model, spec.noise,
                           state.has_odometry ? relative(state.X_OB, moment.X_OB) : Pose2{});
  const double power = std::min(spec.effective_beams, static_cast<double>(work.scan.p_B.size()));
  work.weights.resize(count);
  work.fit.resize(count);
  double mean_fit = 0, greatest = -1e300;
  const bool blank = !state.estimate.known;
  for (std::size_t i = 0; i < count; ++i) {
    Particle& particle = state.particles[i];
    if (blank) {
      Stream random = amcl_stream(event, amcl_use_recovery, i);
      particle.pose = amcl_recovered(model, work, random);
    } else if (state.has_odometry) {
      Stream random = amcl_stream(event, amcl_use_motion, i);
      particle.pose = move(particle.pose, random);
      if (!is_bounded(particle.pose)) particle.pose = model.free_pose(random);
    }
    const double log_p = model.mean_log_likelihood(work.scan.p_B, particle.pose);
    work.fit[i] = math::exp(log_p);
    work.weights[i] = power * log_p;
    greatest = std::max(greatest, work.weights[i]);
    mean_fit += particle.weight * work.fit[i];
  }
  // Relative to the greatest one: no underflow of all of them. A particle without weight stays so.
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += state.particles[i].weight *= math::exp(work.weights[i] - greatest);
  if (!(sum > 0))  // weight was only where the scan is all but impossible
    for (std::size_t i = 0; i < count; ++i) sum += state.particles[i].weight = 1;
  for (Particle& particle : state.particles) particle.weight /= sum;

  const bool first = state.updates == 0;
  state.slow = first ? mean_fit : state.slow + spec.alpha_slow * (mean_fit - state.slow);
  state.fast = first ? mean_fit : state.fast + spec.alpha_fast * (mean_fit - state.fast);
  state.estimate = amcl_estimate(state, work);
  state.at = stamp;
  state.X_OB = state.latest_X_OB = moment.X_OB;
  state.has_odometry = true;
  ++state.updates;
  if (state.updates % static_cast<std::uint64_t>(spec.resample_interval) == 0)
    amcl_resample(model, state, work, event);
  return amcl_count(state, Outcome::updated);
}

Pose2 map_to_odom(const State& state) { return compose(state.estimate.pose, inverse(state.X_OB)); }

Pose2 pose_at(const State& state, const Pose2& X_OB) {
  if (!state.has_odometry) return state.estimate.pose;
  return compose(state.estimate.pose, relative(state.X_OB, X_OB));
}

}  // namespace sandlot::navigation::amcl
