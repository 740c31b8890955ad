"""Traffic rules: what each actor of a crash or of a drive breaks, from the map, the signal plan and the trajectories.

One module per rule or two, each a function from a `RuleScene` to findings; `judge` runs all. A rule
about which the map says nothing gives `unknown`, never `kept`. Rules are those of the Uniform Vehicle Code (UVC, 2000):
right-hand traffic.
"""
