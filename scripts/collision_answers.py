#!/usr/bin/env python3
"""What gcodesim says about moves of bodies in a file of cases: `collision_answers.py CASES.json ANSWERS.json`."""

from __future__ import annotations

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.collision_cases import answer, read_cases


def main() -> None:
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    cases = read_cases(source)
    answers = {case["id"]: answer(case, cases.get("robots", {})) for case in cases["cases"]}
    target.write_text(json.dumps(answers, indent=1) + "\n")


if __name__ == "__main__":
    main()
