#pragma once
/// Speed of one match at all levels of its robots' senses and drives: the paper's claim as a table.
#include "app/papers/papers.h"

namespace sandlot::app {

/// Plays the beginning of scenarios/match.yaml at each level, writes levels.csv and puts the table onto the page.
Status add_level_table(const ReproduceContext& context, ReportPage& page);

}  // namespace sandlot::app
