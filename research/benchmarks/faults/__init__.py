"""Faults on purpose: commands killed at random points, disks filled, services ended; then the same command again."""
