#include "formats/eyesim/sim.h"

#include <algorithm>
#include <filesystem>
#include <list>
#include <map>
#include <optional>
#include <set>

#include "base/text.h"
#include "files/resources.h"
#include "files/text.h"
#include "formats/eyesim/errors.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/paths.h"
#include "formats/eyesim/plan.h"
#include "formats/eyesim/robi.h"

namespace sandlot::formats::eyesim {
namespace {

namespace fs = std::filesystem;

/// A word of EyeSim, and our file of it in the folder of models.
struct BuiltIn {
  const char *word, *name, *file;
};
constexpr BuiltIn robots[] = {{"labbot", "LabBot", "labbot/labbot.robi"},
                              {"s4", "S4", "eyesim/s4.robi"},
                              {"ackermann", "Ackermann", "eyesim/ackermann.robi"},
                              {"omni", "Omni", "eyesim/omni.robi"}};
constexpr BuiltIn objects[] = {{"can", "Can", "eyesim/can.sdf"},
                               {"soccer", "Soccer", "eyesim/soccer.sdf"},
                               {"crate", "Crate", "eyesim/crate.sdf"},
                               {"box", "Crate", "eyesim/crate.sdf"},
                               {"golf", "Golf", "eyesim/golf.sdf"}};
/// Devices of the control unit that every robot of EyeSim carries.
constexpr const char* unit_devices[] = {"screen", "keys", "speaker", "radio"};

constexpr const char* substeps = "10";
/// In place of a program: a controller of Sandlot.
constexpr std::string_view own_controller = "controller:";
constexpr double marker_radius_m = 0.05;

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

struct Type {
  std::string name, file;
  Place place;
  bool is_robot = true;
  std::optional<Robi> robi;  ///< null: it could not be read
};

/// The name that the file of a type gives it; its own name when it cannot be read, of which loading tells.
std::string name_in(Type& type, const std::string& folder, const SearchPath& search) {
  std::string name = fs::path(type.file).stem().string();
  const auto found = find_resource(type.file, folder, search, type.place);
  if (!found) return name;
  const auto text = read_text_file(*found, most_bytes);
  if (!text) return name;
  Diagnostics repeated;
  const ReadOptions options{search, true};
  if (type.is_robot) {
    auto robi = read_robi(*text, *found, options, repeated);
    if (robi) {
      name = robi->instance.name;
      type.robi = std::move(*robi);
    }
  } else if (const auto object = read_object(*text, *found, options, repeated)) {
    name = object->name;
  }
  return name;
}

struct Placed {
  Line line;
  const Type* type = nullptr;
  std::optional<std::string> program;
  std::optional<Spot> spot;  ///< null: the next start of the world
  std::optional<double> yaw_rad;
};

class Reader {
 public:
  Reader(const std::string& file, SearchPath search, Diagnostics& diagnostics)
      : file_(file), search_(std::move(search)), diagnostics_(diagnostics) {}

  Result<Node> read(const std::vector<Line>& lines) {
    // Types may stand behind the robots that are of them.
    for (const Line& line : lines) SL_TRY(declare(line));
    for (const Line& line : lines) SL_TRY(place(line));
    return tree(lines.empty() ? place_in(file_) : lines.front().place);
  }

 private:
  // --- reading ---

  /// The file that a word means, with a warning where it is not the one that is written.
  std::string file_named(const std::string& written, const Line& line) {
    return taken(written, located(written, folder_of(file_), search_), line);
  }
  std::string program_named(const std::string& written, const Line& line) {
    if (starts_with(written, "controller:")) return written;
    return taken(written, located_program(written, folder_of(file_), search_), line);
  }
  std::string taken(const std::string& written, std::string found, const Line& line) {
    if (found == path_of(written)) return found;
    diagnostics_.warn(line.error("'" + written.substr(0, 200) + "' is not there; '" + found + "' is taken"));
    // Programs keep the folder that they work in: the scenario's.
    std::error_code failed;
    const fs::path folder = fs::weakly_canonical(folder_of(file_).empty() ? "." : folder_of(file_), failed);
    const fs::path relative = fs::path(found).lexically_relative(folder);
    return failed || relative.empty() || *relative.begin() == ".." ? found : relative.string();
  }

  static bool is_robot_word(const std::string& word) { return word == "robot" || word == "robi"; }
  static bool is_object_word(const std::string& word) { return word == "object" || word == "obj"; }

