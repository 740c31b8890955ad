"""A study file: its arms, their configs, and arms named as configs of their own. Starts nothing."""
