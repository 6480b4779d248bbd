"""Figures of a study of faces, by name."""

from typing import Any, Final

import numpy as np

from babbling.axes import BoolArray, FloatArray
from experiments.face.answering import Answers
from experiments.face.judging import ORGAN_SHOWN
from experiments.face.study import TRIES, Studied
from experiments.face.theories import GESTURES, LABELS, SAID
from experiments.face.watching import TIMES_S
from experiments.shared.judging import calibration_error, interval_95, more_often

NEAR: Final = 0.03
"""Share of the range that is as good as the same."""
LARGE: Final = 0.02
"""Share above which an error is expected to fall at the next try."""


def rate(right: BoolArray) -> tuple[float, tuple[float, float]]:
    """Share, and its exact 95 % interval over looks of infants, taken as independent."""
    return float(right.mean()), interval_95(int(right.sum()), right.size)


def metrics(found: Studied) -> dict[str, Any]:
    """What metrics.json holds."""
    usual, rates = found.fresh["usual"], dict[str, tuple[float, tuple[float, float]]]()
    for condition, name in (("usual", ""), ("tilted", "_tilted"), ("other", "_other_proportions")):
        answers = found.fresh[condition]
        rates[f"organ_accuracy{name}"] = rate(answers.right[answers.strong])
        rates[f"organ_accuracy_weak{name}"] = rate(answers.right[~answers.strong])
        did = answers.labels[..., -1] == answers.gesture
        rates[f"strong_accuracy{name}"] = rate(did[answers.strong])
        rates[f"weak_accuracy{name}"] = rate(did[~answers.strong])
    for row, peer in enumerate(("largest_change", "relations_apart")):
        right = np.equal(usual.peers[row], ORGAN_SHOWN[usual.gesture])
        rates[f"organ_accuracy_{peer}"] = rate(right[usual.strong])
        rates[f"organ_accuracy_weak_{peer}"] = rate(right[~usual.strong])
    after = np.concatenate([each.labels[:, -1] for each in found.pacified])
    rates["after_pacifier"] = rate(after == usual.gesture.ravel())
    rates["at_once"] = rate((usual.labels[..., -1] == usual.gesture).ravel())
    some = found.at_once
    rates["after_day"] = rate(found.day[:, -1] == some.gesture.ravel())
    rates["at_once_of_those_after_day"] = rate((some.labels[..., -1] == some.gesture).ravel())
    stopped = np.concatenate([each.stopped for each in found.pacified])
    tongue = np.isin(usual.gesture.ravel(), (0, 1))
    rates["tongue_out_with_pacifier"] = rate(np.isin(stopped[tongue], (0, 1)))
    rates["tries_improving_share"] = rate(falling(usual.felt))
    rates["tries_improving_share_worn"] = rate(falling(found.worn.felt))
    probability = usual.organ.max(-1).ravel()
    error, bins = calibration_error(probability, usual.right.ravel())
    for condition in ("usual", "tilted", "other"):
        each = [np.array(one.condition) == condition for one in found.mirrored]
        rates[f"organ_accuracy_mirror_{condition}"] = rate(
            np.concatenate([one.right[keep] for one, keep in zip(found.mirrored, each, strict=True)])
        )
    told: dict[str, Any] = {name: share for name, (share, _) in rates.items()}
    told |= {f"{name}_interval": interval for name, (_, interval) in rates.items()}
    simply, day = np.equal(usual.peers[0], ORGAN_SHOWN[usual.gesture]), found.day[:, -1] == some.gesture.ravel()
    for strength, of in (("", usual.strong), ("_weak", ~usual.strong)):
        told[f"organ_beyond_largest_change{strength}"] = more_often(usual.right[of], simply[of]).numbers
    told["less_after_day"] = more_often((some.labels[..., -1] == some.gesture).ravel(), day).numbers
    return told | {
        "organ_calibration_error": error,
        "organ_calibration": bins,
        "confusion": confusion(usual, usual.strong),
        "confusion_weak": confusion(usual, ~usual.strong),
        "match_error_share": np.median(usual.missed, (0, 1)),
        "match_error_share_interval": quartiles(usual.missed),
        "match_error_share_line": float(np.median(usual.line)),
        "match_error_share_worn": np.median(found.worn.missed, (0, 1)),
        "match_error_share_worn_interval": quartiles(found.worn.missed),
        "match_error_share_worn_line": float(np.median(found.worn.line)),
        "match_error_share_other_proportions": np.median(found.fresh["other"].missed, (0, 1)),
        "match_error_share_by_gesture": {
            name: np.median(usual.missed[usual.gesture == number], 0) for number, name in enumerate(GESTURES)
        },
        "tongue_error_mm": tongue_mm(usual, usual.front),
        "tongue_error_mm_turned_10_deg": tongue_mm(usual, ~usual.front),
        "tries_median": float(np.median(tries_until(usual.missed))),
        "tries_median_worn": float(np.median(tries_until(found.worn.missed))),
        "proportions": told["strong_accuracy_other_proportions"],
        "tilted": told["organ_accuracy_tilted"],
        "passive_face_means_nothing": float(np.mean([each.passive for each in found.pacified])),
        "motors_found_scrambled": found.motors_right,
        "habit": {name: float(share) for name, share in zip(SAID, habits(found), strict=True)},
        "organ_over_the_act": course(found),
        "infants": len(found.infants.habit),
        "study_s": found.took_s,
        **found.powers.as_metrics(),
    }