  Status declare(const Line& line) {
    const std::string word = lower(line.keyword());
    if (word == "world" || word == "maze") return world(line);
    if (!is_robot_word(word) && !is_object_word(word)) return {};
    const bool robot = is_robot_word(word);
    const std::string_view end = robot ? ".robi" : ".esobj";
    std::size_t at = 1;
    while (at < line.words.size() && !ends_with(lower(line.words[at]), end)) ++at;
    if (at >= line.words.size()) {
      if (!robot && is_classic_object(line)) return {};
      return line.error("'" + word + "' names no " + std::string(robot ? ".robi" : ".esObj") + " file",
                        "write " + word + (robot ? " scout.robi" : " post.esObj"));
    }
    Type type{"", file_named(line.words[at], line), line.place, robot, {}};
    type.name = name_in(type, folder_of(file_), search_);
    if (!names_.insert(type.name).second) {
      diagnostics_.warn(line.error("'" + type.name + "' is loaded a second time; the first one counts"));
      return {};
    }
    types_.push_back(std::move(type));
    return {};
  }

  Status world(const Line& line) {
    if (line.arguments() < 1) return line.error("'world' names no file", "write world small.maz");
    if (world_) return line.error("there are two worlds", "the other one is at " + to_string(world_->place));
    world_ = line;
    world_->words[1] = file_named(line.words[1], line);
    const auto found = find_resource(world_->words[1], folder_of(file_), search_, line.place);
    if (!found) return {};  // loading tells
    const std::string extension = lower(fs::path(*found).extension().string());
    const bool maze = extension == ".maz" || extension == ".maze";
    if (!maze && extension != ".wld" && extension != ".world") return {};
    SL_ASSIGN(const std::string text, read_text_file(*found, most_bytes));
    if (text.find('<') != std::string::npos && extension == ".world") return {};  // one of Gazebo
    Diagnostics repeated;
    SL_ASSIGN(Plan plan, maze ? read_maze(text, *found, repeated) : read_wld(text, *found, repeated));
    starts_ = std::move(plan.starts);
    return {};
  }

  Status place(const Line& line) {
    const std::string word = lower(line.keyword());
    if (is_object_word(word) && is_classic_object(line)) return classic_object(line);
    if (word == "world" || word == "maze" || is_object_word(word)) return {};
    if (word == "settings") return settings(line);
    if (word == "marker") return marker(line);
    if (word == "error") return errors_.take(line);
    if (word == "step") {
      SL_ASSIGN(const double ms, number_at(line, 1, "a step in ms"));
      if (!(ms >= 1 && ms <= 50)) return line.error("a step is 1 to 50 ms long", "EyeSim has 50");
      step_ms_ = ms;
      step_ = Node::scalar(number_text(ms) + " ms", line.place);
      return {};
    }
    if (is_robot_word(word)) return classic_robot(line);
    if (word == "position" && !placed_.empty()) {
      SL_ASSIGN(placed_.back().spot, spot_of(line));
      return {};
    }
    const Type* const type = type_of(line);
    if (!type) return unknown(line);
    return type->is_robot ? robot(line, *type) : object(line, *type);
  }

  /// A type that was loaded, or one of EyeSim's own, which are made when they are first named.
  const Type* type_of(const Line& line) {
    const std::string& word = line.keyword();
    for (const Type& type : types_)
      if (type.name == word || (type.place.file == nullptr && lower(type.name) == lower(word))) return &type;
    const auto built_in = [&](std::span<const BuiltIn> all, bool is_robot) -> const Type* {
      for (const BuiltIn& each : all) {
        if (lower(word) != each.word) continue;
        for (const Type& known : types_)
          if (known.file == each.file) return &known;
        Type type{each.name, each.file, {}, is_robot, {}};
        name_in(type, folder_of(file_), search_);
        return &types_.emplace_back(std::move(type));
      }
      return nullptr;
    };
    if (const Type* const found = built_in(robots, true)) return found;
    if (const Type* const found = built_in(objects, false)) return found;
    // Files with other letters than their name has.
    for (const Type& type : types_)
      if (lower(type.name) == lower(word)) return &type;
    return nullptr;
  }

