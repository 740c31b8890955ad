"""Names of fields and values on the desk: words and units, no keys."""

import pytest

from flows.desk.views.field_words import name_of, shown


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("vehicles.V1.start_lane", 1, "starts in lane 1"),
        ("vehicles.V1.rest.facing_deg", 180.0, "faces at rest 180 °"),
        ("vehicles.V1.rest.lane_way", "S", "rests in a lane toward S"),
        ("vehicles.V1.spin_deg", 90.0, "spin 90 °"),
        ("junction.kind", "t", "is a T-intersection"),
        ("junction.kind", "four_leg", "is a four-leg intersection"),
        ("vehicles.V2.length_m", None, "length open"),
    ],
)
def test_a_field_and_its_value_read_as_words(field, value, said):
    assert f"{name_of(field)} {shown(field, value)}" == said
