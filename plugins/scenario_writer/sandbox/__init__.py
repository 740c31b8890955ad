"""Runs Python that a model wrote, never in this process: `script_runner.run_script` is the entry.

`script_process` runs in the other process, `script_rules` checks a script before it runs, `isolation` confines the
process, `script_modules` are the modules that a script can import.
"""
