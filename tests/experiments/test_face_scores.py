"""Scores of newborns' imitation: what each finds and mistakes in populations of which the truth is known."""

import json
import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from scipy.stats import binom, binomtest, chi2_contingency, ttest_1samp

from babbling.axes import IntArray
from experiments.errors import ExperimentError
from experiments.face.power_figure import power_figure
from experiments.face.scores import (
    LEVEL,
    MOUTH,
    NS,
    SCORES,
    TONGUE,
    Powers,
    above,
    beyond,
    cross_target,
    cross_target_shares,
    effect_size,
    power,
)
from experiments.face.theories import GESTURES, LABELS, OBJECTS, PASSIVE, STRANGE, THEORIES, Infants, Theory

AROUSAL, LIKED = "arousal, all models alike", "arousal, tongue 1.6 x"
FAIR = ("cross-target, tongue alone", "cross-target, both added", "cross-target, both, shares")
OFTEN = (0.33, 0.05, 0.22, 0.1, 0.1, 0.15, 0.05)
"""Habits of infants who often put out their tongues (Keven and Akins 2017)."""


def infants(count: int, likeness: float = 12.0, fidelity: float = 0.9) -> Infants:
    """Each with habits of its own, who look like the gesture they imitate nine times in ten."""
    rng = np.random.default_rng(7)
    habits = rng.dirichlet(likeness * np.array(OFTEN), count)
    habit = (habits.cumsum(1)[:, None] < rng.random((count, 60, 1))).sum(-1).clip(0, LABELS - 1)
    right = np.broadcast_to(np.arange(len(GESTURES))[:, None], (count, len(GESTURES), 20))
    return Infants(habit, np.where(rng.random(right.shape) < fidelity, right, rng.integers(LABELS, size=right.shape)))


@pytest.fixture(scope="module")
def found() -> Powers:
    return power(infants(200), repeats=200, rng=np.random.default_rng(0))


def share(found: Powers, theory: str, score: str) -> list[float]:
    return found.share[list(THEORIES).index(theory), list(SCORES).index(score)].tolist()


def test_fair_scores_are_wrong_as_often_as_they_may_be() -> None:
    wrong = power(infants(200), {AROUSAL: THEORIES[AROUSAL]}, (12, 40), 2000, rng=np.random.default_rng(1))
    for score in FAIR:
        low, high = binom.ppf([0.0005, 0.9995], wrong.repeats, LEVEL)
        hits = wrong.hits[0, list(SCORES).index(score)]
        assert (low <= hits).all() and (hits <= high).all(), score


def test_what_a_score_takes_for_imitation_is_what_it_does_not_control(found: Powers) -> None:
    assert share(found, AROUSAL, "tongue over passive face")[-1] > 0.9  # a face that moves is merely more exciting
    assert share(found, LIKED, "cross-target, tongue alone")[-1] > 0.9  # so is a tongue
    assert share(found, LIKED, "cross-target, both, shares")[-1] < 0.1
    for score in list(SCORES)[3:4] + list(SCORES)[5:]:  # two tests or more must agree
        assert max(share(found, AROUSAL, score) + share(found, LIKED, score)) < 2 * LEVEL, score


def test_power_rises_with_imitation_and_with_infants(found: Powers) -> None:
    imitates = [k for k, theory in enumerate(THEORIES.values()) if theory.imitation > 0]
    noise = 3 * np.sqrt(0.5 / found.repeats)
    assert (np.diff(found.share[imitates], axis=0) < noise).all()  # theories from the most imitation to the least
    assert (np.diff(found.share[imitates], axis=2) > -noise).all()
    assert (np.diff(found.effects[imitates, -1, 0]) < 0).all()
    assert found.effects[list(THEORIES).index(AROUSAL), -1, 0] == pytest.approx(0, abs=0.03)


