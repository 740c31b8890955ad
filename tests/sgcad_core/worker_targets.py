"""Functions that the worker tests run in a process of their own."""

import gc
import os
import signal
import sys
import time

import numpy as np

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput


def where(*args):
    return os.getpid(), args


def double(values):
    sys.stdout.write("printed, not answered")
    return np.asarray(values) * 2


def die(how):
    if how == "signal":
        os.kill(os.getpid(), signal.SIGSEGV)
    if how == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if how == "exit":
        os._exit(3)
    if how == "raise":
        raise ZeroDivisionError("no way")
    time.sleep(30)


def say(text):
    os.write(2, text.encode())


def refuse():
    raise InvalidOutput("bad net", [Finding(source="s", what="bad")])


def frozen():
    """How many objects the garbage collector passes over for good."""
    return gc.get_freeze_count()
