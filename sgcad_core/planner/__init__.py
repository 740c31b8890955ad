"""Kinematic planner: motions on real lane geometry that bring about the declared contact."""

from sgcad_core.planner.plan import Plan, plan

__all__ = ["Plan", "plan"]
