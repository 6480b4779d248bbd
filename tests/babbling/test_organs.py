"""Mirrors: single acts tell which sense moves which part, and what the parts look like in every posture."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from babbling.body_image import BodyImage, PartImage, learn_image
from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.mirroring import ACT_S, HOLD_S, MirrorExperience, mirror_babble
from babbling.organs import categories, find_organs, turned
from tests.babbling.creature import MOVES, PARTS, Creature, directions, motors, schema


def babbled(minutes: float = 6.0, noise_deg: float = 0.0, seed: int = 0, **more: object) -> MirrorExperience:
    body = Creature(noise=np.deg2rad(noise_deg), seed=seed, **more)  # type: ignore[arg-type]
    return mirror_babble(body, body, schema(), motors(), minutes, seed)


def image(experience: MirrorExperience, seed: int = 0):
    end = np.full(5, 1.5)
    return learn_image(experience, find_organs(experience), -end, end, 0 * end, seed, "creature")


def test_only_the_acting_sense_moves_in_an_act() -> None:
    experience = babbled(3.0)
    hold, act = round(HOLD_S / 0.02), round(ACT_S / 0.02)
    kinds = set()
    for copy, start, factor in experience.acts:
        before, after = experience.postures[start - hold // 2, copy], experience.postures[start + act + hold // 2, copy]
        moved = np.flatnonzero(np.abs(after - before) > 0.05).tolist()
        assert moved == ([factor] if factor < 5 else [])
        kinds.add(int(factor))
    assert kinds == set(range(6)), "every sense acts, and sometimes nothing does"


@pytest.mark.parametrize("noise_deg", [0.0, 3.0])
@pytest.mark.parametrize("wiring", [(0, 1, 2, 3, 4), (3, 0, 4, 1, 2)])
def test_structure_is_found(noise_deg: float, wiring: tuple[int, ...]) -> None:
    organs = find_organs(babbled(8.0, noise_deg, wiring=wiring))
    np.testing.assert_array_equal(organs.moves, MOVES[:, wiring])
    assert (organs.information <= 1.0 + 1e-9).all(), "acted or not is one bit"


def test_likelihood_is_a_distribution_and_tells_movers_from_others() -> None:
    organs = find_organs(babbled(6.0))
    table = organs.likelihood()
    np.testing.assert_allclose(table.sum(-1), 1)
    assert (table[:, :-1, 0][organs.moves] < 0.2).all() and (table[:, :-1, 0][~organs.moves] > 0.8).all()
    assert (table[:, -1, 0] > 0.8).all(), "when nothing acts nothing turns"


def test_amounts() -> None:
    before, after = np.array([[[1.0, 0, 0]]] * 2), np.array([[[0, 1.0, 0]]] * 3)
    np.testing.assert_allclose(turned(before, after), np.pi / 2)
    assert categories(np.deg2rad([0.5, 1.5, 3, 50])).tolist() == [0, 1, 2, 7]


def test_image_is_exact_with_clean_eyes_and_averages_noise_away() -> None:
    q = np.random.default_rng(3).uniform(-1.5, 1.5, (300, 5))
    true = directions(q)
    clean, noisy = image(babbled(6.0)), image(babbled(6.0, 3.0))
    off = [np.rad2deg(np.linalg.norm(one.expected(q) - true, axis=-1)).mean() for one in (clean, noisy)]
    assert off[0] < 0.01 and off[1] < 0.6
    for one in noisy.images.values():  # two of three coordinates carry the noise of a unit vector
        assert np.rad2deg(one.noise) == pytest.approx(3 * np.sqrt(2 / 3), rel=0.1)


def test_longer_looks_are_better() -> None:
    q = np.random.default_rng(4).uniform(-1.4, 1.4, (300, 5))
    experience = babbled(12.0, 3.0)
    short, long = (image(experience.first(minutes)).expected(q) for minutes in (4.0, 12.0))
    true = directions(q)
    assert np.linalg.norm(long - true, axis=-1).mean() < np.linalg.norm(short - true, axis=-1).mean()


def test_doubt_is_the_noise_and_what_is_not_known_yet() -> None:
    """At least the seeing noise, and less beyond it the more was seen: six times as much halves it and more."""
    experience = babbled(12.0, 3.0)
    short, long = image(experience.first(2.0)), image(experience)
    for number, part in enumerate(PARTS):
        unknown = [one.doubt[:, number] / one.images[part].noise ** 2 - 1 for one in (short, long)]
        assert (unknown[0] > 0).all() and unknown[1].mean() < unknown[0].mean() / 3


def test_slopes_are_derivatives() -> None:
    one = image(babbled(3.0)).images["left_fore"]
    q = np.random.default_rng(5).uniform(-1, 1, (20, 5))
    along = np.array([2, 1, 4])
    value, slope = one.slope(q, along)
    np.testing.assert_allclose(value, one.expected(q), atol=1e-12)
    for place, joint in enumerate(along):
        step = np.zeros(5)
        step[joint] = 1e-6
        np.testing.assert_allclose(
            slope[:, :, place], (one.expected(q + step) - one.expected(q - step)) / 2e-6, atol=1e-7
        )
    assert (slope[:, :, 2] == 0).all(), "the other arm's elbow does not move this forearm"


def test_same_seed_same_image() -> None:
    one, other = image(babbled(3.0, 1.0)), image(babbled(3.0, 1.0))
    for part in PARTS:
        assert one.images[part].weights.tobytes() == other.images[part].weights.tobytes()


def test_an_image_survives_its_file_and_belongs_to_one_body(tmp_path: Path) -> None:
    learned = image(babbled(3.0))
    path = tmp_path / "image.nc"
    save(learned, path)
    found = load(path, BodyImage)
    found.check(Creature())
    q = np.random.default_rng(6).uniform(-1, 1, (10, 5))
    np.testing.assert_array_equal(found.expected(q), learned.expected(q))
    np.testing.assert_array_equal(found.organs.likelihood(), learned.organs.likelihood())
    assert found.minutes == learned.minutes
    stranger = Creature()
    stranger.fingerprint = "somebody"
    with pytest.raises(BabblingError, match="learned by another body"):
        found.check(stranger)


def test_refusals() -> None:
    body = Creature()
    with pytest.raises(BabblingError, match="minutes in front of the mirror"):
        mirror_babble(body, body, schema(), motors(), 0.1, 0)
    still = babbled(3.0)
    numb = MirrorExperience(
        still.parts,
        still.tick_s,
        still.postures,
        np.tile(still.directions[:1], (len(still.postures), 1, 1, 1)),
        still.acts,
    )
    with pytest.raises(BabblingError, match="no motor was seen to move the"):
        find_organs(numb)
    nothing = replace(still, acts=still.acts[:0])
    with pytest.raises(BabblingError, match="no single act was completed in front of the mirror; babble longer"):
        find_organs(nothing)
    short, end = replace(still, postures=still.postures[:4], directions=still.directions[:4]), np.full(5, 1.5)
    with pytest.raises(BabblingError, match="was seen too shortly to learn from; babble longer"):
        learn_image(short, find_organs(still), -end, end, 0 * end, 0, "creature")


@pytest.mark.parametrize("joints, rows", [([0, 1], 3), ([1, 0], 9), ([0, 0], 9), (range(7), 3**7)])
def test_a_part_is_its_ascending_senses_and_all_products_of_their_harmonics(joints: Sequence[int], rows: int) -> None:
    with pytest.raises(BabblingError, match="n ascending ones and 3"):
        PartImage(np.array(joints), np.zeros(len(joints)), np.zeros((rows, 3)), 0.1)
