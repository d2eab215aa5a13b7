/// A shared library that is no plugin.
int nothing_of_ours() { return 1; }
