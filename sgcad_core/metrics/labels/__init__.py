"""Executions held against labels of people: maneuvers, contacts and the course of a crash."""
