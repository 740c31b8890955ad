"""How many ScenarioNet records pass MetaDrive's own check of a record.

    python -m venv ENV && ENV/bin/pip install metadrive-simulator
    ENV/bin/python research/checks/scenarionet_reader.py RUNS/template/*/export/scenarionet

In an environment of its own, for MetaDrive brings a graphics engine. Reads the records that each folder's table names,
through MetaDrive's reader; every one needs an ego, another actor and a lane. Prints what fails, then one line of
figures.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path


def main(folders: Sequence[str]) -> int:
    """Read the records; 1 where one fails."""
    from metadrive.scenario.scenario_description import ScenarioDescription as Record
    from metadrive.scenario.utils import read_dataset_summary, read_scenario_data

    files = good = 0
    for folder in map(Path, folders):
        try:
            _, names, mapping = read_dataset_summary(folder)
        except Exception as fault:  # noqa: BLE001 - whatever the reader raises is what is counted
            files += 1
            sys.stdout.write(f"{folder}: {type(fault).__name__}: {str(fault)[:200]}\n")
            continue
        for name in names:
            files += 1
            try:
                record = read_scenario_data(folder / mapping[name] / name)
                Record.sanity_check(dict(record), check_self_type=True)
                ego, tracks = record["metadata"]["sdc_id"], record["tracks"]
                lanes = [one for one in record["map_features"].values() if "LANE" in str(one["type"])]
                good += ego in tracks and len(tracks) > 1 and bool(lanes)
            except Exception as fault:  # noqa: BLE001 - as above
                sys.stdout.write(f"{name}: {type(fault).__name__}: {str(fault)[:200]}\n")
    sys.stdout.write(f"records {files}; pass {good}\n")
    return int(good < files)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
