"""Who starts the study: lays it out, watches, brings home.

python -m tests.hosts.coordinate STUDY CASES OUT ADDRESS
"""

from __future__ import annotations

import sys
from pathlib import Path

from sgcad_core import settings
from tests.hosts.services import MLFLOW

PATIENCE_S, BEAT_S = 20.0, 2.0
SHARDS = 3


def main() -> None:
    """Run the study on the hosts; a line for every case that comes home, and for every shard submitted again."""
    study, cases, out, address = sys.argv[1:]
    settings.quiet_libraries()
    from flows.deploy.shards import study_on_hosts
    from flows.study.plan import plan
    from flows.study.watch_shards import Hosts
    from flows.study_file.spec import load_study

    tracker = ["tracker=mlflow", f"tracker.uri={MLFLOW}", f"tracker.experiment=study/{Path(study).stem}"]
    made = plan(load_study(Path(study)), Path(out), cases=[Path(cases)], overrides=tracker)
    hosts = Hosts(address, shards=SHARDS, jobs=1, beat_s=BEAT_S, patience_s=PATIENCE_S, start_s=240.0)
    again = study_on_hosts(made, hosts, lambda job, ending, untracked: tell("home", job.name, untracked))
    for line in again:
        tell("again", line)


def tell(*words: str) -> None:
    """A line for whoever reads the log."""
    sys.stdout.write(" ".join(words) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
