#pragma once
/// The substances that files may name, and substances as text.
///
///   substance    roughness  slip  hardness  elasticity   argument     usual
///   metal(r)     r          0.01  200       0.8          roughness    0.1 to 1
///   plastic(r)   r          0.01  40        0.5          roughness    0.5 to 2
///   rubber(h)    3          0     h         0.95         hardness     5 to 50
///   foam(h)      2          0.1   h         0            hardness     1 to 30
///   snow(s)      1 - s      s     40        0            slip         0 to 1
///
/// Source   G. Martius, Goal-Oriented Control of Self-Organizing Behavior in Autonomous Robots (2010), table 2.1. That
///          plastic(0.8) is what things are made of by default is LpzRobots' habit.
#include <string>
#include <string_view>

#include "base/result.h"
#include "model/surface.h"

namespace sandlot::model {

struct NamedSubstance {
  Substance substance;
  std::string warning;  ///< the argument is outside what the table gives; "": it is not
};

/// `rubber(20)`, `rubber` (with a middling argument), or four numbers: roughness, slip, hardness, elasticity.
Result<NamedSubstance> substance_from(std::string_view text);

/// "rubber(20)" where a preset fits, else the four numbers; substance_from() makes the same of it, to the last bit.
std::string text_of(const Substance& substance);

}  // namespace sandlot::model
