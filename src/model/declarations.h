#pragma once
/// What files declare of a run: devices, controllers, plugins, named values, events and logs, each by its kind's or its
/// own keys.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "base/shared_list.h"
#include "base/time.h"
#include "geometry/pose.h"

namespace sandlot::model {

/// A device as a file declares it. `kind` is Sandlot's name for it; a declaration taken from SDF leaves it empty
/// and lists what the file called it (`sensor:gpu_lidar`, `plugin:DiffDrive`), most specific first.
struct DeviceDecl {
  std::string name;
  std::string kind;
  std::vector<std::string> sdf_types;
  std::string scope;
  std::uint32_t link = 0;
  Pose X_LS;
  Node config;  ///< keys of the kind's spec, or the SDF element's children when `kind` is empty
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the device."}, s.name);
    visit(Field{"kind", "", "Kind of the device; empty before the names of SDF are translated."}, s.kind);
    visit(Field{"sdf_types", "", "Names in the SDF file, most specific first."}, s.sdf_types);
    visit(
        Field{"scope", "",
              "Prefix of a part of a composed model, such as arm::, under which names in `config` are looked "
              "up first."},
        s.scope);
    visit(Field{"link", "", "Index of the link that carries the device."}, s.link);
    visit(Field{"pose", "", "Pose in the link."}, s.X_LS);
    visit(Field{"config", "", "Keys of the kind."}, s.config);
  }
};

/// A property of a robot or object that the user gives it, such as fuel or health: a number that rules and people change while
/// the run goes on, within its range.
struct PropertyDecl {
  std::string name, unit;
  double value = 0;  ///< now; at the start that of the file
  double min = -1e12, max = 1e12;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the property."}, s.name);
    visit(Field{"unit", "", "Unit of the value."}, s.unit);
    visit(Field{"value", "", "Present value."}, s.value);
    visit(Field{"min", "", "Least value."}, s.min);
    visit(Field{"max", "", "Greatest value."}, s.max);
  }
};

struct ControllerDecl {
  std::string name;  ///< unique within its robot; "controller" by default
  std::string kind;
  Node config;
  Place place;
  double rate_hz = 0;  ///< the robot's rate; a `rate` in `config` precedes it. 0: the run's control steps
  Place rate_place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the controller; unique within its robot."}, s.name);
    visit(Field{"kind", "", "Kind of the controller."}, s.kind);
    visit(Field{"config", "", "Keys of the kind."}, s.config);
    visit(Field{"rate", "Hz", "Control steps per second where the keys give none; 0: those of the run."},
          s.rate_hz);
  }
};

/// What a team, or the whole run, is judged by: expressions over addresses.
struct CriterionDecl {
  std::string value;
  std::string success;  ///< other than 0 at the end where the run succeeded; "": not asked
  Place place, success_place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"value", "", "Expression whose value at the end is the figure of merit.", 0, 0,
                Field::required, 2000},
          s.value);
    visit(Field{"success", "", "Expression that is other than 0 at the end where the run succeeded.", 0, 0,
                Field::none, 2000},
          s.success);
  }
};

/// Robots that programs of their own drive together. A robot names its team.
struct TeamDecl {
  std::string name;  ///< address: unique among teams and instances
  SharedList<ControllerDecl> controllers;
  Place place;
  std::optional<CriterionDecl> criterion;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the team."}, s.name);
    visit(Field{"controllers", "", "Control programs of the team."}, s.controllers);
    visit(Field{"criterion", "", "What the team is judged by."}, s.criterion);
  }
};

/// A rule, medium or marker of the world.
struct ElementDecl {
  std::string name;  ///< unique in its list; the kind by default
  std::string kind;
  Node config;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the element; unique in its list."}, s.name);
    visit(Field{"kind", "", "Kind of the element."}, s.kind);
    visit(Field{"config", "", "Keys of the kind."}, s.config);
  }
};

/// A shared library with controllers of the user's own.
struct PluginDecl {
  std::string file;
  std::string name;
  std::uint64_t hash = 0;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"file", "", "File of the library."}, s.file);
    visit(Field{"name", "", "Name that the library gives itself; known once it is loaded."}, s.name);
    visit(Field{"hash", "", "Hash of the file's bytes, so that a snapshot notices another build."}, s.hash);
  }
};

/// A value that a scenario names: an expression over addresses (sim/watch/expression.h).
struct ValueDecl {
  std::string name;
  std::string expression;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the value."}, s.name);
    visit(Field{"expression", "", "Expression over addresses."}, s.expression);
  }
};

/// Something that happens when a condition has held for a while.
struct EventDecl {
  std::string name;
  std::string when;
  Time hold;
  bool once = false;
  bool stop = false;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the event."}, s.name);
    visit(Field{"when", "", "Condition: an expression that is other than 0 while it holds."}, s.when);
    visit(Field{"for", "s", "Time for which the condition must hold without a break."}, s.hold);
    visit(Field{"once", "", "Whether the event happens only once."}, s.once);
    visit(Field{"stop", "", "Whether the event ends the run."}, s.stop);
  }
};

/// Values written to a CSV file while the run goes on. Not part of a snapshot: a run that is continued starts another
/// file.
struct LogDecl {
  std::string file;
  double rate_hz = 0;  ///< 0: every tick
  struct Column {
    std::string expression;
    Place place;
  };
  std::vector<Column> values;
  Place place;
};

}  // namespace sandlot::model
