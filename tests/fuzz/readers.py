"""Everything that reads a file or the words of a stranger, and what holds once it was read."""

import io
import os
import zipfile
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from babbling.errors import BabblingError
from babbling.files import _seal, is_kind, load, save
from babbling.kinds import KINDS
from experiments.battery.choices import choices
from experiments.battery.reading import read
from experiments.battery.recovery import response_chances
from experiments.benchmark.lives import Point
from experiments.command_line import parse
from experiments.compare.reading import Tracks, read_run
from experiments.errors import ExperimentError
from experiments.registry import entry
from experiments.shared import kept
from experiments.shared.experiment import check_out
from models.errors import BodyError
from models.face import FACE, FACES
from models.face.body import face_model
from models.hoap2.facts import JOINTS
from models.loading import load_body
from models.maze import parse_maze, read_maze
from models.maze.drawing import draw
from models.maze.teacher import check_walk
from models.maze.walk_file import read_walks
from models.meshes import meshes
from models.motion import JointTrajectory, read_motion
from models.teachers.amc import BONES
from models.teachers.performance import PARTS, Performance
from models.teachers.performing import perform
from models.teachers.urdf import perform_urdf, remarks
from tests.fuzz import hdf5, samples
from tests.fuzz.mutations import Rng, mutated, pick

Made = Callable[[Path, Sequence[bytes], Sequence[bytes], int, Rng], None]


