"""Studies of Hingewise in Python: run them, read their results as pandas frames, write scenes.

    import hingewise
    scene = hingewise.load_scene("four-bar")
    scene["study"]["max_evaluations"] = 60
    study = hingewise.run(scene, "study", accuracy="draft", progress=print)
    study.reliability      # a DataFrame over the checkpoints of life
    study.plot()           # R(n) with its interval
    hingewise.what_if(study, {"friction.std": 0.01}).frame("lives")

The standard library is enough but for frames, which need pandas; `Study.rows` gives the same tables without it.
"""

from .answers import Answer, check, designs, evaluate, learn, optimise, replace, simulate, test_plan, update, weibull, what_if
from .program import ProgramError, call
from .runs import Progress, resume, run
from .scenes import dumps, load_scene, save_scene
from .study import Study, StudyError, StudyWarning

__all__ = [
    "Answer",
    "Progress",
    "ProgramError",
    "Study",
    "StudyError",
    "StudyWarning",
    "call",
    "check",
    "designs",
    "dumps",
    "evaluate",
    "learn",
    "load_scene",
    "optimise",
    "replace",
    "resume",
    "run",
    "save_scene",
    "simulate",
    "test_plan",
    "update",
    "weibull",
    "what_if",
]