def test_every_score_finds_a_perfect_imitator() -> None:
    still = np.full((50, 3), LABELS - 1)
    perfect = Infants(still, np.tile(np.arange(len(GESTURES))[:, None], (50, 1, 2)))
    sure = power(perfect, {"perfect": Theory(1.0)}, (40,), 50, rng=np.random.default_rng(0))
    assert (sure.share == 1).all()
    never = power(perfect, {"never": Theory(0.0)}, (2, 40), 50, rng=np.random.default_rng(0))  # nothing happens
    assert (never.share == 0).all() and (never.effects == 0).all()


def acts_one_by_one(
    baby: Infants, theory: Theory, models: tuple[str, ...], minutes: float, rng: np.random.Generator
) -> IntArray:
    """The law of a theory, act by act: (M, 6)."""
    counts = np.zeros((len(models), len(GESTURES)), int)
    w = rng.beta(theory.likeness * theory.imitation, theory.likeness * (1 - theory.imitation))
    active = rng.gamma(1 / theory.activity_cv**2, theory.activity_cv**2)
    for m, model in enumerate(models):
        state = np.exp(rng.normal(-(theory.state_sd**2) / 2, theory.state_sd))
        for _ in range(rng.poisson(minutes * theory.acts_a_minute * theory.interest(model) * active * state)):
            imitates = model in GESTURES and rng.random() < w
            label = rng.choice(baby.imitated[0, GESTURES.index(model)] if imitates else baby.habit[0])
            if label < len(GESTURES):
                counts[m, label] += 1
    return counts


def test_counts_are_those_of_acts_drawn_one_by_one() -> None:
    baby, theory, models = infants(1, fidelity=0.6), Theory(0.4, tongue_interest=1.6), (GESTURES[0], "box")
    rng = np.random.default_rng(3)
    slow = np.stack([acts_one_by_one(baby, theory, models, 0.25, rng) for _ in range(4000)])
    fast = theory.counts(baby, np.zeros(20_000, int), models, 0.25, rng)

    def kinds(counts: IntArray) -> IntArray:
        """How often each pair of tongue acts and all other acts, while each is shown, came about."""
        pair = np.stack([counts[..., 0], counts[..., 1:].sum(-1)], -1).clip(0, 2).reshape(len(counts), 4)
        return np.bincount(pair @ 3 ** np.arange(4), minlength=81)

    table = np.stack([kinds(slow), kinds(fast)])
    assert chi2_contingency(table[:, table.sum(0) > 25]).pvalue > 0.001
    assert slow.mean(0) == pytest.approx(fast.mean(0), abs=0.06)


def test_where_there_is_nothing_to_imitate_all_theories_agree() -> None:
    baby, who, rng = infants(5), np.tile(np.arange(5), (20_000, 1)), np.random.default_rng(4)
    others = (PASSIVE, *STRANGE, *OBJECTS)
    one, other = (Theory(w).counts(baby, who, others, 1.0, rng).mean(0) for w in (1.0, 0.0))
    assert one == pytest.approx(other, abs=0.12)
    rates = one[..., : len(GESTURES)].sum(-1) / baby.looks[:, -1, :-1].sum(-1)[:, None]
    assert rates.mean(0) / Theory(0.0).acts_a_minute == pytest.approx([0.6, 1, 1, 1, 0.7, 0.7], rel=0.03)


def test_a_gesture_is_compared_with_the_same_act_while_others_are_shown() -> None:
    counts = np.random.default_rng(8).integers(50, size=(1, 1, 4, len(GESTURES)))
    tongue, mouth = beyond(counts)[0, 0].tolist()
    assert tongue == [counts[0, 0, 0, TONGUE] - counts[0, 0, m, TONGUE] for m in (1, 2, 3)]
    assert mouth == [counts[0, 0, 1, MOUTH] - counts[0, 0, m, MOUTH] for m in (0, 2, 3)]
    assert all(score.protocol.models[:2] == (GESTURES[TONGUE], GESTURES[MOUTH]) for score in SCORES.values())
    assert {len(score.protocol.models) for score in SCORES.values()} == {3, 11}


