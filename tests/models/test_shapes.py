"""What is drawn of a body: every geom that is to be seen, in its colours, within a budget, and where it all lies."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from models.body import resting
from models.loading import load_body
from models.meshes import Mesh, meshes
from models.robots import ROBOTS
from models.shapes import Part, box, parts

CUBE = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij")).reshape(3, -1).T
QUAD = "vertex='0 0 0  1 0 0  1 1 0  0 1 0  .5 .5 -.1' face='0 1 2 0 2 3 0 4 1 1 4 2 2 4 3 3 4 0'"
SEE = "contype='0' conaffinity='0'"


def compiled(bodies: str, assets: str = "") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{assets}</asset><worldbody>{bodies}</worldbody></mujoco>",
    )


def drawn(model: mujoco.MjModel, **how: int) -> list[Part]:
    return parts(model, resting(model)[None], **how)


def names(model: mujoco.MjModel) -> set[str]:
    return {shape.name for part in drawn(model) for shape in part.shapes}


def arm(*geoms: str) -> str:
    return f"<body name='arm'><joint/><geom size='.1' group='3' name='inside'/>{''.join(geoms)}</body>"


@pytest.mark.parametrize(
    ("bodies", "expected"),
    [
        (arm(f"<geom name='skin' size='.1' group='2' {SEE}/>"), {"skin"}),
        (arm(f"<geom name='skin' size='.1' group='1' {SEE}/>", "<geom name='hull' size='.2' group='0'/>"), {"skin"}),
        (arm("<geom name='both' size='.1' group='1'/>", "<geom name='hull' size='.2'/>"), {"both", "hull"}),
        (arm(f"<geom name='eye' size='.1' {SEE}/>", "<geom name='hull' size='.2'/>"), {"eye", "hull"}),  # one group
        (arm(), {"inside"}),  # nothing to look at
        (arm("<geom name='ghost' size='.1' rgba='1 1 1 0'/>"), {"inside", "ghost"}),
        (arm(f"<geom name='skin' size='.1' {SEE}/>", "<geom name='ghost' size='.1' rgba='1 1 1 0'/>"), {"skin"}),
        (
            arm(f"<geom name='skin' size='.1' group='1' {SEE}/>") + "<body><geom name='table' size='1'/></body>",
            {"skin", "table"},  # another tree's group is its own
        ),
        ("<geom type='plane' name='floor' size='1 1 1'/>" + arm(), {"inside"}),
        ("<body name='marker'><geom name='hidden' size='1' group='4'/></body>" + arm(), {"inside"}),  # does not move
    ],
)
def test_what_is_to_be_seen_is_drawn_and_no_body_is_empty(bodies: str, expected: set[str]) -> None:
    assert names(compiled(bodies)) == expected


@pytest.mark.parametrize("name", ROBOTS)
def test_every_visible_geom_of_a_registered_robot_is_drawn(name: str) -> None:
    model = load_body(name).model
    ground = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)
    seen = (model.geom_group < 3) & (model.geom_rgba[:, 3] > 0) & ~np.isin(model.geom_type, ground)
    assert sum(len(part.shapes) for part in drawn(model)) == seen.sum() > 0


def painted(text: str, assets: str = "") -> NDArray[np.float64]:
    [part] = drawn(compiled(f"<body><geom size='.1' {text}/></body>", assets))
    return part.shapes[0].colour


def test_colours_are_the_geoms_or_the_materials_and_textures() -> None:
    red = "<material name='red' rgba='1 0 0 1'/>"
    np.testing.assert_allclose(painted("rgba='0 1 .2 1'"), [0, 1, 0.2], atol=1e-6)
    np.testing.assert_allclose(painted("material='red'", red), [1, 0, 0])
    np.testing.assert_allclose(painted("material='red' rgba='0 0 1 1'", red), [0, 0, 1])
    felt = "<texture name='t' type='cube' builtin='flat' rgb1='.2 .4 .6' rgb2='.2 .4 .6' width='8' height='8'/>"
    felt += "<material name='felt' texture='t' rgba='1 .5 1 1'/>"
    np.testing.assert_allclose(painted("material='felt'", felt), [0.2, 0.2, 0.6], atol=1 / 255)
    assert names(compiled(arm("<geom name='a' size='.1' material='clear'/>", f"<geom name='b' size='1' {SEE}/>"),
                          "<material name='clear' rgba='1 1 1 0'/>")) == {"b"}  # fmt: skip


def test_a_texture_is_painted_where_it_lies() -> None:
    spec = mujoco.MjSpec.from_string(
        f"<mujoco><asset><mesh name='quad' texcoord='0 0 1 0 1 1 0 1 .5 .5' {QUAD}/></asset>"
        "<worldbody><body><geom type='mesh' mesh='quad'/></body></worldbody></mujoco>"
    )
    pixels = np.zeros((2, 2, 3), np.uint8)
    pixels[0, 0], pixels[0, 1], pixels[1, 0], pixels[1, 1] = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)
    spec.add_texture(
        name="t", type=mujoco.mjtTexture.mjTEXTURE_2D, width=2, height=2, nchannel=3, data=[*pixels.tobytes()]
    )
    textures = [""] * 10
    textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "t"
    spec.add_material(name="m", textures=textures, rgba=(0.5, 1, 1, 1))
    spec.geoms[0].material = "m"
    model = spec.compile()
    surface = mesh_of(model)
    assert surface.paint is not None
    u, v = np.moveaxis(model.mesh_texcoord[model.mesh_facetexcoord], -1, 0) % 1
    expected = pixels[(2 * v).astype(int), (2 * u).astype(int)] / 255 * (0.5, 1, 1)
    np.testing.assert_allclose(surface.paint[surface.triangles], expected, atol=1e-6)


def mesh_of(model: mujoco.MjModel, **how: int) -> Mesh:
    [part] = drawn(model, **how)
    surface = part.shapes[0].mesh
    assert surface is not None
    return surface


def ball(rings: int, radius: float = 1.0) -> mujoco.MjModel:
    """Of 4 rings (rings - 1) triangles."""
    tilt, turn = np.linspace(0, np.pi, rings + 1)[1:-1], np.arange(2 * rings) * np.pi / rings
    around = np.stack(np.broadcast_arrays(
        np.sin(tilt)[:, None] * np.cos(turn), np.sin(tilt)[:, None] * np.sin(turn), np.cos(tilt)[:, None]
    ), -1).reshape(-1, 3)  # fmt: skip
    points = np.concatenate([radius * around, [(0, 0, radius), (0, 0, -radius)]])
    at = np.arange(len(around)).reshape(rings - 1, -1)
    a, b, c, d = at[:-1], np.roll(at, -1, 1)[:-1], at[1:], np.roll(at, -1, 1)[1:]
    top, end = np.full_like(at[0], len(around)), np.roll(at, -1, 1)
    faces = [(a, c, b), (b, c, d), (top, at[0], end[0]), (top + 1, end[-1], at[-1])]
    triangles = np.concatenate([np.stack(face, -1).reshape(-1, 3) for face in faces])
    spec = mujoco.MjSpec()
    spec.add_mesh(name="ball", uservert=points.ravel(), userface=triangles.ravel())
    spec.worldbody.add_body(name="it", pos=(1, 2, 3)).add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH, meshname="ball", pos=(0.1, 0, 0), quat=(0.6, 0, 0.8, 0)
    )
    return spec.compile()


def test_a_mesh_keeps_its_edges_and_is_smooth_elsewhere() -> None:
    cube = compiled("<body><geom type='mesh' mesh='c'/></body>",
                    f"<mesh name='c' vertex='{' '.join(map(str, CUBE.ravel()))}'/>")  # fmt: skip
    surface = mesh_of(cube)
    assert surface.corners.shape == (24, 3) and surface.triangles.shape == (12, 3)
    across = surface.across()
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    for corner in surface.triangles.T:
        np.testing.assert_allclose(surface.normals[corner], across, atol=1e-6)
    round_ = mesh_of(ball(20))
    assert len(round_.corners) == 2 * 20 * 19 + 2  # all shared
    away = round_.corners - [0.1, 0, 0]
    np.testing.assert_allclose((away * round_.normals).sum(1), 1, atol=0.01)


@pytest.mark.parametrize("most", [12_000, 3000, 200])
def test_a_large_mesh_is_thinned_out_to_its_budget_and_looks_the_same(most: int) -> None:
    surface = mesh_of(ball(100), most=most)
    assert most / 4 < len(surface.triangles) <= most
    away = surface.corners - [0.1, 0, 0]
    coarse = 12 / np.sqrt(most)
    assert np.abs(np.linalg.norm(away, axis=1) - 1).max() < coarse
    assert ((away * surface.normals).sum(1) > 0.9 - coarse).all()
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1)
    assert np.linalg.norm(surface.across(), axis=1).sum() / 2 == pytest.approx(4 * np.pi, rel=coarse)
    assert np.unique(surface.triangles).size == len(surface.corners)  # none is left over


def test_the_budget_is_the_whole_bodys_and_thin_things_stay() -> None:
    spec = mujoco.MjSpec()
    copies = ball(60)
    vertices, faces = copies.mesh_vert.ravel(), copies.mesh_face.ravel()
    spec.add_mesh(name="ball", uservert=vertices, userface=faces)
    spec.add_mesh(name="wire", uservert=vertices, userface=faces, scale=(0.005, 0.005, 1))
    for name in ("ball", "ball", "wire"):
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name)
    model = spec.compile()
    made = meshes(model, [0, 1, 2], 9000)
    assert made[0] is made[1]
    assert 3000 < sum(len(mesh.triangles) for mesh in made.values()) <= 9000
    np.testing.assert_allclose(np.sort(np.ptp(made[2].corners, axis=0)), [0.01, 0.01, 2], rtol=0.3)
    assert sum(len(part.shapes) for part in drawn(model, most=9000)) == 3
    least = [shape.mesh for part in drawn(model, most=1) for shape in part.shapes]
    assert all(mesh is not None and 8 < len(mesh.triangles) < 150 for mesh in least)


def test_a_box_holds_everything_at_every_moment_and_no_more() -> None:
    shapes = ("sphere' size='.1", "capsule' size='.05 .2", "cylinder' size='.05 .2", "box' size='.1 .2 .3",
              "ellipsoid' size='.1 .2 .3")  # fmt: skip
    rng = np.random.default_rng(0)
    for shape in shapes:
        turn = Rotation.random(random_state=1).as_quat()
        geom = f"<geom type='{shape}' pos='.1 .2 .3' quat='{' '.join(map(str, turn[[3, 0, 1, 2]]))}'/>"
        model = compiled(f"<body pos='0 0 1'><joint axis='1 2 3'/>{geom}</body>")
        shown = parts(model, rng.uniform(-1, 1, (5, 1)))
        low, high = box(shown)
        [part] = shown
        [one] = part.shapes
        ways = rng.normal(size=(20_000, 3))
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        size = one.size
        surface = {
            "sphere": ways * size[0],
            "capsule": ways * size[0] + np.sign(ways[:, 2:]) * [0, 0, size[1]],
            "ellipsoid": ways * size,
            "box": np.sign(ways) * size,
            "cylinder": ways / np.hypot(*ways.T[:2])[:, None] * [size[0], size[0], 0]
            + np.sign(ways[:, 2:]) * [0, 0, size[1]],
        }[one.kind]
        local = Rotation.from_quat(one.turn).apply(surface) + one.place
        places = np.stack([Rotation.from_quat(turn).apply(local) + place for turn, place in zip(part.turns, part.positions, strict=True)])  # noqa: E501  # fmt: skip
        assert (places.min((0, 1)) >= low - 1e-9).all() and (places.max((0, 1)) <= high + 1e-9).all()
        assert (np.ptp(places, axis=(0, 1)) > 0.55 * (high - low)).all()
    low, high = box(drawn(ball(20)))
    np.testing.assert_allclose([low, high], [[0.1, 1, 2], [2.1, 3, 4]], atol=0.05)
    np.testing.assert_array_equal(box([]), 0)
