"""Names of columns end in their unit, and numbers follow it."""

import pytest

from gcodesim.playback.columns import column_of, shown_as

KINDS = {"arm/joint_1": "revolute", "machine/X": "prismatic"}


@pytest.mark.parametrize(
    ("topic", "field", "si", "floor", "divisor"),
    [
        ("/process", "force_n", "process.force_N", "process.force_N", 1.0),
        ("/process", "removal_m3_s", "process.removal_m3_s", "process.removal_mm3_s", 1e-9),
        ("/process", "removed_m3", "process.removed_m3", "process.removed_mm3", 1e-9),
        ("/process", "spindle_rad_s", "process.spindle_rad_s", "process.spindle_rpm", 2 * 3.141592653589793 / 60),
        ("/motion", "feed_m_s", "motion.feed_m_s", "motion.feed_mm_min", 1e-3 / 60),
        ("/process", "film_m", "process.film_m", "process.film_mm", 1e-3),
        ("/process", "heat_j_m", "process.heat_j_m", "process.heat_j_m", 1.0),
        ("/motion", "x_m", "motion.x_m", "motion.x_mm", 1e-3),
        ("/wrench", "torque.z", "wrench.torque_z_Nm", "wrench.torque_z_Nm", 1.0),
        ("/tcp", "pose.position.y", "tcp.y_m", "tcp.y_mm", 1e-3),
        ("/tcp", "pose.orientation.w", "tcp.qw", "tcp.qw", 1.0),
        ("/tf", "transforms[arm/link_2].translation.x", "tf.arm/link_2.x_m", "tf.arm/link_2.x_mm", 1e-3),
        (
            "/joint_states",
            "joints[arm/joint_1].position",
            "joint.arm/joint_1.position_rad",
            "joint.arm/joint_1.position_deg",
            3.141592653589793 / 180,
        ),
        (
            "/joint_states",
            "joints[machine/X].velocity",
            "joint.machine/X.velocity_m_s",
            "joint.machine/X.velocity_mm_s",
            1e-3,
        ),
        ("/joint_states", "joints[machine/X].effort", "joint.machine/X.effort_N", "joint.machine/X.effort_N", 1.0),
        ("/joint_states", "joints[other].position", "joint.other.position", "joint.other.position", 1.0),
    ],
)
def test_names_and_divisors(topic, field, si, floor, divisor):
    assert column_of(topic, field, KINDS) == (si, 1.0)
    name, found = column_of(topic, field, KINDS, "mm")

    assert name == floor and found == pytest.approx(divisor, rel=1e-12)


@pytest.mark.parametrize(
    ("field", "shown"),
    [("film_m", ("film", "mm", 1e-3)), ("wet_m2", ("wet", "mm²", 1e-6)), ("dose_j_m2", ("dose j m2", "", 1.0))],
)
def test_only_lengths_become_mm(field, shown):
    assert shown_as(field)[:2] == shown[:2]
    assert shown_as(field)[2] == pytest.approx(shown[2])
