"""Recognising what somebody does with a thing: laws of P(seen movement | primitive), upon movements drawn at random."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import multivariate_normal

from babbling.play import FINE, HANDS, Play
from imitation.errors import ImitationError
from imitation.seeing import acts
from imitation.seeing.acts import LEAST_M, TEMPER, likelihood, log_likelihood, one_s_covariance

LOOKS, KINDS, ACTS = 3, ("ball", "cup"), ("push", "lift", "hold", "never")
D = LOOKS * 9 + 6
"""Numbers of a movement, see `described`."""


def drawn(seed: int = 0) -> tuple[Play, np.ndarray, np.ndarray]:
    """A play, the (K, 3, P, 3) means of what was done in it, and how it varied: in a few directions alone."""
    rng = np.random.default_rng(seed)
    means = rng.uniform(-0.3, 0.3, (2, 3, D // 3, 3))
    root = 0.03 * rng.standard_normal((D, 4))
    play = Play.empty("me", KINDS, ACTS, ("same", "else"), D)
    for kind in range(2):
        which, zero = np.repeat(np.arange(3), 200), np.zeros(600, int)
        features = means[kind, which].reshape(-1, D) + rng.standard_normal((600, 4)) @ root.T
        told = which, zero, np.zeros((600, 5)), features, zero.astype(float), zero
        play = play.after(kind, HANDS.index("free"), *told, minutes=1)
    return play, means, root


def shown(points: np.ndarray) -> np.ndarray:
    """(N, P, d) points as (N, L, 5, d) tracks; a and b stay where they were."""
    parts = points[:, : 3 * LOOKS].reshape(len(points), LOOKS, 3, -1)
    return np.concatenate([parts, np.repeat(points[:, None, 3 * LOOKS :], LOOKS, 1)], 2)


@pytest.fixture
def as_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hands keep their names."""
    monkeypatch.setattr(acts, "canonical", lambda tracks: tracks)


def test_how_one_varies_is_the_covariance_about_the_means(as_shown: None) -> None:
    play, _, root = drawn()
    found = one_s_covariance(play)
    np.testing.assert_allclose(found, root @ root.T + LEAST_M**2 * np.eye(D), atol=0.2 * found.max())
    means = play.moved[:, :3] * FINE / 200
    brute = play.moved_products * FINE**2 - 200 * np.einsum("kad,kae->de", means, means)
    np.testing.assert_allclose(np.diag(found), np.diag(brute) / (1200 - 6) + LEAST_M**2, rtol=1e-9)
    kept = (found - np.diag(np.diag(found))) * (1200 - 6) / np.where(np.eye(D) > 0, 1, brute)
    kept = kept[~np.eye(D, dtype=bool)]
    np.testing.assert_allclose(kept, kept[0], rtol=1e-6)
    assert 0.99 < kept[0] < 1


def test_of_few_tries_correlations_are_hardly_believed(as_shown: None) -> None:
    rng, play = np.random.default_rng(0), Play.empty("me", KINDS, ACTS, ("same", "else"), D)
    which, zero = np.repeat([0, 1], 4), np.zeros(8, int)
    told = which, zero, np.zeros((8, 5)), 0.05 * rng.standard_normal((8, D)), zero.astype(float), zero
    few = one_s_covariance(play.after(0, HANDS.index("free"), *told, minutes=1))
    apart = few / np.sqrt(np.outer(np.diag(few), np.diag(few)))
    assert np.abs(apart - np.eye(D)).max() < 0.35
    assert (np.linalg.eigvalsh(few) > 0).all()


def test_it_is_the_gaussian_of_what_is_seen_once_the_camera_is_known(as_shown: None, monkeypatch) -> None:
    play, means, _ = drawn()
    monkeypatch.setattr(acts, "_similar", lambda mean, points, weight: (points - mean, np.ones(len(points))))
    monkeypatch.setattr(acts, "_given_way", lambda known, along: 0.0)
    rng = np.random.default_rng(1)
    points = means[0, [0, 1]] + 0.02 * rng.standard_normal((2, D // 3, 3))
    points -= points[:, -2:].mean(1, keepdims=True)
    points[1, 4] = np.nan
    found = log_likelihood(play, 0, shown(points), 0.01)
    own = (play.moved[0, :3] * FINE / 200).reshape(3, D // 3, 3)
    whole = one_s_covariance(play) + 0.01**2 * np.eye(D)
    for n, seen in enumerate(np.repeat(np.isfinite(points[:, :, 0]), 3, 1)):
        brute = [multivariate_normal(one.ravel()[seen], whole[np.ix_(seen, seen)]).logpdf(points[n].ravel()[seen])
                 for one in own]  # fmt: skip
        wanted = TEMPER * (np.array(brute) - brute[0])
        np.testing.assert_allclose(found[n, :3] - found[n, 0], wanted, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("view", ["places", "screen"])
def test_from_anywhere_and_of_any_size_it_looks_alike(as_shown: None, view: str) -> None:
    play, means, root = drawn()
    rng = np.random.default_rng(2)
    points = means[1, [0, 1, 2]] + (rng.standard_normal((3, 4)) @ root.T).reshape(3, -1, 3)
    first, noise = Rotation.random(random_state=1).as_matrix(), 0.004
    look = first[:2] if view == "screen" else first
    before = log_likelihood(play, 1, shown(points @ look.T), noise)
    size, (cosine, sine) = 700.0, (np.cos(1.0), np.sin(1.0))
    turn = Rotation.random(random_state=2).as_matrix() if view == "places" else [[cosine, -sine], [sine, cosine]]
    again = size * np.array(turn)
    shift = rng.uniform(-9, 9, len(again))
    after = log_likelihood(play, 1, shown(points @ look.T @ again.T + shift), size * noise)
    np.testing.assert_allclose(after[:, :3], before[:, :3], rtol=1e-5, atol=1e-4)
    assert (before[:, :3].argmax(1) == [0, 1, 2]).all()


def test_that_places_vary_together_tells_apart_what_each_alone_does_not(as_shown: None) -> None:
    """By more than where a camera might be."""
    play, means, root = drawn()
    rng = np.random.default_rng(4)
    near = means.copy()
    near[0, 1] = means[0, 0] + 0.02 * np.where(rng.random((D // 3, 3)) < 0.5, 1, -1)
    moved = play.moved.copy()
    moved[0, 1] = np.rint(200 * near[0, 1].ravel() / FINE)
    more = np.outer(moved[0, 1], moved[0, 1]) - np.outer(play.moved[0, 1], play.moved[0, 1])
    play = replace(play, moved=moved, moved_products=play.moved_products + more // 200)
    which = np.repeat([0, 1], 200)
    points = near[0, which] + (rng.standard_normal((400, 4)) @ root.T).reshape(400, -1, 3)
    found = likelihood(play, 0, shown(points), 0.003)
    alone = likelihood(play, 0, shown(points), 0.003, alone=True)
    right, less = ((one[:, :3].argmax(1) == which).mean() for one in (found, alone))
    assert right > 0.97 and less < right - 0.05


def test_what_was_never_done_is_never_seen_and_other_looks_are_refused(as_shown: None) -> None:
    play, means, _ = drawn()
    found = likelihood(play, 0, shown(means[0, [0, 1]]), 0.003)
    assert (found[:, 3] == 0).all() and (found.max(1) == 1).all()
    with pytest.raises(ImitationError, match="2 looks at an act; play had 3"):
        likelihood(play, 0, shown(means[0, [0]])[:, :2], 0.003)
