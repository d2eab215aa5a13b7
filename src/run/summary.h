#pragma once
/// Summary of a run: figures of its world, clock and robots. As a struct for programs, as JSON for files, as
/// text for people.
///
/// The field list gives the keys of the JSON and their order. Keys stay: people parse them.
/// Optional numbers are null in JSON when unset; optional groups (step_s, video ...) are left out.
#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"

namespace sandlot {

class Simulation;
class TravelMeter;
struct RunReport;

/// Entry of a list that is an object in JSON, with the names as its keys.
template <class T>
struct Named {
  std::string name;
  T value{};
};

/// Hash of state; 16 hexadecimal digits in JSON.
struct StateHash {
  std::uint64_t value = 0;
  friend bool operator==(StateHash, StateHash) = default;
};

/// Tick lengths of a continuous clock.
struct StepSummary {
  double mean_s = 0, min_s = 0, max_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mean", "s", "Mean length of a tick."}, s.mean_s);
    visit(Field{"min", "s", "Shortest tick."}, s.min_s);
    visit(Field{"max", "s", "Longest tick."}, s.max_s);
  }
};

struct RobotSummary {
  std::string name;
  double distance_m = 0;
  std::array<double, 2> extent_m{};
  double covered_m2 = 0;
  std::optional<std::array<double, 6>> pose;
  std::vector<Named<double>> joints;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the robot."}, s.name);
    visit(Field{"distance_m", "m", "Distance driven in the horizontal plane, to the millimetre."},
          s.distance_m);
    visit(Field{"extent_m", "m", "Size in x and y of the box around the path, to the millimetre."},
          s.extent_m);
    visit(Field{"covered_m2", "m^2", "Area of the cells of 0.5 m that the robot visited."}, s.covered_m2);
    visit(
        Field{"pose", "", "x y z [m], roll pitch yaw [rad] of the model frame; null when the robot is gone."},
        s.pose);
    visit(Field{"joints", "rad or m", "Positions of the moving joints."}, s.joints);
  }
};

struct EngineSummary {
  std::uint64_t solver_messages = 0, contacts = 0, awake_bodies = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"solver_messages", "1", "Messages of the solver about steps that it could not solve well."},
          s.solver_messages);
    visit(Field{"contacts", "1", "Contact points in the last sub-step."}, s.contacts);
    visit(Field{"awake_bodies", "1", "Bodies that are not asleep."}, s.awake_bodies);
  }
};

struct EventSummary {
  std::string name;
  std::uint64_t count = 0;
  std::optional<double> first_s, last_s;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the event."}, s.name);
    visit(Field{"count", "1", "Times that the event happened."}, s.count);
    visit(Field{"first", "s", "Simulated time of the first one; null for none."}, s.first_s);
    visit(Field{"last", "s", "Simulated time of the last one; null for none."}, s.last_s);
  }
};

struct CriterionSummary {
  std::optional<double> value;
  std::optional<bool> success;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"value", "1", "Figure of merit at the end; null when it has no value."}, s.value);
    visit(Field{"success", "", "Whether the team succeeded; null when that is not asked."}, s.success);
  }
};

struct VideoSummary {
  std::string file;
  std::uint64_t pictures = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"file", "", "Video file."}, s.file);
    visit(Field{"pictures", "1", "Pictures in it."}, s.pictures);
  }
};

struct RecordingSummary {
  std::string file;
  std::uint64_t messages = 0, bytes = 0, dropped_messages = 0, lost_ticks = 0;
  bool complete = true;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"file", "", "MCAP file."}, s.file);
    visit(Field{"messages", "1", "Messages in it."}, s.messages);
    visit(Field{"bytes", "B", "Size of the file."}, s.bytes);
    visit(Field{"dropped_messages", "1", "Messages that the disk was too slow for."}, s.dropped_messages);
    visit(Field{"lost_ticks", "1", "Ticks without log and hash."}, s.lost_ticks);
    visit(Field{"complete", "", "Whether it can be replayed."}, s.complete);
  }
};

