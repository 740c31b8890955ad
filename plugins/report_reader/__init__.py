"""Files -> CrashReport. One file per choice."""
