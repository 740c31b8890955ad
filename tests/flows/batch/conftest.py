"""Batches over small reports."""

import pytest

from flows.batch.plan_batch import batch_of
from flows.case_files.find_cases import cases_in


@pytest.fixture
def batch(tmp_path, config_file, reports):
    """A batch over reports holding these words."""

    def make(jobs=2, fresh=False, config=None, **words):
        folder = tmp_path / "cases"
        found = cases_in([folder if folder.exists() else reports(**words)])
        return batch_of(found, [config or config_file()], tmp_path / "out", jobs=jobs, fresh=fresh)

    return make
