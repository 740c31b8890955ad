"""A case's links in the desk: to the runs that its folder names, on pages that are served now.

For a result without links its MLflow run is looked up in the sqlite file beside it (read only), and its task run is
searched by name.
"""

from __future__ import annotations

import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from flows.case_files import case_links

DATABASE = "mlflow.db"
_RUN = """
select r.run_uuid, r.experiment_id from runs r
join tags n on n.run_uuid = r.run_uuid and n.key = 'mlflow.runName' and n.value = ?
join tags c on c.run_uuid = r.run_uuid and c.key = 'sgcad.config' and c.value = ?
where r.lifecycle_stage = 'active' order by r.start_time desc limit 1
"""


@dataclass(frozen=True)
class Links:
    """Addresses of the two pages; "": as noted by `make up`, if they are served."""

    root: Path
    mlflow: str = ""
    prefect: str = ""

    def of(self, key: str, config: str, case: str) -> list[tuple[str, str]]:
        """(name, address) of a case's runs."""
        kept, here = case_links.kept(self.root / key), case_links.served(self.root)
        prefect, mlflow = self.prefect or here.prefect, self.mlflow or here.mlflow
        found = [("Prefect", self._prefect(kept, prefect, f"{config}/{case}")),
                 ("Prefect graph", case_links.resolved(kept["prefect"], prefect) if "prefect" in kept else ""),
                 ("MLflow", self._mlflow(kept, mlflow, key, config, case))]  # fmt: skip
        return [(name, address) for name, address in found if address]

    def _prefect(self, kept: dict[str, str], where: str, name: str) -> str:
        if "prefect_case" in kept:
            return case_links.resolved(kept["prefect_case"], where)
        return f"{where}/runs?tab=task-runs&task-runs.name={quote(name)}" if where else ""

    def _mlflow(self, kept: dict[str, str], where: str, key: str, config: str, case: str) -> str:
        if "mlflow" in kept:
            return case_links.resolved(kept["mlflow"], where)
        run = self._run(key, config, case) if where else None
        return f"{where}/#/experiments/{quote(run[1])}/runs/{quote(run[0])}" if run else ""

    def _run(self, key: str, config: str, case: str) -> tuple[str, str] | None:
        """The newest MLflow run of a case, from the database nearest above its folder."""
        for folder in (self.root / key).parents:
            file = folder / DATABASE
            if file.is_file():
                return _asked(file, config, case)
            if folder == self.root:
                break
        return None


def _asked(file: Path, config: str, case: str) -> tuple[str, str] | None:
    try:
        with closing(sqlite3.connect(f"file:{quote(str(file))}?mode=ro", uri=True, timeout=0.5)) as database:
            row = database.execute(_RUN, (case, config)).fetchone()
    except sqlite3.Error:  # locked or of another version: no link
        return None
    return (str(row[0]), str(row[1])) if row else None
