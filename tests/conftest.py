"""For all tests: Ctrl-C reaches the programs that they start, even where the tests themselves run in the background.

A shell without job control starts background jobs with SIGINT ignored, and children inherit that; a handler here
makes them start with the usual one.
"""

import signal

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
