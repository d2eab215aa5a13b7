/// The `sandlot` command itself. It is this small because everything else is in libsandlot, where plugins find it too.
#include "app/commands.h"

int main(int argc, char** argv) { return sandlot::app::command(argc, argv); }
