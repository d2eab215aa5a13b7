/* Pins of a Raspberry Pi: programs of the real robot include this and use RoBIOS. */
