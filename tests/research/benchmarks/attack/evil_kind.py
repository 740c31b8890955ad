"""A kind of attack whose product does all that must not be: the campaign has to see each."""

import os
import signal
import sys
import time
from itertools import cycle

from sgcad_core.errors import BadInput, PluginFault

NAME = "evil"
WAYS = ("well", "refuse", "stumble", "plugin", "write", "made", "grow", "slow", "hang", "die", "exit", "say", "well")


def inputs(rng, folder):
    yield from ("well", "well") if folder.name == "warm" else ()
    yield from cycle(WAYS)


def feed(item):
    globals()[item]()


def well():
    pass


def refuse():
    raise BadInput("no")


def stumble():
    raise KeyError("V5")


def plugin():
    raise PluginFault("returned None")


def write():
    with open(os.path.join(os.environ["TMPDIR"], "..", "elsewhere"), "w") as out:
        out.write("x")


def made():
    os.makedirs(os.path.join(os.environ["TMPDIR"], "..", "made"), exist_ok=True)


def grow():
    taken = bytearray(600 << 20)
    taken[::4096] = b"x" * len(taken[::4096])


def slow():
    until = time.process_time() + 2.5
    while time.process_time() < until:
        pass


def hang():
    time.sleep(60)


def die():
    os.kill(os.getpid(), signal.SIGSEGV)


def exit():
    sys.exit(3)


def say():
    os.write(2, b"Traceback (most recent call last)\n  of a thread\nKeyError: 5\n")
