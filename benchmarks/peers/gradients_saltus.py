"""Runner of gradients.py: Saltus. One row per problem; a problem that is refused gives none."""

import json
import sys
import time

import saltus
from gradients_problems import PROBLEMS

for name, problem in PROBLEMS.items():
    model = saltus.Model.from_text(problem["text"])
    begin = time.process_time()
    try:
        result = model.simulate(until=problem["until"], method="fesd", stages=3, steps=20, sensitivities=True)
    except (saltus.ModelError, saltus.Stopped) as error:
        print(f"{name}: {error}", file=sys.stderr)
        continue
    states = list(model.states)
    matrix = result.sensitivities.x0 if problem["set"] in states else result.sensitivities.p
    column = states.index(problem["set"]) if problem["set"] in states else 0
    print(json.dumps({"problem": name, "value": float(matrix[states.index(problem["state"])][column]), "seconds": time.process_time() - begin}))