def confusion(answers: Answers, keep: BoolArray) -> dict[str, dict[str, float]]:
    """Shown -> done (at the last try) -> share."""
    rows = {}
    for number, name in enumerate(GESTURES):
        done = answers.labels[..., -1][keep & (answers.gesture == number)]
        counts = np.bincount(done, minlength=LABELS) / max(len(done), 1)
        rows[name] = dict(zip(SAID, counts.tolist(), strict=True))
    return rows


def quartiles(missed: FloatArray) -> list[list[float]]:
    """Of every try."""
    ends: list[list[float]] = np.quantile(missed, (0.25, 0.75), (0, 1)).T.tolist()
    return ends


def falling(felt: FloatArray) -> BoolArray:
    """(n,) whether the felt error fell at the next try, of those that were large."""
    return np.asarray((felt[..., 1:] < felt[..., :-1])[felt[..., :-1] > LARGE])


def tries_until(missed: FloatArray) -> FloatArray:
    """(...) the first try that came near; one more than there were where none did."""
    near = missed <= NEAR
    return np.asarray(np.where(near.any(-1), near.argmax(-1) + 1, missed.shape[-1] + 1))


def tongue_mm(answers: Answers, keep: BoolArray) -> dict[str, FloatArray]:
    """Metres -> (K,) median over strong tongues out that were seen from so far."""
    keep = keep & (answers.gesture == 0) & answers.strong
    metres = np.unique(answers.metres[keep])
    return {f"{far:g}": np.median(answers.tongue_mm[keep & (answers.metres == far)], 0) for far in metres}


def habits(found: Studied) -> FloatArray:
    """(7,) share of own acts that look like each gesture, and like nothing."""
    return np.asarray(np.bincount(found.infants.habit.ravel(), minlength=LABELS) / found.infants.habit.size)


def course(found: Studied) -> dict[str, Any]:
    """P(the right organ) and whether it is the most probable one, all through acts."""
    organ, gesture, strong = found.course
    right = ORGAN_SHOWN[gesture]
    belief = np.take_along_axis(organ, right[:, None, None], -1)[..., 0]
    best = organ.argmax(-1) == right[:, None]
    return {
        "time": [round(time, 3) for time in TIMES_S],
        **{
            f"{what}_{strength}": values[keep].mean(0)
            for what, values in (("probability", belief), ("accuracy", best))
            for strength, keep in (("strong", strong), ("weak", ~strong))
        },
    }


def told(m: dict[str, Any]) -> list[tuple[str, str]]:
    """For people."""

    def share(name: str) -> str:
        low, high = m[f"{name}_interval"]
        return f"{m[name]:.1%} ({low:.1%} to {high:.1%})"

    def tries(name: str) -> str:
        return ", ".join(f"{value:.3f}" for value in m[name])

    millimetres = "; ".join(f"{d} m: {v[-1]:.2f}" for d, v in m["tongue_error_mm"].items())
    return [
        ("organ right, strong", f"{share('organ_accuracy')}; largest change {m['organ_accuracy_largest_change']:.1%}"),
        (
            "organ right, learned before a mirror: usual / tilted / other proportions",
            " / ".join(f"{m[f'organ_accuracy_mirror_{name}']:.1%}" for name in ("usual", "tilted", "other")),
        ),
        ("organ right, weak", f"{share('organ_accuracy_weak')}; {m['organ_accuracy_weak_largest_change']:.1%}"),
        (
            "organ right, tilted by 20 degrees, strong / weak",
            f"{m['tilted']:.1%} / {m['organ_accuracy_weak_tilted']:.1%}",
        ),
        *(
            (
                f"organ right more often than by the largest change, {strength}",
                m[f"organ_beyond_largest_change{of}"]["said"],
            )
            for strength, of in (("strong", ""), ("weak", "_weak"))
        ),
        ("P(organ): calibration error", f"{m['organ_calibration_error']:.3f}"),
        (f"does the same at try {TRIES}, strong / weak", f"{share('strong_accuracy')} / {share('weak_accuracy')}"),
        (
            "match, share of the range, by try",
            f"{tries('match_error_share')}; a line, try 1: {m['match_error_share_line']:.3f}",
        ),
        ("the same, worn", f"{tries('match_error_share_worn')}; line {m['match_error_share_worn_line']:.3f}"),
        ("tongue, mm, last try", millimetres),
        ("tries until within 3 %, median, fresh / worn", f"{m['tries_median']:g} / {m['tries_median_worn']:g}"),
        (
            "felt error falls where above 2 %, fresh / worn",
            f"{m['tries_improving_share']:.0%} / {m['tries_improving_share_worn']:.0%}",
        ),
        ("does the same at once / after a pacifier", f"{share('at_once')} / {share('after_pacifier')}"),
        ("at once / a day later, of some", f"{m['at_once_of_those_after_day']:.1%} / {m['after_day']:.1%}"),
        ("does it less often a day later than at once", m["less_after_day"]["said"]),
        ("adults of other proportions, strong", share("strong_accuracy_other_proportions")),
        ("own motors found, permuted", f"{m['motors_found_scrambled']:.1%}"),
    ]