class Reader(NamedTuple):
    """One way in."""

    file: str
    """What a case is called, in the folder of all cases."""
    seeds: Callable[[Path], Sequence[bytes]]
    """Good examples; what else has to lie in that folder is put there."""
    read: Callable[[Path], object]
    """Read it and hold what was read to what it promises: AssertionError is a finding, like any other exception but"""
    error: type[Exception] | tuple[type[Exception], ...]
    words: tuple[bytes, ...] = ()
    cases: int = 100
    make: Made | None = None
    """Write case `number` to a path; by default `mutated` of the seeds."""

    def write(self, path: Path, seeds: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> None:
        if self.make is not None and number >= len(seeds):
            self.make(path, seeds, others, number, rng)
        else:
            path.write_bytes(mutated(seeds, self.words, others, number, rng))


def finite(*arrays: np.ndarray) -> bool:
    return all(np.isfinite(one).all() for one in arrays)


def a_movement(path: Path, *, ranges: bool = False) -> None:
    joints = {joint: (-3.2, 3.2) for joint in (*JOINTS, "shoulder", "elbow", "wrist")}
    found = read_motion(path, joints if ranges else None, slides=("gripper",))
    for one in (found, found.resampled(0.02)):
        assert one.time[0] == 0 and (np.diff(one.time) > 0).all() and finite(one.time, one.angles)
        assert one.angles.shape == (len(one.time), len(one.joints)) and len({*one.joints}) == len(one.joints) > 0
    assert all(0 < len(name) < 1000 for name in found.joints)


def in_ranges(path: Path) -> None:
    a_movement(path, ranges=True)


def an_archive(path: Path, seeds: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> None:
    """Members changed, then put together again; sometimes the whole is changed as well."""
    with zipfile.ZipFile(io.BytesIO(pick(seeds, rng))) as whole:
        members = {name: whole.read(name) for name in whole.namelist()}
    names = sorted(members)
    for _ in range(int(rng.integers(1, 3))):
        name = str(rng.choice(names))
        members[name] = mutated([members[name]], samples.ARCHIVE, [members[one] for one in names], number, rng)
    way = int(rng.choice([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]))
    with zipfile.ZipFile(path, "w", way) as whole:
        for name, content in members.items():
            whole.writestr(name, content)
        if rng.random() < 0.1:
            whole.writestr(str(rng.choice(["time_ms.npy", "../x.npy", "joints.txt", "x" * 60000])), members[names[0]])
        if rng.random() < 0.05:
            for other in range(2000):
                whole.writestr(f"{other}.npy", b"")
    if rng.random() < 0.3:
        path.write_bytes(mutated([path.read_bytes()], (), others, number, rng))


def seen(found: Performance) -> None:
    assert found.time[0] == 0 and (np.diff(found.time) > 0).all() and finite(found.time, found.points)
    for part, ways in found.directions.items():
        assert part in PARTS and ways.shape == (len(found.time), 3)
        np.testing.assert_allclose(np.linalg.norm(ways, axis=-1), 1, atol=1e-6)
    assert all(len(remark) < 400 and len(remark.splitlines()) == 1 for remark in found.remarks)


def a_teacher(path: Path) -> None:
    time = np.arange(4) / 10
    performance, found = perform_urdf(path, JointTrajectory("x", time, ("left_elbow",), np.sin(time)[:, None]))
    seen(performance)
    assert all(len(" ".join(line.split())) < 2000 for line in remarks(found, path))


def it_moves(path: Path) -> None:
    """What loads can be moved: all it feels is finite and in range, at rest and anywhere else."""
    body = load_body(path, copies=1, threads=1)
    low, high, rng = body.motor_low, body.motor_high, np.random.default_rng(0)
    assert (
        finite(low, high, body.sense_low, body.sense_high, body.joint_range)
        and (body.sense_low < body.sense_high).all()
    )
    felt = [body.reset(), *(body.act(rng.uniform(low, high)[None]) for _ in range(5))]
    assert finite(*felt) and np.abs(felt).max() < 1e9
    assert body.tick_s == 0.02 and len(body.motor_labels) == len(low) > 0


def it_is_dressed(path: Path) -> None:
    """What the body beside it is made of, as it moves and as it is drawn."""
    it_moves(beside := path.with_name("body.xml"))
    model = load_body(beside, copies=1, threads=1).model
    shaped = [i for i in range(model.ngeom) if model.geom_dataid[i] >= 0 and model.geom_type[i] == 7]
    for drawn in meshes(model, shaped, 500).values():
        assert finite(drawn.corners, drawn.normals) and drawn.triangles.max(initial=0) < len(drawn.corners)


def a_face(path: Path) -> None:
    model = face_model.__wrapped__(replace(next(iter(FACES.values())), path=path))
    assert finite(model.body_mass, model.jnt_range)


def a_maze(path: Path) -> None:
    found = read_maze(path)
    again = parse_maze(draw(found))
    assert np.array_equal(again.walls, found.walls) and (again.start, again.goals) == (found.start, found.goals)


def some_walks(path: Path) -> None:
    maze = parse_maze(samples.HALL)
    for walk in read_walks(path, maze):
        check_walk(maze, walk, "again")


def some_trials(path: Path) -> None:
    """A table of choices; what can be fitted sums to 1."""
    frame = read(path)
    assert len(frame) and {"agent", "task", "condition", "trial", "response"} <= set(frame)
    told = choices(frame)
    sums = np.bincount(told.situation, response_chances(told, np.array([[1.5, 0.5, 0.1]]))[:, 0])
    np.testing.assert_allclose(sums, 1)


LARGE = ("balance", "body image", "eyes", "face mind", "interrupted babble", "mind", "play")


def a_kind(name: str) -> Reader:
    """Files of what was learned, in HDF5."""

    def seeds(folder: Path) -> list[bytes]:
        return [samples.kinds()[name]]

    def read(path: Path) -> None:
        holds, again = KINDS[name].holds, path.with_name("again.nc")
        known, thing = is_kind(path, holds), load(path, holds)
        assert known
        try:
            save(thing, again)
            load(again, holds)
        except BabblingError as error:
            raise AssertionError(f"what was read cannot be written and read again: {error}") from error
        finally:
            again.unlink(missing_ok=True)

    return Reader("case.nc", seeds, read, KINDS[name].error, (), 12 if name in LARGE else 30, a_netcdf)


def a_netcdf(path: Path, seeds: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> None:
    whole = pick(seeds, rng)
    if number % 4:
        path.write_bytes(whole)
        hdf5.spoil(path, rng)
    elif number % 16:  # as another program might have left it: no checksum tells that it is damaged
        path.write_bytes(mutated([whole[: -len(_seal(b""))]], (), others, number + 1, rng))
    else:
        path.write_bytes(mutated(seeds, (), others, number, rng))


def a_run(path: Path) -> None:
    run = read_run(path.parent, "run")
    assert finite(*run.metrics.values()) and all(name.isprintable() for name in (*run.metrics, run.experiment))
    if isinstance(tracks := run.tracks, Tracks):
        assert finite(tracks.time, tracks.demonstrated, tracks.imitated, tracks.error) and tracks.tick_s > 0
        assert tracks.busiest and tracks.of(tracks.busiest).demonstrated.shape == tracks.demonstrated.shape


def an_older_result(path: Path) -> None:
    check_out(path.parent)


def a_part(path: Path) -> None:
    """A kept part of a study: whatever is wrong with it, it is done again, so any exception will do; what comes back is
    of its class, and nothing runs."""
    try:
        found = kept._read(path, CLASSES)
    except Exception as error:
        raise ExperimentError(str(error)[:80]) from error
    assert type(found) in (*CLASSES.values(), *PLAIN)


def a_command(path: Path) -> None:
    """The words are parsed and the options checked; nothing is done."""
    words = [os.fsdecode(word) for word in path.read_bytes().split(b"\n")]
    with redirect_stdout(io.StringIO()):  # --help
        config = parse(entry(words[0]).options(), words[0], words[1:])
    if config is not None:
        config.check()


CLASSES = {kept._name(Point): Point}
PLAIN = (type(None), bool, int, float, str, list, tuple, dict, np.ndarray, *np.sctypeDict.values())
SEVERAL = (ExperimentError, BodyError)
COLOURS = samples.tokens("IHDR IDAT IEND PLTE tRNS zTXt")
WORDS_OF_A_MAZE = samples.tokens("+ -- | * 1 2 3 9 +--+ # \u0661 ² \t")
WORDS_OF_WALKS = samples.tokens("walk goal step x y action N E S W X 1,2,3 \u0663 ² -1")
WORDS_OF_AMC = tuple(bone.encode() for bone in BONES)


def a_performance(path: Path) -> None:
    seen(perform(path))


READERS: dict[str, Reader] = {
    "table": Reader("case.csv", samples.tables, a_movement, BodyError, samples.TABLE, 200),
    "table in ranges": Reader("case.tsv", samples.tables, in_ranges, BodyError, samples.TABLE, 150),
    "motion file": Reader("case.txt", samples.motion_files, in_ranges, BodyError, samples.TABLE, 150),
    "archive": Reader("case.npz", samples.archives, a_movement, BodyError, samples.ARCHIVE, 150, an_archive),
    "amc": Reader("case.amc", samples.amc, a_performance, BodyError, WORDS_OF_AMC, 200),
    "bvh": Reader("case.bvh", samples.bvh, a_performance, BodyError, samples.BVH, 200),
    "urdf": Reader("case.urdf", samples.urdf, a_teacher, BodyError, samples.URDF, 120),
    "body": Reader("case.xml", samples.bodies, it_moves, BodyError, samples.MJCF, 120),
    "mesh as text": Reader("link.obj", samples.asset("link.obj"), it_is_dressed, BodyError, samples.OBJ, 40),
    "mesh": Reader("link.stl", samples.asset("link.stl"), it_is_dressed, BodyError, samples.STL, 60),
    "texture": Reader("t.png", samples.asset("t.png"), it_is_dressed, BodyError, COLOURS, 40),
    "height field": Reader("h.png", samples.asset("h.png"), it_is_dressed, BodyError, COLOURS, 40),
    "face": Reader("case.xml", lambda folder: [FACE.read_bytes()], a_face, BodyError, samples.MJCF, 60),
    "maze": Reader("case.txt", samples.drawings, a_maze, BodyError, WORDS_OF_A_MAZE, 300),
    "walks": Reader("case.csv", samples.walks, some_walks, BodyError, WORDS_OF_WALKS, 150),
    "trials": Reader("case.csv", samples.trials, some_trials, SEVERAL, samples.TABLE, 150),
    "trials.parquet": Reader("case.parquet", samples.parquets, some_trials, SEVERAL, (), 20),
    **{f"{name}.nc": a_kind(name) for name in sorted(KINDS)},
    "run/config.json": Reader("run/config.json", samples.folder_of("config.json"), a_run, SEVERAL, samples.JSON, 200),
    "run/metrics.json": Reader(
        "run/metrics.json", samples.folder_of("metrics.json"), a_run, SEVERAL, samples.JSON, 200
    ),
    "run/trajectories.nc": Reader(
        "run/trajectories.nc", samples.folder_of("trajectories.nc"), a_run, SEVERAL, (), 100, a_netcdf
    ),
    "older result": Reader("run/config.json", samples.older, an_older_result, ExperimentError, samples.JSON, 200),
    "kept part": Reader("case.npz", samples.parts, a_part, ExperimentError, samples.ARCHIVE, 150),
    "command line": Reader("words", samples.lines, a_command, (BabblingError, BodyError), samples.OPTIONS, 200),
}
"""Name -> reader."""