struct ServerSummary {
  std::uint64_t viewers_most = 0, refused = 0, dropped = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"viewers_most", "1", "Most viewers at one time."}, s.viewers_most);
    visit(Field{"refused", "1", "Connections refused."}, s.refused);
    visit(Field{"dropped", "1", "Messages dropped for slow viewers."}, s.dropped);
  }
};

struct DurationSummary {
  double mean_s = 0, p99_s = 0, max_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mean", "s", "Mean of the durations."}, s.mean_s);
    visit(Field{"p99", "s", "99th percentile, at most 12.2 % too long."}, s.p99_s);
    visit(Field{"max", "s", "Longest of the durations."}, s.max_s);
  }
};

struct ClientSummary {
  std::string name, role, drives, mode;
  std::uint64_t connections = 0, steps = 0, misses = 0, commands = 0, refused = 0, stops = 0;
  std::optional<DurationSummary> latency, step;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name that the client gives itself; empty for none."}, s.name);
    visit(Field{"role", "", "Role in which it drove: robot, team or admin."}, s.role);
    visit(Field{"drives", "", "Robot or team that it claimed; empty for an admin."}, s.drives);
    visit(Field{"mode", "", "free or lockstep."}, s.mode);
    visit(Field{"connections", "1", "Number of claims, or connections, that these figures are of."},
          s.connections);
    visit(Field{"steps", "1", "Control steps that it was to answer in lockstep."}, s.steps);
    visit(Field{"misses", "1", "Steps without an answer in time."}, s.misses);
    visit(Field{"commands", "1", "Commands to devices."}, s.commands);
    visit(Field{"refused", "1", "Requests refused."}, s.refused);
    visit(Field{"stops", "1", "Times that its robots were stopped because it was silent."}, s.stops);
    visit(Field{"latency_s", "s", "Wall time from a step sent to its answer received."}, s.latency);
    visit(Field{"step_s", "s", "Wall time between two steps sent."}, s.step);
  }
};

struct RefboxTeamSummary {
  std::string team, protocol;
  std::uint64_t connections = 0, words = 0, world_states = 0, wrong = 0, dropped = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"team", "", "Name of the team in the scenario."}, s.team);
    visit(Field{"protocol", "", "json or 2009."}, s.protocol);
    visit(Field{"connections", "1", "Number of times that its base station connected."}, s.connections);
    visit(Field{"words", "1", "Words of the referee that were sent."}, s.words);
    visit(Field{"world_states", "1", "World states that came."}, s.world_states);
    visit(Field{"wrong", "1", "Messages that were no world states."}, s.wrong);
    visit(Field{"dropped", "1", "Messages that came too fast."}, s.dropped);
  }
};

struct RefboxSummary {
  std::string address;
  std::uint64_t refused = 0;
  std::vector<RefboxTeamSummary> teams;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"address", "", "Address and port."}, s.address);
    visit(Field{"refused", "1", "Connections of no team, or of a team that was connected."}, s.refused);
    visit(Field{"teams", "", "Figures of each team's base station."}, s.teams);
  }
};

