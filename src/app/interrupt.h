#pragma once
/// Request of the user to stop: SIGINT or SIGTERM. One for the whole program.

namespace sandlot::app {

/// From here on the signals are taken as requests. A second one, half a second later or more, ends the
/// program at once.
void catch_interrupts();
bool interrupted();

}  // namespace sandlot::app
