/* RoBIOS-7 has no tasks of its own. */
