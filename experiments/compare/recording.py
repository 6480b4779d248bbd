"""The recording of `imitate compare`: errors, and every joint's movements over each other."""

from pathlib import Path

import rerun.blueprint as rrb

from experiments.compare.figures import COLOURS
from experiments.compare.found import Compared
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, light
from experiments.shared.recording import log_series, recording

SHOWN = 4
"""Joints that move most, one below the other; all others are behind them."""


def record(path: Path, done: Compared, summary: str) -> None:
    """Write the recording."""
    name = " and ".join(run.label for run in done.runs)
    with recording(path, "imitate-compare", name, layout(done), summary) as stream:
        for number, run, whole in done.tracked:
            tracks, own = whole.of(done.joints), light(COLOURS[number % len(COLOURS)])
            shown = [("imitated", run.label, tracks.imitated, own, 1.5)]
            if not done.alike or whole is done.tracked[0][2]:
                shown.insert(0, ("demonstrated", "demonstrated", tracks.demonstrated, DEMONSTRATED, 3.0))
            for what, said, values, colour, width in shown:
                for place, series in enumerate(values.T):
                    log_series(stream, f"joints/{place}/{what}/{number}", series, tracks.tick_s, said, colour, width)
            log_series(stream, f"error/{number}", tracks.error, tracks.tick_s, run.label, own)


def layout(done: Compared) -> rrb.Horizontal:
    """Table left; error and joints right."""
    shared = done.tracked[0][2].of(done.joints)
    joints = [
        views.series(f"{joint} [{unit}]", origin=f"/joints/{place}")
        for place, (joint, unit) in enumerate(zip(shared.joints, shared.units, strict=True))
    ]
    error = views.series(f"error, root mean square of all joints [{done.unit}]", origin="/error")
    more = [rrb.Tabs(*joints[SHOWN:], active_tab=0)] if joints[SHOWN:] else []
    return rrb.Horizontal(views.summary(), rrb.Vertical(error, *joints[:SHOWN], *more), column_shares=[1, 1.6])