def test_who_does_nothing_in_a_period_has_no_share_to_compare() -> None:
    counts = np.zeros((1, 6, 3, len(GESTURES)), int)
    counts[:, :, 0, TONGUE] = 3
    assert cross_target(counts).all() and not cross_target_shares(counts).any()
    counts[:, :, 1, MOUTH] = 1
    assert cross_target_shares(counts).all()


@pytest.mark.parametrize("n", [2, 6, 40])
def test_tests_are_students(n: int) -> None:
    differences = np.random.default_rng(n).normal(0.3, 1.0, (500, n, 2))
    t, p = ttest_1samp(differences, 0, axis=1, alternative="greater")
    assert np.array_equal(above(differences[..., 0]), p[:, 0] < LEVEL)
    assert np.array_equal(above(differences), (p < LEVEL).all(1))  # every one in a test of its own
    assert 0 < above(differences).mean() < above(differences[..., 0]).mean() < 1
    assert effect_size(differences[..., 0]) == pytest.approx((1 - 3 / (4 * (n - 1) - 1)) * t[:, 0] / np.sqrt(n))


def test_intervals_are_wilsons(found: Powers) -> None:
    for hits, ends in zip(found.hits.flat, found.interval.reshape(-1, 2), strict=True):
        wilson = binomtest(int(hits), found.repeats).proportion_ci(0.95, "wilson")
        assert ends == pytest.approx([wilson.low, wilson.high], abs=1e-12)


def test_the_same_seed_gives_the_same_result() -> None:
    one, same, other = (power(infants(12), ns=(6,), repeats=20, rng=np.random.default_rng(s)) for s in (5, 5, 6))
    assert json.dumps(one.as_metrics()) == json.dumps(same.as_metrics()) != json.dumps(other.as_metrics())


@pytest.mark.parametrize("n", [1, 13])
def test_impossible_samples_are_refused(n: int) -> None:
    with pytest.raises(ExperimentError, match=f"samples of {n} infants: there are 12, and a t test needs at least 2"):
        power(infants(12), ns=(6, n), rng=np.random.default_rng(0))


def test_impossible_labels_are_refused() -> None:
    some = infants(3)
    for habit, imitated, why in (
        (some.habit[:2], some.imitated, "(2, 60) habits and (3, 6, 20) imitations: give (I, H) and (I, 6, R) labels"),
        (some.habit[:, :0], some.imitated, "(3, 0) habits and (3, 6, 20) imitations: every infant needs at least one"),
        (some.habit + 1, some.imitated, "labels 1 to 7: a judge has 0 to 6"),
    ):
        with pytest.raises(ExperimentError, match=re.escape(why)):
            Infants(habit, imitated)


def test_everything_is_said_by_name(found: Powers) -> None:
    said = json.loads(json.dumps(found.as_metrics()))
    assert set(said["power"]) | set(said["false_positives"]) == set(THEORIES)
    assert set(said["false_positives"]) == {AROUSAL, LIKED}
    row = said["power"]["w = 0.25"]["cross-target, tongue alone"]
    assert row == {str(n): value for n, value in zip(NS, share(found, "w = 0.25", FAIR[0]), strict=True)}
    low, high = said["power_interval"]["w = 0.25"]["cross-target, tongue alone"]["40"]
    assert low <= row["40"] <= high
    assert said["effect_size"]["published"]["meta-analysis"]["d"] == 0.68
    half = said["effect_size"]["simulated"]["w = 0.5"]["106"]
    assert half["interval"][0] < half["g"] < half["interval"][1]


def test_the_figure_shows_every_size(found: Powers) -> None:
    figure = power_figure(found)
    FigureCanvasAgg(figure).draw()
    assert [axes.get_title() for axes in figure.axes] == [f"{n} infants" for n in NS]
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == list(SCORES)
    assert "8 acts a minute" in figure.legends[0].get_title().get_text()
