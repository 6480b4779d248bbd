"""Chapters of a battery's report: what each stage is, the experiment it comes from, its rows beside infants."""

from collections.abc import Mapping

from experiments.battery.beside import Row
from experiments.battery.found import Battery, told
from experiments.battery.infants import Rate
from experiments.shared.tables import table

HEADS = ("what", "agents (95 %)", "infants", "study (status)", "verdict")
STARTS = {"whose": "parts", "movement": "movements", "gaze": "gaze", "face": "face", "head": "touch"}
STAGES: Mapping[str, tuple[str, str, str]] = {
    "parts": (
        "Stage 1: whose part moved",
        "A single act of a robot of other proportions; whose part moved is told by what one's own motors were seen to "
        "move in the mirror.",
        "imitate correspondence",
    ),
    "movements": (
        "Stage 2: movements reproduced",
        "Two movements of other robots, understood by the image from the mirror and done by Eq. (1) on what babbling "
        "taught. Without a mirror: after a glimpse into it. Without babbling: after its first seconds, nothing "
        "rehearsed. Without one's "
        "own body: in a body that is wired otherwise.",
        "imitate gesture --robot hoap2-seated",
    ),
    "gaze": (
        "Stage 2: what a teacher looks at",
        "Eq. (2) on one's own saccades, seen from the other's place; whether a covered face sees is known from one's "
        "own covered eyes.",
        "imitate gaze --robot hoap2",
    ),
    "face": (
        "Stage 2: faces",
        "Newborns who babbled in the dark and never saw their own face see an adult's act once, and try three times. "
        "That they try at all is assumed here; `imitate face --study` has others, of whose acts few are imitations.",
        "imitate face",
    ),
    "touch": (
        "Stage 3: an act seen once",
        "A panel lit with the forehead, seen once, in one way or another; then three acts of one's own, by Eq. (1) on "
        "one's own play.",
        "imitate objects",
    ),
    "intentions": (
        "Stage 4: what was meant",
        "Eq. (2) over what was shown: somebody or a device, with success or in vain, hands free or bound; then three "
        "acts.",
        "imitate intentions",
    ),
}
"""Name of the figure -> title, what it is, the command of the experiment whose protocol it is."""


FILMS: Mapping[str, str] = {
    "parts-1": "The first agent of all babbles before the mirror, after it has found its motors and senses.",
    "movements-1": "The agent imitates another robot's movement (lines); a ghost where that should take it.",
    "gaze-1": "What the agent's left eye sees: somebody turns to a toy; then it looks there.",
    "face-1": "What an adult's face does, at half its pace.",
    "face-2": "The newborn's three tries, each followed by rest, at half their pace.",
    "touch-1": "An adult lights the panel with its forehead.",
    "touch-2": "What the agent does first when it is given the panel.",
    "intentions-1": "An adult who tries to pull a dumbbell apart, in vain.",
    "intentions-2": "What the agent does first, who saw such tries.",
}
"""Name of a film -> what it shows; it stands with the figure of its name."""


def stage_of(task: str) -> str:
    """The chapter that a task belongs to."""
    return next((name for begins, name in STARTS.items() if task.startswith(begins)), "intentions")


def words(done: Battery) -> dict[str, str]:
    """By figure, its heading; by film, its caption."""
    found = {}
    for name, (title, what, command) in STAGES.items():
        rows = [row for row in done.rows if row.simulated is not None and stage_of(_task(row)) == name]
        beside = f"\n\n{beside_infants(rows)}" if rows else ""
        found[name] = f"## {title}\n\n{what} The experiment: `{command}`.{beside}"
    return found | {f"film-{name}": what for name, what in FILMS.items()}


def beside_infants(rows: list[Row]) -> str:
    """A table."""
    lines = []
    for one in map(told, rows):
        low_high = one["interval"]
        found = "-" if low_high is None else f"{one['simulated']:.2f} ({low_high[0]:.2f} to {low_high[1]:.2f})"
        said = one["published"] if isinstance(one["published"], str) else f"{one['published'][0]:.2f}"
        remark = f"; {one['remark']}" if one["remark"] else ""
        lines.append((one["task"], found, said, f"{one['study']} ({one['status']}{remark})", one["verdict"]))
    return table(lines, HEADS)


def _task(row: Row) -> str:
    return (row.published.cell if isinstance(row.published, Rate) else row.published.more).task
