"""The layout of a sense vector: every line belongs to one channel, whatever the wiring; sensors of an MJCF are felt."""

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.body import SimulatedBody
from models.errors import BodyError
from models.hoap2 import SCENE
from models.senses import Channel, Senses

CHANNELS = (
    Channel("angle", "angle", "rad", ("hip", "knee"), (-1.0, 0.0), (1.0, 2.0)),
    Channel(
        "place", "image position", "px", ("red", "blue", "lime"), 0.0, (159.0, 119.0), (("left", "right"), ("u", "v"))
    ),
    Channel("area", "area", "px^2", ("red", "blue", "lime"), 0.0, 9.0, (("left", "right"),), suffix="area"),
)
SIZE = 2 + 12 + 6


@given(st.integers(0, 2**31), st.integers(0, 3))
def test_whatever_the_order_a_vector_reads_back_and_covers_every_line_once(seed: int, leading: int) -> None:
    rng = np.random.default_rng(seed)
    senses = Senses(CHANNELS, rng.permutation(SIZE))
    assert len(senses) == SIZE
    lines = np.concatenate([senses.lines(channel.name).ravel() for channel in CHANNELS])
    assert sorted(lines) == list(range(SIZE))
    readings = {c.name: rng.normal(size=(*(3,) * leading, *c.shape)) for c in CHANNELS}
    vector = senses.vector(readings)
    assert vector.shape == (*(3,) * leading, SIZE) and np.isfinite(vector).all()
    for channel in CHANNELS:
        np.testing.assert_array_equal(senses.read(vector, channel.name), readings[channel.name])
        low, high = (senses.read(v, channel.name) for v in (senses.low, senses.high))
        np.testing.assert_array_equal(low, np.broadcast_to(channel.low, channel.shape))
        np.testing.assert_array_equal(high, np.broadcast_to(channel.high, channel.shape))
        assert [senses.labels[i] for i in senses.lines(channel.name).ravel()] == list(channel.names)
    part = senses.read(vector, "place", ("lime", "red"))
    np.testing.assert_array_equal(part, readings["place"][..., [2, 0], :, :])
    unseen = senses.vector({"angle": readings["angle"]})
    assert np.isnan(np.delete(unseen, senses.lines("angle"), axis=-1)).all()


def test_names_say_what_stands_on_a_line() -> None:
    senses = Senses(CHANNELS)
    assert senses.labels[:6] == ("hip", "knee", "red left u", "red left v", "red right u", "red right v")
    assert senses.labels[-1] == "lime right area" and len(set(senses.labels)) == SIZE
    some = CHANNELS[0].only(("knee",))
    assert (some.labels, some.low, some.high) == (("knee",), [0.0], [2.0])


def test_wrong_names_are_one_line() -> None:
    senses = Senses(CHANNELS)
    with pytest.raises(BodyError, match=r"unknown sense 'plac'; there are angle, area, place; did you mean 'place'\?"):
        senses.lines("plac")
    with pytest.raises(BodyError, match="unknown label of sense 'place' 'rad'; there are blue, lime, red"):
        senses.lines("place", ("rad",))
    with pytest.raises(BodyError, match="sense channels angle, angle: each needs a name of its own"):
        Senses([CHANNELS[0], CHANNELS[0]])


def test_a_reading_is_noisy_as_declared_and_in_whole_pulses() -> None:
    rng, true = np.random.default_rng(0), np.full((20_000, 2), 0.3)
    noisy = Channel("load", "load", "N m", ("hip", "knee"), 0.0, 1.0, noise=(0.1, 0.0)).measured(true, rng)
    np.testing.assert_allclose(noisy.std(0), (0.1, 0.0), rtol=0.03, atol=1e-9)
    np.testing.assert_allclose(noisy.mean(0), 0.3, atol=0.004)
    pulses = Channel("angle", "angle", "rad", ("hip", "knee"), 0.0, 1.0, noise=0.05, pulses=40.0).measured(true, rng)
    np.testing.assert_allclose(pulses * 40, np.rint(pulses * 40), atol=1e-9)


HOPPER = """
<mujoco>
  <option timestep="0.005" integrator="implicitfast"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="base" pos="0 0 0.1">
      <freejoint/>
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <site name="sole" type="box" size="0.12 0.12 0.02" pos="0 0 -0.1"/>
      <site name="imu"/>
      <body pos="0 0 0.1">
        <joint name="neck" axis="0 0 1" range="-90 90" armature="0.001" damping="0.01"/>
        <geom type="capsule" fromto="0 0 0 0 0 0.1" size="0.02" mass="0.05"/>
        <site name="brow"/>
      </body>
    </body>
  </worldbody>
  <actuator><position name="neck" joint="neck" kp="2" kv="0.05" inheritrange="1"/></actuator>
  <sensor>
    <gyro name="brow_gyro" site="brow" noise="0.02" cutoff="20"/>
    <accelerometer name="imu_accelerometer" site="imu"/>
    <touch name="sole_load" site="sole"/>
    <clock name="clock"/>
    <gyro name="imu_gyro" site="imu"/>
  </sensor>
</mujoco>
"""
SIDES = ("left", "right")
FELT = ("brow_gyro", "imu_accelerometer", "sole_load", "imu_gyro")


