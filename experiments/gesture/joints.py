"""How far the joints were off: hinges in degrees, slides in millimetres, one beside the other and never mixed."""

from typing import Any

import numpy as np

from experiments.gesture.found import Performed
from experiments.shared.judging import ringing, rmse
from models.units import SHOWN

MOVES = 1.0
"""A joint whose sub-goals range over more degrees, or millimetres, moves."""
ROWS = {
    "joint error against sub-goals, imitated, last attempt": "joint_rmse",
    "joint error, first attempt": "attempts_rmse",
    "worst joint": "worst_joint",
    "on the way into the movement": "approach_error",
    "joint error, direct replay": "direct_replay_rmse",
    "joint error, linear inverse model in the same loop": "linear_peer_rmse",
}
"""Line of the summary -> metric, its unit left out."""


def joint_metrics(done: Performed) -> dict[str, Any]:
    """Errors against the sub-goals: names that end in _deg are of hinges (null where there are none), in _mm of slides
    (left out where there are none)."""
    found: dict[str, Any] = {}
    for unit, (shown, scale) in SHOWN.items():
        columns = np.flatnonzero([own == unit for own in done.body.units])
        if len(columns):
            found |= _of(done, columns, shown, scale)
        elif shown == "deg":
            found |= {f"{name}_deg": None for name in (*ROWS.values(), "largest_error", "ringing")}
    return found


def _of(done: Performed, columns: Any, shown: str, scale: float) -> dict[str, Any]:
    last, wanted = done.attempts[-1], scale * done.seen.angles[:, columns]
    reached = {"joint": done.imitated, "direct_replay": done.replayed, "linear_peer": done.peer.truth[:, 0]}
    errors = {who: scale * angles[:, columns] - wanted for who, angles in reached.items()}
    own, moving = errors["joint"], np.ptp(wanted, axis=0) > MOVES
    joints, by_joint, rings = [done.body.joints[j] for j in columns], np.sqrt(np.mean(own**2, axis=0)), ringing(own)
    sent = ringing(errors["direct_replay"])
    way = last.way[:, 0, done.factors][:, columns]
    return {
        **{f"{who}_rmse_{shown}": float(np.sqrt(np.mean(error**2))) for who, error in errors.items()},
        f"joint_rmse_{shown}_by_joint": dict(zip(joints, by_joint.tolist(), strict=True)),
        "worst_joint" if shown == "deg" else "worst_slide": joints[int(by_joint.argmax())],
        f"worst_joint_{shown}": float(by_joint.max()),
        f"largest_error_{shown}": float(np.abs(own).max()),
        f"moving_joints_rmse_{shown}": float(np.sqrt(np.mean(own[:, moving] ** 2))) if moving.any() else 0.0,
        f"ringing_{shown}": float(np.median(rings)),
        f"ringing_worst_{shown}": float(rings.max()),
        f"ringing_{shown}_by_joint": dict(zip(joints, rings.tolist(), strict=True)),
        f"direct_replay_ringing_{shown}": float(np.median(sent)),
        f"direct_replay_ringing_worst_{shown}": float(sent.max()),
        f"approach_error_{shown}": scale * rmse(last.approach[:, 0][:, columns], way),
        f"attempts_rmse_{shown}": [rmse(scale * one.truth[:, 0][:, columns], wanted) for one in done.attempts],
    }


def joint_rows(metrics: dict[str, Any]) -> list[tuple[str, str]]:
    """Lines of the summary."""
    rows = []
    for shown, of in (("deg", ""), ("mm", " (slides)")):
        for line, name in ROWS.items():
            value = metrics.get(f"{name}_{shown}")
            if value is not None:
                first = value[0] if isinstance(value, list) else value
                worst = metrics.get("worst_slide" if of else "worst_joint")
                said = f"{line} ({worst})" if name == "worst_joint" else line
                rows.append((said + of, f"{first:.4f} {shown}"))
        if metrics.get(f"ringing_{shown}") is not None:
            rows += ringing_rows(metrics, shown, of)
    return rows


def ringing_rows(metrics: dict[str, Any], shown: str, of: str) -> list[tuple[str, str]]:
    """How far errors shake, peak to peak: of the median joint, and of the worst one."""
    each = metrics[f"ringing_{shown}_by_joint"]
    rows = (("median of joints", "ringing"), (f"worst joint ({max(each, key=each.get)})", "ringing_worst"))
    return [
        (
            f"ringing, peak to peak, {who}; direct replay's{of}",
            f"{metrics[f'{name}_{shown}']:.4f}; {metrics[f'direct_replay_{name}_{shown}']:.4f} {shown}",
        )
        for who, name in rows
    ]
