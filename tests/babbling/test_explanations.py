"""Rival explanations: which wins where, what their average is, and evidence counted over again by hand."""

from dataclasses import replace

import numpy as np
import pytest

import babbling.explanations
from babbling.errors import BabblingError
from babbling.explanations import EXPLANATIONS, NOTICED, SURPRISE, Explanations
from babbling.features import BEFORE, COLUMNS, LINES, Echo
from babbling.frame import Frame
from tests.babbling.joints import TICK, bent, features, frame, learned, linear, lived, slack, sticky

AT = {name: number for number, name in enumerate(COLUMNS)}


def mixed(rule=sticky) -> Explanations:
    """One that trusts all explanations to some degree, each factor otherwise."""
    model = learned(rule, 300)
    model.evidence[:] = np.log([[0.1, 0.2, 0.25, 0.05, 0.4], [0.4, 0.3, 0.1, 0.1, 0.1]])
    model._forget()
    return model


@pytest.mark.parametrize("seed", [0, 10])
@pytest.mark.parametrize(("rule", "wins"), [(linear, "line"), (slack, "play"), (bent, "play")])
def test_the_simplest_line_that_can_tell_it_wins(rule, wins: str, seed: int) -> None:
    model = learned(rule, 1500, seed)
    assert [EXPLANATIONS[best] for best in model.evidence.argmax(1)] == [wins] * 2
    assert (model.weights[:, EXPLANATIONS.index(wins)] > 0.5).all()


@pytest.mark.parametrize("seed", [10, 20])
def test_where_no_line_can_tell_it_the_table_wins(seed: int) -> None:
    model = learned(sticky, 1500, seed)
    assert (model.weights[:, -1] > 0.99).all()
    columns, outcome = lived(sticky, 200, seed + 5)
    missed = np.sqrt(np.mean((model.foretold_by(columns) - outcome[..., None]) ** 2, axis=0))
    assert (missed[:, -1] < 0.99 * missed[:, :-1].min(1)).all(), "and foretells best what is new"


def test_with_little_experience_a_line_is_worth_as_much_as_the_best() -> None:
    """The average loses next to nothing beside whichever turns out best."""
    for rule in (linear, slack, bent, sticky):
        model = learned(rule, 100)
        columns, outcome = lived(rule, 400, 7)
        told = model.foretold_by(columns)
        average = (told * model.weights).sum(-1)
        best = ((told - outcome[..., None]) ** 2).mean(0).min(1)
        assert (((average - outcome) ** 2).mean(0) < 1.1 * best).all(), rule.__name__


def test_each_line_is_least_squares_on_what_it_looks_at() -> None:
    model = learned(bent, 300)
    parts = [lived(bent, 400, 0), lived(bent, 300, 1)]
    columns, outcome = (np.concatenate(part) for part in zip(*parts, strict=True))
    assert columns.shape[-1] == len(COLUMNS) + 4
    for number, name in enumerate(("line", "posture", "gravity")):
        chosen = [0, *(AT[column] for column in LINES[name])]
        if name == "gravity":
            assert EXPLANATIONS[3] == name
            number, chosen = 3, list(range(columns.shape[-1]))
        for f in range(2):
            wanted = np.zeros(columns.shape[-1])
            wanted[chosen] = np.linalg.lstsq(columns[:, f, chosen], outcome[:, f], rcond=None)[0]
            told = columns[:, f] @ model.lines[number, f]
            np.testing.assert_allclose(
                told, columns[:, f] @ wanted, atol=(0.05 if name == "gravity" else 0.02) * outcome[:, f].std()
            )
    np.testing.assert_array_equal(model.lines[-1, :, : len(COLUMNS)], model.frame.line)
    assert not model.lines[:3, :, len(COLUMNS) :].any() and not model.lines[-1, :, len(COLUMNS) :].any()


