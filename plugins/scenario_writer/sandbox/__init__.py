"""Runs Python that a model wrote, never in our process: `outside.run_script` is the near end.

`inside` is the far end, `rules` what it reads before it runs anything, `confine` the walls it puts up, `modules`
the little world that a script sees.
"""
