"""Options of `imitate intentions`."""

from typing import Annotated, Literal

from experiments.errors import ExperimentError
from experiments.shared.options import Category, Flag, N, Options, ToRead, choices, one_of, options, within, written

CONDITIONS = {
    **dict.fromkeys(
        ("target", "failed", "failed_unlooked", "baseline", "manipulation", "device_failed", "device_success"),
        ("dumbbell", "box", "loop", "square", "cup"),
    ),
    **dict.fromkeys(("outsized", "outsized_baseline"), ("outsized",)),
    **dict.fromkeys(("head_free", "head_bound", "head_none"), ("panel",)),
    **dict.fromkeys(("intended", "accidental"), ("dumbbell", "cup")),
}
"""Conditions, and the objects each is run with: Meltzoff's five (1995), the one that is too large, the light panel."""
OBJECT = choices(dict.fromkeys(name for names in CONDITIONS.values() for name in names))


@options
class Config(Options):
    """Options of `imitate intentions`."""

    condition: Annotated[str, one_of("condition", CONDITIONS), written(choices(CONDITIONS))] = "failed"
    """What is shown: target (the act succeeds), failed (it does not), failed_unlooked (by somebody who never looks up),
    baseline (nothing), manipulation (other acts), device_failed, device_success, outsized (an adult's hands slip off a
    large dumbbell), outsized_baseline, head_free, head_bound, head_none, intended or accidental (two effects, one by
    accident)."""
    object: Annotated[str, written(OBJECT, "the first that goes with the condition")] = ""
    """With what."""
    play: Annotated[ToRead | None, written("FILE.nc", "they play for 38 body-minutes first")] = None
    """What the children learned in play (`imitate play`)."""
    memory: Annotated[ToRead | None, written("FILE.nc", "is shown the condition")] = None
    """What was inferred before, a day later: `memory.nc` of an earlier run."""
    child: Annotated[int | None, within(0, 10_000), written("N", "one with the experience of all of them")] = None
    """Which of the children that played watches, with nothing but its own experience."""
    shown: Annotated[int, within(1, 20), N] = 3
    """How often it is shown."""
    acts: Annotated[int, within(1, 20), N] = 3
    """Acts that there is time for."""
    gives_up: Annotated[float, within(0, 1), written("PROBABILITY")] = 0.1
    """P(somebody stops | the goal is not reached)."""
    own_weight: Annotated[float, within(0, 1000, above=True), written("WEIGHT")] = 0.1
    """How much one's own play weighs in what one wants, against one effect that was just seen."""
    reads: Literal["adult", "itself"] = "adult"
    """Whether the other is taken to have an adult's hands, for which a large thing is not large, or one's own."""
    wants: Annotated[tuple[str, ...], written("STATE=WEIGHT ...", "as one's own play was")] = ()
    """P(goal), such as `--wants apart=1 up=2`; what is not named is 0."""
    selection: Category = "matching"
    """How goals and actions are drawn."""
    workers: Annotated[int, within(1, 256), N] = 2
    """Processes; the result does not depend on it."""
    study: Flag = False
    """Every condition, over agents and plays, beside two peers (minutes)."""
    sensitivity: Flag = False
    """With --study: once more for every parameter that is not learned (minutes)."""
    plays: Annotated[tuple[ToRead, ...], written("FILE.nc ...", "--play's alone")] = ()
    """Independent plays to study."""
    agents: Annotated[int, within(1, 10_000), N] = 200
    """Agents of the study, shared out over the plays; no more than children played."""

    @property
    def toy(self) -> str:
        """The object."""
        return self.object or CONDITIONS[self.condition][0]

    def check(self) -> None:
        """See `Options`."""
        if self.object and self.object not in CONDITIONS[self.condition]:
            raise ExperimentError(
                f"--object {self.object}: {self.condition} is shown with {' or '.join(CONDITIONS[self.condition])}"
            )
        if self.plays and not self.study:
            raise ExperimentError("--plays: several plays are for --study; one imitator takes --play")
        if self.sensitivity and not self.study:
            raise ExperimentError("--sensitivity: it is a part of --study")
        if self.selection == "mean":
            raise ExperimentError("--selection mean: primitives are categories and have no mean; use map or matching")
        super().check()