def test_the_average_is_the_sum_of_all_by_their_weights() -> None:
    """At places and commands never met, off the table's ends as well; one command or many."""
    model, rng = mixed(), np.random.default_rng(0)
    q, v, last = rng.uniform(-0.4, 0.4, (3, 5, 2)) * [[[1]], [[5]], [[1]]]
    v[0] *= 20
    echo = Echo(last, last[..., None] + rng.uniform(-1, 1, (5, 2, 9)) * model.features.widths)
    outlook = model.at(q, v, echo)
    commands = q + rng.uniform(-0.5, 0.5, (11, 5, 2))
    told = outlook.expected(commands)
    assert told.shape == (11, 5, 2)
    table = model.table
    for number, command in enumerate(commands):
        plays = model.features.plays(echo, command)
        columns = model.features.columns(q, v, echo, plays)
        rate, effort = model.frame.bent(columns)
        for b, f in np.ndindex(5, 2):
            lines = [columns[b, f] @ model.lines[e, f] for e in range(len(EXPLANATIONS))]
            steps = []
            for axis, value in ((table.contexts[0], rate[b, f]), (table.action, effort[b, f])):
                place = np.clip((value - axis.low[f]) / axis.step[f], 0, axis.size - 1)
                lower = min(int(place), axis.size - 2)
                steps.append([(lower, 1 - place + lower), (lower + 1, place - lower)])
            rows = [(i, j, a * b) for i, a in steps[0] for j, b in steps[1]]
            lines[-1] += sum(share * table.predictive[f, i, j] @ table.outcome.points[f] for i, j, share in rows)
            mean = sum(weight * line for weight, line in zip(model.weights[f], lines, strict=True))
            assert told[number, b, f] == pytest.approx(mean, abs=2e-5), "soft cells are multiples of 1 / 4096"
            np.testing.assert_allclose(model.foretold_by(columns)[b, f], lines, atol=2e-5)
        np.testing.assert_array_equal(outlook.expected(command), told[number])
        inside = (np.abs(rate) <= table.contexts[0].high) & (np.abs(effort) <= table.action.high)
        np.testing.assert_array_equal(outlook.beyond(command), ~inside)
        near = table.contexts[0].hard(rate), table.action.hard(effort)
        assert outlook.familiarity(command).shape == (5, 2)
        visits = table.visits[np.arange(2), :, near[1]]  # (5, 2, rates): rates between which one is are averaged
        assert (outlook.familiarity(command) <= visits.max(-1) + 1e-9).all()
    np.testing.assert_allclose(model.spread, np.sqrt((model.weights * model.errors**2).sum(1)))


def test_one_that_does_not_trust_the_table_does_not_ask_it() -> None:
    model = mixed()
    model.evidence[:, -1] = -1e3
    model._forget()
    q = np.zeros((3, 2))
    outlook = model.at(q, 1e6 + q, model.features.start(q))
    assert not outlook.beyond(q + 1e6).any()
    mean = (model.foretold_by(columns := lived(sticky, 9, 3)[0])[..., :-1] * model.weights[:, :-1]).sum(-1)
    told = np.einsum("nfx,fx->nf", columns, np.einsum("fe,efx->fx", model.weights, model.lines))
    np.testing.assert_allclose(mean, told, atol=1e-12)


def test_slope_is_what_more_command_brings_where_slack_is_taken_up() -> None:
    model = learned(slack, 1500)
    assert not model.weights[:, -1].any()
    q = np.zeros((1, 2))
    outlook = model.at(q, q, model.features.start(q))
    one, two = outlook.expected(q + 0.5), outlook.expected(q + 0.6)
    np.testing.assert_allclose((two - one)[0] / 0.1, model.slope, rtol=1e-9)
    np.testing.assert_allclose(model.slope, 0.3, rtol=0.02)