  Status unknown(const Line& line) {
    std::vector<std::string> known{"world", "robot", "object", "settings", "marker", "error", "step"};
    for (const BuiltIn& each : robots) known.emplace_back(each.name);
    for (const BuiltIn& each : objects) known.emplace_back(each.name);
    for (const Type& type : types_) known.push_back(type.name);
    const std::string word = line.keyword().substr(0, 40);
    const bool placed = line.arguments() >= 3 && is_number(line.words[1]) && is_number(line.words[2]);
    diagnostics_.warn(line.error("'" + word + "' is not known and left out",
                                 placed
                                     ? "load its file: robot " + word + ".robi or object " + word + ".esObj"
                                     : suggestion(word, known)));
    return {};
  }

  Status settings(const Line& line) {
    for (std::size_t i = 1; i < line.words.size(); ++i) {
      const std::string word = lower(line.words[i]);
      if (word != "vis" && word != "trace")
        diagnostics_.warn(
            line.error("the setting '" + line.words[i].substr(0, 40) + "' is not known and left out",
                       "known are VIS and TRACE, which the page has as switches"));
    }
    return {};
  }

  Result<Spot> spot_of(const Line& line) const {
    SL_ASSIGN(const double x, number_at(line, 1, "x in mm"));
    SL_ASSIGN(const double y, number_at(line, 2, "y in mm"));
    SL_ASSIGN(const double phi, number_at(line, 3, "an angle in degrees"));
    return Spot{x * mm, y * mm, radians(phi), line.place};
  }

  Status marker(const Line& line) {
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 1));
    if (n.size() < 2) return line.error("a marker has x and y in mm", "marker 500 500 255 0 0");
    Node out = Node::map(line.place), centre = Node::sequence(line.place), color = Node::sequence(line.place);
    for (std::size_t i = 0; i < 2; ++i) centre.push(number(n[i] * mm, line.place));
    out.set("kind", Node::scalar("disc", line.place));
    out.set("name", Node::scalar("marker_" + std::to_string(markers_.items().size() + 1), line.place));
    out.set("centre", std::move(centre));
    out.set("radius", number(marker_radius_m, line.place));
    if (n.size() >= 5) {
      for (std::size_t i = 2; i < 5; ++i) {
        if (!(n[i] >= 0 && n[i] <= 255)) return line.error("colours are from 0 to 255");
        color.push(number(n[i] / 255, line.place));
      }
      out.set("color", std::move(color));
    }
    out.set("visible", Node::scalar("true", line.place));
    if (!markers_.is_sequence()) markers_ = Node::sequence(line.place);
    markers_.push(std::move(out));
    return {};
  }

  /// object x y phi friction MODEL: the older form of an object, whose type is the name of its model.
  static bool is_classic_object(const Line& line) {
    return line.arguments() == 5 && is_number(line.words[1]) && is_number(line.words[2]) &&
           is_number(line.words[3]) && is_number(line.words[4]);
  }

  Status classic_object(const Line& line) {
    Line short_form = line;
    short_form.words = {fs::path(path_of(line.words[5])).stem().string(), line.words[1], line.words[2],
                        line.words[3]};
    const Type* const type = type_of(short_form);
    return type && !type->is_robot ? object(short_form, *type) : unknown(short_form);
  }

  /// robot|robi [name] FILE.robi PROGRAM [model] [x y phi]: the older form, placed by the numbers in its end or by the line
  /// `position` behind it. Without a program the line only loads the type.
  Status classic_robot(const Line& line) {
    std::optional<std::string> program;
    std::optional<Spot> spot;
    for (std::size_t i = 1; i < line.words.size(); ++i) {
      const std::string extension = lower(fs::path(line.words[i]).extension().string());
      const bool numbers = i + 3 == line.words.size() && is_number(line.words[i]) &&
                           is_number(line.words[i + 1]) && is_number(line.words[i + 2]);
      if (numbers && program) {
        Line end = line;
        end.words.erase(end.words.begin() + 1, end.words.begin() + static_cast<std::ptrdiff_t>(i));
        SL_ASSIGN(spot, spot_of(end));
        break;
      }
      if (extension == ".so" || extension == ".dll" || extension == ".x" || extension == ".c" ||
          extension == ".cpp" || extension == ".py")
        program = program_named(line.words[i], line);
      else if (extension == ".ms3d" || extension == ".obj")
        diagnostics_.warn(line.error("the model of a robot is named in its .robi file; this one is left out",
                                     "write in the .robi file: model " + line.words[i].substr(0, 60)));
    }
    if (!program) return {};
    for (const Type& type : types_)
      if (type.place.line == line.place.line) placed_.push_back({line, &type, program, spot, {}});
    return {};
  }

