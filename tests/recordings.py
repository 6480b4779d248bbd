"""What a recording shows, read back out of its file: views, and whether there is anything in them."""

from collections import defaultdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rerun.chunk import RrdReader

NEEDED = {
    "TimeSeries": "Scalars:scalars",
    "BarChart": "BarChart:values",
    "TextDocument": "TextDocument:text",
    "TextLog": "TextLog:text",
    "StateTimeline": "StateChange:state",
    "2D": "",
    "3D": "",
}
"""Kind of a view -> component without which it is empty; where several will do, any."""


class View(NamedTuple):
    """One panel of a blueprint."""

    kind: str
    name: str
    origin: str
    queries: list[str]

    def finds(self, entity: str) -> bool:
        """Whether Rerun 0.41 shows an entity in it: `/**` at the end is a whole tree, a `*` elsewhere is nothing."""
        for query in self.queries:
            path = query.removeprefix("+ ").replace("$origin", self.origin.rstrip("/"))
            whole = path.endswith("/**")
            path = path.removesuffix("/**")
            if entity == path or (whole and (entity + "/").startswith(path + "/")):
                return True
        return False


def views(path: Path) -> list[View]:
    """Every view of the blueprint in a recording."""
    reader = RrdReader(path)
    told: dict[str, dict[str, Any]] = defaultdict(dict)
    for chunk in reader.stream(store=reader.blueprints()[-1]):
        batch = chunk.to_record_batch()
        place = str(chunk.entity_path).split("/")
        if len(place) > 2 and place[1] == "view":
            told[place[2]].update({name: batch.column(name)[0].as_py() for name in batch.schema.names})
    return [
        View(
            one["ViewBlueprint:class_identifier"][0],
            one["ViewBlueprint:display_name"][0],
            one["ViewBlueprint:space_origin"][0],
            one["ViewContents:query"],
        )
        for one in told.values()
    ]


def logged(path: Path) -> dict[str, set[str]]:
    """Component -> entities that have a number, or anything else, of it."""
    reader = RrdReader(path)
    found: dict[str, set[str]] = defaultdict(set)
    for chunk in reader.stream(store=reader.recordings()[0]):
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if ":" not in name or not any(batch.column(name).is_valid()):
                continue
            if name == "Scalars:scalars" and not np.isfinite(batch.column(name).flatten().to_numpy(False)).any():
                continue
            found[name].add(str(chunk.entity_path))
    return found


def empty_views(path: Path) -> list[str]:
    """Names of views in which nothing would be seen."""
    there = logged(path)
    anything = {
        entity for name, entities in there.items() if not name.startswith("RecordingInfo") for entity in entities
    }
    return [
        view.name
        for view in views(path)
        if not any(map(view.finds, there.get(NEEDED[view.kind], ()) if NEEDED[view.kind] else anything))
    ]