struct Summary {
  std::string name, physics;
  std::uint64_t seed = 0;
  std::uint64_t ticks = 0;
  double sim_s = 0, wall_s = 0, real_time_factor = 0;
  std::uint64_t late_ticks = 0;
  std::optional<StepSummary> step;
  std::vector<Named<double>> phase_us;
  std::uint64_t end_tick = 0;
  double end_s = 0;
  std::string stopped;
  StateHash state_hash;
  std::vector<Named<StateHash>> sub_hashes;
  std::string profile;
  std::vector<RobotSummary> robots;
  EngineSummary engine;
  std::uint64_t refused_commands = 0;
  std::vector<Named<std::uint64_t>> refused_by_device;
  std::vector<EventSummary> events;
  std::optional<double> criterion;
  std::optional<bool> success;
  std::vector<Named<CriterionSummary>> criteria;
  std::vector<Named<std::vector<std::string>>> teams;
  std::vector<std::string> warnings, errors;
  std::optional<VideoSummary> video;
  std::optional<RecordingSummary> recording;
  std::optional<ServerSummary> server;
  std::vector<ClientSummary> clients;
  std::optional<RefboxSummary> refbox;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the scenario."}, s.name);
    visit(Field{"physics", "", "Name of the engine."}, s.physics);
    visit(Field{"seed", "", "Seed of the random streams."}, s.seed);
    visit(Field{"ticks", "1", "Ticks that ran."}, s.ticks);
    visit(Field{"sim_seconds", "s", "Simulated time that ran."}, s.sim_s);
    visit(Field{"wall_seconds", "s", "Time that this took."}, s.wall_s);
    visit(Field{"real_time_factor", "1", "Simulated time per wall time."}, s.real_time_factor);
    visit(Field{"late_ticks", "1",
                "Ticks more than one step behind the clock; continuous clock: ticks that were cut."},
          s.late_ticks);
    visit(Field{"step_s", "s", "Lengths of the ticks of a continuous clock."}, s.step);
    visit(Field{"phase_us", "us", "Mean time per tick of each phase."}, s.phase_us);
    visit(Field{"end_tick", "1", "Number of the last tick."}, s.end_tick);
    visit(Field{"end_time", "s", "Simulated time at the end."}, s.end_s);
    visit(Field{"stopped", "", "Reason for the end; empty when it came from outside, or by an error."},
          s.stopped);
    visit(Field{"state_hash", "", "Hash of the whole state."}, s.state_hash);
    visit(Field{"sub_hashes", "", "Hashes of the parts of the state."}, s.sub_hashes);
    visit(Field{"profile", "", "Numeric profile: build and processor family."}, s.profile);
    visit(Field{"robots", "", "Robots that took part, in order of their first tick."}, s.robots);
    visit(Field{"engine", "", "Counters of the physics engine."}, s.engine);
    visit(Field{"refused_commands", "1", "Commands and requests that were refused."}, s.refused_commands);
    visit(Field{"refused_by_device", "1", "Refusals by devices with common keys, where there were any."},
          s.refused_by_device);
    visit(Field{"events", "", "Events of the scenario and of the run."}, s.events);
    visit(Field{"criterion", "1", "Figure of merit; null when none is defined."}, s.criterion);
    visit(Field{"success", "", "Whether the run succeeded by its criterion; null when that is not asked."},
          s.success);
    visit(Field{"criteria", "1", "Figures of merit of the teams that are judged."}, s.criteria);
    visit(Field{"teams", "", "Names of the robots of each team."}, s.teams);
    visit(Field{"warnings", "", "Warnings, each with its remedy."}, s.warnings);
    visit(Field{"errors", "", "Errors that ended the run, or that results could not be written for."},
          s.errors);
    visit(Field{"video", "", "Film of the run."}, s.video);
    visit(Field{"recording", "", "Recording of the run."}, s.recording);
    visit(Field{"server", "", "Viewers of the run."}, s.server);
    visit(Field{"clients", "", "Clients of the server that drove something, present at the end or gone."},
          s.clients);
    visit(Field{"refbox", "", "Base stations at the referee box."}, s.refbox);
  }
};

/// Figures of the world and its clock; what was written about the run, warnings and errors are for the caller
/// to add.
Summary summarise(const Simulation& simulation, const RunReport& report, const TravelMeter& travel);

nlohmann::ordered_json as_json(const Summary& summary);
/// Text of the JSON file.
std::string as_json_text(const Summary& summary);
/// About a dozen lines for people.
std::string as_text(const Summary& summary);

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace sandlot
