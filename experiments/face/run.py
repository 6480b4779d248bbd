"""`imitate face`: an infant that never saw its own face watches another's and does the same.

Once or as a study (`study`).
"""

from experiments.face.figures import study_figures
from experiments.face.found import metrics, told
from experiments.face.one import one
from experiments.face.options import Config
from experiments.face.study import studied
from experiments.shared.experiment import Result
from experiments.shared.tables import table
from models.face import face_of
from models.face.body import face_body


def run(config: Config) -> Result:
    """One infant and one adult; or the study."""
    config.check()
    for name in (config.face, config.adult):  # read before anybody babbles
        face_body(face_of(name))
    if not config.study:
        return one(config)
    found = studied(config)
    numbers = metrics(found)
    return Result(numbers, "# Faces\n\n" + table(told(numbers)), study_figures(found, numbers))