def hopper(sensors: tuple[str, ...] = FELT, **options: object) -> SimulatedBody:
    """A block that stands free on the floor, a neck on top."""
    model = mujoco.MjModel.from_xml_string(HOPPER)
    return SimulatedBody(model, name="hopper", sensors=sensors, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("scramble", [None, 4])
def test_a_free_body_feels_its_weight_and_how_it_turns(scramble: int | None) -> None:
    body = hopper(copies=20, scramble=scramble)
    still = body.command_angles(np.zeros((20, 1)))
    stood = np.array([body.act(still) for _ in range(90)])[40:]
    senses, read = stood[-1], body.senses.read
    weight = 2.05 * 9.81
    np.testing.assert_allclose(read(senses, "touch"), weight, rtol=1e-3)
    np.testing.assert_allclose(read(senses, "accelerometer"), np.tile([0, 0, 9.81], (20, 1, 1)), atol=1e-3)
    gyro = read(stood, "gyro", ("brow_gyro",))
    np.testing.assert_allclose(gyro.std((0, 1)), 0.02, rtol=0.12)  # the noise that its MJCF says
    assert np.abs(read(senses, "gyro", ("imu_gyro",))).max() < 1e-6  # this one has none
    for _ in range(3):
        senses = body.act(body.command_angles(np.full((20, 1), 1.0)))
    turning = read(senses, "gyro", ("brow_gyro",))[:, 0].mean(0)
    base = read(senses, "gyro", ("imu_gyro",))[0, 0]
    assert turning[2] == pytest.approx(read(senses, "speed")[0, 0] + base[2], abs=0.01)
    assert turning[2] > 0.3


def test_hoap2_stands_on_the_loads_of_its_soles() -> None:
    loads = [f"{side}_sole_{end}_{edge}_load" for side in SIDES for end in ("front", "rear") for edge in SIDES]
    model = mujoco.MjModel.from_xml_path(str(SCENE))
    body = SimulatedBody(model, name="hoap2", sensors=("gyro", "accelerometer", *loads))
    still = body.command_angles(body.joint_angles)
    body.reset()
    for _ in range(60):
        senses = body.act(still)
    weight = model.body_subtreemass[0] * 9.81
    assert body.senses.read(senses, "touch", loads).sum() == pytest.approx(weight, rel=0.02)
    assert np.linalg.norm(body.senses.read(senses, "accelerometer")) == pytest.approx(9.81, rel=0.02)
    assert len(body.senses) == 2 * 25 + 3 + 3 + 8


def test_what_sensors_feel_has_units_and_ranges_and_is_not_seen_on_somebody_else() -> None:
    body = hopper()
    units = {name: channel.unit for name, channel in body.senses.channels.items()}
    assert units == {"angle": "rad", "speed": "rad/s", "gyro": "rad/s", "accelerometer": "m/s^2", "touch": "N"}
    np.testing.assert_array_equal(body.senses.read(body.sense_high, "gyro")[:, 0], [20.0, 10.0])  # its cutoff, ours
    assert body.senses.read(body.sense_low, "touch")[0] == 0
    assert body.senses.read(body.sense_high, "touch")[0] == pytest.approx(4 * 2.05 * 9.81)
    assert body.sense_labels[2:5] == ("brow_gyro x", "brow_gyro y", "brow_gyro z")
    seen = body.sensations(np.array([[0.3], [0.4]]))
    np.testing.assert_array_equal(body.senses.read(seen, "angle"), [[0.3], [0.4]])
    assert np.isnan(seen[:, 1:]).all()


def test_the_same_feels_the_same_and_other_senses_are_another_body() -> None:
    one, same, fewer, none = hopper(), hopper(copies=3, seed=2), hopper(("sole_load",)), hopper(())
    assert one.fingerprint == same.fingerprint
    assert len({one.fingerprint, fewer.fingerprint, none.fingerprint}) == 3
    assert none.reset().shape == (1, 2)
    first = one.reset()
    assert (one.reset() != first).any()  # noise goes on
    again = hopper()
    one.reseed(1)
    again.reseed(1)
    np.testing.assert_array_equal(one.reset(), again.reset())


def test_sensors_that_are_not_there_or_nobody_has() -> None:
    with pytest.raises(BodyError, match=r"unknown sensor 'sole'; there are .*did you mean 'sole_load'"):
        hopper(("sole",))
    with pytest.raises(BodyError, match="sensor 'clock': a body does not feel a <clock>"):
        hopper(("clock",))