  Status robot(const Line& line, const Type& type) {
    Placed out{line, &type, {}, {}, {}};
    std::size_t next = 1;
    if (line.arguments() >= 1 && is_number(line.words[1])) {
      SL_ASSIGN(out.spot, spot_of(line));
      next = 4;
    } else if (line.arguments() >= 1 && line.words[1].size() == 1) {
      next = 2;  // the letter of a start
      if (line.words.size() > next && is_number(line.words[next])) {
        SL_ASSIGN(const double phi, number_at(line, next, "an angle in degrees"));
        out.yaw_rad = radians(phi);
        ++next;
      }
    }
    if (line.words.size() > next) out.program = program_named(line.words[next++], line);
    if (line.words.size() > next)
      diagnostics_.warn(line.error("a robot has its place and a program; what follows is left out"));
    placed_.push_back(std::move(out));
    return {};
  }

  Status object(const Line& line, const Type& type) {
    Placed out{line, &type, {}, {}, {}};
    SL_ASSIGN(out.spot, spot_of(line));
    placed_.push_back(std::move(out));
    return {};
  }

  // --- writing keys ---

  static Node number(double value, const Place& place) { return Node::scalar(number_text(value), place); }

  std::string unique(const std::string& name) {
    const std::string stem = sanitised(name);
    std::string out = stem;
    for (int i = 2; !used_.insert(out).second; ++i) out = stem + "_" + std::to_string(i);
    return out;
  }

  Result<Node> pose(const Placed& placed) {
    Spot spot;
    if (placed.spot) {
      spot = *placed.spot;
    } else {
      if (next_start_ >= starts_.size())
        return placed.line.error(
            starts_.empty() ? "the world has no start for this robot"
                            : "the world has " + std::to_string(starts_.size()) + " starts for more robots",
            "give the robot x y in mm and an angle in degrees");
      spot = starts_[next_start_++];
    }
    Node out = Node::sequence(placed.line.place);
    for (const double each : {spot.x_m, spot.y_m, placed.yaw_rad.value_or(spot.yaw_rad)})
      out.push(number(each, placed.line.place));
    return out;
  }

  /// Numbers of the distance sensors, where they do not simply count from 1 in their order.
  static void add_numbers(const Robi& robi, const Place& place, Node& out) {
    std::vector<std::pair<int, std::string>> numbers;
    for (const model::DeviceDecl& device : robi.instance.devices)
      for (const auto& [number, name] : robi.psds)
        if (name == device.name) numbers.emplace_back(number, name);
    bool counted = true;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      counted = counted && numbers[i].first == static_cast<int>(i + 1);
    if (counted) return;
    Node& distances = out.set("distances", Node::sequence(place));
    for (const auto& [number, name] : numbers)
      distances.push(Node::scalar(std::to_string(number) + "=" + name, place));
  }

  /// @param robi  null: a robot of Sandlot
  static Node controller(const std::string& program, const Robi* robi, const Place& place) {
    Node out = Node::map(place);
    if (starts_with(program, own_controller)) {
      // Keys of its own stand behind a ?, as those of builders.
      const std::string_view words = std::string_view(program).substr(own_controller.size());
      const std::size_t mark = std::min(words.find('?'), words.size());
      out.set("kind", Node::scalar(std::string(words.substr(0, mark)), place));
      if (mark < words.size())
        for (const std::string_view each : split(words.substr(mark + 1), '&')) {
          const std::size_t equals = std::min(each.find('='), each.size());
          out.set(std::string(each.substr(0, equals)),
                  Node::scalar(std::string(each.substr(std::min(equals + 1, each.size()))), place));
        }
      return out;
    }
    out.set("kind", Node::scalar("robios", place));
    out.set("program", Node::scalar(program, place));
    // Each program of EyeSim may call SIM functions.
    out.set("supervisor", Node::scalar("true", place));
    if (robi) add_numbers(*robi, place, out);
    return out;
  }

