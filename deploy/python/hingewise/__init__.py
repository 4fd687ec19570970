"""Studies of Hingewise in Python: run them, read their results as pandas frames, write scenes.

    import hingewise
    scene = hingewise.load_scene("four-bar")
    scene["study"]["max_evaluations"] = 60
    study = hingewise.run(scene, "study", accuracy="draft", progress=print)
    study.reliability      # a DataFrame over the checkpoints of life

The standard library is enough but for frames, which need pandas; `Study.rows` gives the same tables without it.
"""

from .program import ProgramError, call
from .runs import Progress, resume, run
from .scenes import dumps, load_scene, save_scene
from .study import Study, StudyError, StudyWarning

__all__ = [
    "Progress",
    "ProgramError",
    "Study",
    "StudyError",
    "StudyWarning",
    "call",
    "dumps",
    "load_scene",
    "resume",
    "run",
    "save_scene",
]
