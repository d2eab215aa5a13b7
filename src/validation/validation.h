#pragma once
/// Validations: simulations whose result theory predicts. `sandlot validate` runs them and writes the page.
///
/// Each measures through the engines' public border, with the settings a scenario has by default, and sets
/// next to the measured number the one that follows from a formula, and the bound within which it has to lie.
/// Bounds that are not a rounding are those of the method (a time step, an iterative solver), and the text
/// states which.
#include <string>
#include <vector>

namespace sandlot::validation {

struct Row {
  std::string what;    ///< "ball dropped from 1 m, e 0.8: height of the first rebound"
  std::string engine;  ///< and settings: "rigid, 1 ms"
  std::string unit;    ///< of both numbers
  double measured = 0;
  double expected = 0;
  double bound = 0;      ///< of the deviation below
  bool relative = true;  ///< deviation = |measured - expected| / |expected|, else the plain difference

  double deviation() const;
  bool ok() const { return deviation() <= bound; }
};

/// Lines over a common x.
struct Figure {
  std::string name;  ///< of its file, without extension
  std::string title;
  std::vector<std::string> names, units;     ///< of the columns
  std::vector<std::vector<double>> columns;  ///< the first is x
};

/// Numbers without bounds, to look up.
struct Table {
  std::string title;
  std::vector<std::string> names;  ///< of the columns
  std::vector<std::vector<std::string>> rows;
};

struct Section {
  std::string name;   ///< as the command line spells it
  std::string title;  ///< as the page does
  std::string text;   ///< what is done, which theory, which limits; Markdown
  std::vector<Row> rows;
  std::vector<Figure> figures;
  std::vector<Table> tables = {};
};

/// One line per section in validation.cpp.
struct Validation {
  const char* name;
  const char* help;
  Section (*run)();
};
const std::vector<Validation>& validations();

// The sections.
Section impacts();    ///< two bodies, a bouncing ball, Newton's cradle
Section friction();   ///< inclines, sliding, rolling, piles at rest
Section drives();     ///< each drive at each level on each engine
Section odometry();   ///< of wheels that slip
Section switching();  ///< of a drive's level, on the way
Section radio();      ///< propagation, times, errors and access of the medium
Section surfaces();   ///< substances, belts, skins, zones

}  // namespace sandlot::validation
