/// A shared library that is not a plugin.
int nothing_of_ours() { return 1; }
