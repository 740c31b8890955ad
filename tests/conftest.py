"""For all tests: Ctrl-C reaches the programs that they start, and tests that run side by side share the cores.

A shell without job control starts background jobs with SIGINT ignored, and children inherit that; a handler here
makes them start with the usual one. A worker of pytest-xdist (`make test`) has one core for itself and its programs:
torch and its like would start as many threads in each as there are cores, and wait for each other.

Compiled modules are kept, also where the environment forbids it, as images for containers do: each worker and each
program that a test starts would compile the project anew.

Commands that are given no config take the rules alone here, which load no model; tests of the default say so.

Property tests draw the same examples in every run, so that a verdict depends on the change, not on luck or load; `make
test-thorough` draws new ones, and more.
"""

import gc
import os
import signal
import sys

import pytest
from hypothesis import settings

from tests.effort import THOROUGH

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

os.environ["SGCAD_CONFIG"] = "template.yaml"

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

if "PYTEST_XDIST_WORKER" in os.environ:
    for threads in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"):
        os.environ.setdefault(threads, "1")

settings.register_profile("usual", derandomize=not THOROUGH, deadline=None)
settings.load_profile("usual")


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Spares the garbage collector a million objects that stay to the end; else it takes a sixth of the tests' time."""
    gc.disable()
    outcome = yield
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)
    gc.enable()
    return outcome