def test_a_habit_of_pace_is_a_line_through_what_babbling_did_at_each_rate() -> None:
    model = learned(linear, 600).by_pace(np.array([True, True]))
    parts = [lived(linear, 400, 0), lived(linear, 600, 1)]
    columns = np.concatenate([columns for columns, _ in parts])
    chosen = [AT["one"], AT["rate"]]
    for f in range(2):
        x, a = columns[:, f, chosen], columns[:, f, AT["action"]]
        told = x @ np.linalg.lstsq(x, a, rcond=None)[0]
        mine = columns[:, f, : len(BEFORE)] @ model.habit[0][f]
        assert np.sqrt(np.mean((mine - told) ** 2)) < 0.05 * a.std()
        others = np.delete(model.habit[0][f], chosen)
        assert not others.any(), "a habit is of paces, not of places nor of what was just said"
        assert model.habit[1][f] == pytest.approx(np.sqrt(np.mean((a - told) ** 2)), rel=0.01)
    q = columns[:, :, AT["posture"]]
    usual = model.at(q, columns[:, :, 1], Echo(q + columns[:, :, AT["before"]], q[..., None] + np.zeros(9))).usual
    np.testing.assert_allclose(usual, np.einsum("nfx,fx->nf", columns[..., : len(BEFORE)], model.habit[0]), atol=1e-12)


def test_a_habit_is_a_line_through_what_postures_and_paces_foretell() -> None:
    model = learned(linear, 600)
    columns = np.concatenate([columns for columns, _ in (lived(linear, 400, 0), lived(linear, 600, 1))])
    chosen = [AT[name] for name in BEFORE if name != "before"]
    for f in range(2):
        x, a = columns[:, f, chosen], columns[:, f, AT["action"]]
        left = a - x @ np.linalg.lstsq(x, a, rcond=None)[0]
        assert model.habit[1][f] == pytest.approx(left.std(), rel=0.01)
        assert model.habit[0][f, AT["before"]] == 0, "a habit is of places and paces, not of what was just said"
    assert (model.habit[1] < model.by_pace(np.array([True, True])).habit[1]).all(), "pace alone foretells less"


# ------------------------------------------------------------------ evidence


