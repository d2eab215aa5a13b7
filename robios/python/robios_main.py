"""Runs a program in Python as RoBIOS programs run: this folder's `eye` comes before one that lies beside the program."""
import os
import runpy
import sys

if __name__ == "__main__":
    sys.argv = sys.argv[1:]
    program = os.path.abspath(sys.argv[0])
    here = os.path.dirname(os.path.abspath(__file__))
    sys.path[:] = [here, os.path.dirname(program)] + [each for each in sys.path if each not in ("", here, os.getcwd())]
    runpy.run_path(program, run_name="__main__")
