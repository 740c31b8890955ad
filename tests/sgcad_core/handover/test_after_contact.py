"""Behind the contact of a drive bodies push each other and stop; nothing changes before it."""

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.config import driver_entry
from sgcad_core.geometry.plane import box_gaps
from sgcad_core.handover.after_contact import SHOWN_S, with_aftermath
from sgcad_core.handover.drive import drive
from sgcad_core.handover.script import staging_for
from tests.sgcad_core.handover.scenes import LENGTH, WIDTH, crossing, rear_end


def driven(made, driver="script"):
    return drive(staging_for(made, "V1"), driver_entry(driver).driver)


def test_a_drive_with_a_contact_goes_on_for_its_aftermath():
    for made in (crossing(), rear_end(other=5.0)):
        before = driven(made)
        after = with_aftermath(before)
        for old, new in zip(before.trajectories, after, strict=True):
            n = len(old.t_s)
            assert len(new.t_s) == n + round(SHOWN_S / STEP_S)
            assert np.allclose(new.pose[: n - 1], old.pose[: n - 1])
            assert np.abs(np.diff(new.points, axis=0)).max() < 40 * STEP_S
        one, two = (t.pose[-1:] for t in after)
        assert box_gaps(one, (LENGTH, WIDTH), two, (LENGTH, WIDTH))[0] > -0.3
        assert {t.actor: t.speed_mps[-1] < t.speed_mps[0] for t in after}["V1"]


def test_without_a_contact_a_drive_stays_as_it_is():
    free = driven(rear_end(), "aeb")
    assert (free.contact is None) == (with_aftermath(free) is free.trajectories)