def test_evidence_is_what_each_said_of_what_it_had_not_seen(monkeypatch) -> None:
    """Recounted: who has counted everything before foretells the next block, by a normal density that is cut."""
    monkeypatch.setattr(babbling.explanations, "BLOCK", 64)
    known, given = 100, frame(sticky)
    columns, outcome = lived(sticky, 200, 5)
    outcome[300] += 1.0  # a blow
    model = Explanations.empty(given, "")
    model.observe(columns[:known], outcome[:known], foretell=False)
    assert not (model.evidence.any() or model.squares.any() or model.foretold.any())
    model.observe(columns[known:], outcome[known:])
    evidence, squares, foretold, start = np.zeros((2, 5)), np.zeros((2, 5)), 0, known
    ends = given.reach[:, :-1], given.reach[:, -1]  # what is larger is cut before it is counted
    kept = np.copy(columns), np.clip(outcome, -ends[1], ends[1])
    kept[0][..., 1:] = np.clip(columns[..., 1:], -ends[0], ends[0])
    while start < len(outcome):
        before = Explanations.empty(given, "")
        before.observe(columns[:start], outcome[:start], foretell=False)
        x, w = columns[start : start + max(64, start // 4)], outcome[start : start + max(64, start // 4)]
        told = before.foretold_by(x)
        for f in range(2):
            for e in range(len(EXPLANATIONS)):
                line = before.lines[min(e, 3), f]  # the table starts with what the richest line leaves
                own = np.mean((kept[1][:start, f] - kept[0][:start, f] @ line) ** 2)
                variance = (squares[f, e] + 64 * own) / (foretold + 64)
                error = np.minimum((w[:, f] - told[:, f, e]) ** 2, SURPRISE * variance)
                evidence[f, e] += np.sum(-np.log(variance) / 2 - error / variance / 2)
                squares[f, e] += error.sum()
        foretold += len(w)
        start += len(w)
    assert (model.foretold == foretold).all() and foretold == len(outcome) - known
    np.testing.assert_allclose(model.evidence, evidence, rtol=2e-3)
    np.testing.assert_allclose(model.squares, squares, rtol=2e-3)


def test_one_blow_says_little_against_anybody() -> None:
    one, other = learned(linear, 500), learned(linear, 500)
    columns, outcome = lived(linear, 10, 9)
    one.observe(columns, outcome)
    blow = outcome.copy()
    blow[5] += 100.0
    other.observe(columns, blow)
    lost = one.evidence - other.evidence
    assert (lost > 0.4 * SURPRISE).all() and (lost <= SURPRISE / 2 + 1e-6).all()


def test_weights_are_the_evidence_and_sum_to_one_however_large_it_is() -> None:
    model = mixed()
    np.testing.assert_allclose(model.weights, [[0.1, 0.2, 0.25, 0.05, 0.4], [0.4, 0.3, 0.1, 0.1, 0.1]])
    model.evidence[:] = [[-1e12, 1e12, 0, 0, 1e12 + 1], [0, np.log(NOTICED) - 0.1, -1, -2, np.log(NOTICED) + 1]]
    model._forget()
    np.testing.assert_allclose(model.weights.sum(1), 1)
    np.testing.assert_allclose(model.weights[0], [0, 1 / (1 + np.e), 0, 0, np.e / (1 + np.e)])
    assert model.weights[1, 1] == 0 < model.weights[1, 4], "who is next to impossible is not asked"


def test_nothing_is_foretold_by_who_knows_next_to_nothing() -> None:
    model = Explanations.empty(frame(linear), "")
    columns, outcome = lived(linear, 10, 3)
    model.observe(columns, outcome)
    model.observe(columns, outcome)
    assert model.transitions == 2 * 80 and not model.foretold.any()


# -------------------------------------------------------- merging, never met


def test_what_was_learned_apart_adds_up_in_any_order() -> None:
    given, lives = frame(sticky), [lived(sticky, 200, seed) for seed in range(3)]
    apart = []
    for life in lives:
        apart.append(Explanations.empty(given, ""))
        apart[-1].observe(*life)
    whole = Explanations.empty(given, "")
    whole.observe(*(np.concatenate(part) for part in zip(*lives, strict=True)))
    for order in ((0, 1, 2), (2, 0, 1)):
        merged = Explanations.empty(given, "")
        for number in order:
            merged.merge(apart[number])
            assert merged.lines.shape == (5, 2, len(COLUMNS) + 4) and (merged.weights > 0).any()
        assert (merged.moments == whole.moments).all() and (merged.lines == whole.lines).all()
        assert (merged.table.counts == whole.table.counts).all()
        np.testing.assert_allclose(merged.evidence, sum(part.evidence for part in apart), rtol=1e-12)
        assert merged.evidence.all() and merged.foretold.all()
        np.testing.assert_allclose(merged.squares, sum(part.squares for part in apart), rtol=1e-12)
        assert (merged.foretold == sum(part.foretold for part in apart)).all()
    with pytest.raises(BabblingError, match="only those of one pilot can be merged"):
        whole.merge(Explanations.empty(frame(sticky, seed=8), ""))


def test_other_shapes_than_the_features_have_are_refused() -> None:
    model = Explanations.empty(frame(linear), "")
    for name in ("moments", "evidence"):
        with pytest.raises(BabblingError, match="learned with other features; babble anew"):
            replace(model, **{name: getattr(model, name)[:, 1:]})
    with pytest.raises(BabblingError, match="learned with other features"):
        replace(model, table=Explanations.empty(frame(linear, seed=8), "").table)


def test_a_bend_that_was_never_passed_says_nothing_when_it_is() -> None:
    """No number is made up for features that were always 0; beyond them one goes on as before."""
    mine = replace(features(), knots=features().knots + np.array([0, 0, 0, 0, 9, 9]))
    columns, outcome = lived(bent, 400, 0)
    never = slice(AT["hinge 5"], AT["hinge 6"] + 1)
    columns[..., never] = 0
    model = Explanations.empty(Frame.found(mine, columns, outcome), "")
    model.observe(columns, outcome, foretell=False)
    model.observe(columns, outcome)
    assert (model.lines[..., never] == 0).all()
    q = np.full((1, 2), 20.0)
    outlook = model.at(q, q / TICK, mine.start(q))
    told = [outlook.expected(q + np.array([1e3, -1e3])), outlook.usual, model.spread, model.slope, model.weights]
    assert all(np.isfinite(one).all() for one in told)