  Node devices(const Placed& placed) const {
    const Place& place = placed.line.place;
    Node out = Node::map(place);
    for (const char* const kind : unit_devices) {
      Node keys = Node::map(place);
      keys.set("kind", Node::scalar(kind, place));
      // Programs get packets as the channel leaves them.
      if (std::string_view(kind) == "radio") keys.set("level", Node::scalar("bits", place));
      out.set(kind, std::move(keys));
    }
    if (!placed.type->robi) return out;
    // Pictures are most of what such a robot costs: a program of RoBIOS gets those that it asks for.
    const bool asks = placed.program && !starts_with(*placed.program, own_controller);
    for (const model::DeviceDecl& device : placed.type->robi->instance.devices) {
      // What the robot's own file says of its errors stays, unless this one says something.
      const bool own = device.config.find("noise") || device.config.find("command_errors");
      Node keys = own ? errors_.keys_for(device.kind) : errors_.keys_to_tune(device.kind, place);
      if (asks && device.kind == "camera") {
        if (keys.is_null()) keys = Node::map(place);
        keys.set("on_request", Node::scalar("true", place));
      }
      if (!keys.is_null()) out.set(device.name, std::move(keys));
    }
    return out;
  }

  Result<Node> tree(const Place& place) {
    Node out = Node::map(place);
    out.set("version", Node::scalar("1", place));
    out.set("name", Node::scalar(fs::path(file_).stem().string(), place));
    if (world_) out.set("world", Node::scalar(world_->words[1], world_->place));
    Node time = Node::map(place);
    time.set("step", step_.is_null() ? Node::scalar("50 ms", place) : step_);
    time.set("substeps", Node::scalar(substeps, place));
    out.set("time", std::move(time));
    Node robot_list = Node::sequence(place), thing_list = Node::sequence(place);
    for (const Placed& each : placed_) {
      Node keys = Node::map(each.line.place);
      keys.set("name", Node::scalar(unique(each.type->name), each.line.place));
      // A relative path starts from the file of the line that names it, which is this one.
      keys.set("model",
               Node::scalar(each.type->file, each.type->place.file ? each.type->place : each.line.place));
      SL_ASSIGN(Node X, pose(each));
      keys.set("pose", std::move(X));
      if (each.type->is_robot) {
        if (each.program)
          keys.set("controller",
                   controller(*each.program, each.type->robi ? &*each.type->robi : nullptr, each.line.place));
        keys.set("devices", devices(each));
        // A sample of every sensor in every slot, where its type says nothing else.
        keys.set("rate", Node::scalar(number_text(1e3 / step_ms_) + " Hz", each.line.place));
      } else {
        keys.set("label", Node::scalar(lower(each.type->name), each.line.place));
      }
      (each.type->is_robot ? robot_list : thing_list).push(std::move(keys));
    }
    if (!thing_list.items().empty()) out.set("things", std::move(thing_list));
    if (!robot_list.items().empty()) {
      out.set("robots", std::move(robot_list));
      out.set("media", radio(place));
    }
    if (!markers_.is_null()) out.set("markers", std::move(markers_));
    return out;
  }

  /// Radio that reaches everybody and loses nothing but what the error model says: EyeBots take turns.
  Node radio(const Place& place) const {
    Node air = Node::map(place), out = Node::sequence(place);
    air.set("kind", Node::scalar("radio", place));
    air.set("name", Node::scalar("air", place));
    air.set("collisions", Node::scalar("false", place));
    air.set("half_duplex", Node::scalar("false", place));
    if (errors_.bit_error_rate) {
      air.set("bit_error_rate", number(*errors_.bit_error_rate, errors_.place));
      air.set("drop", number(*errors_.drop, errors_.place));
    }
    out.push(std::move(air));
    return out;
  }

  const std::string& file_;
  SearchPath search_;
  Diagnostics& diagnostics_;
  std::optional<Line> world_;
  std::vector<Spot> starts_;
  std::size_t next_start_ = 0;
  std::list<Type> types_;
  std::set<std::string> names_;
  std::vector<Placed> placed_;
  Node markers_, step_;
  double step_ms_ = 50;
  ErrorModels errors_;
  std::set<std::string> used_{"ground", "walls", "ball", "box"};  ///< of the world
};

}  // namespace

std::string built_in_type(const std::string& model, bool robot) {
  for (const BuiltIn& each : robot ? std::span<const BuiltIn>(robots) : std::span<const BuiltIn>(objects))
    if (model == each.file) return each.name;
  return "";
}

std::string declared_type(const std::string& written, const std::string& folder, bool robot,
                          const Place& place) {
  Type type{"", written, place, robot, {}};
  return name_in(type, folder, search_path());
}

Result<Node> sim_tree(std::string_view text, const std::string& file, const ReadOptions& options,
                      Diagnostics& diagnostics) {
  SL_ASSIGN(const std::vector<Line> lines, lines_of(text, file));
  return Reader(file, options.path, diagnostics).read(lines);
}

}  // namespace sandlot::formats::eyesim
