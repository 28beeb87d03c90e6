"""Copy turning programs and what they make into tests/data/turning: refresh_turning.py FOLDER."""

import json
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parents[1] / "tests" / "data" / "turning"


def main() -> None:
    folder = Path(sys.argv[1])
    cases = []
    for file in sorted(folder.glob("*.json")):
        case = json.loads(file.read_text())
        shutil.copyfile(folder / case["program"], HERE / case["program"])
        cases.append({key: case[key] for key in ("name", "program", "dialect", "stock", "tools", "expect")})
    (HERE / "cases.json").write_text(json.dumps(cases, indent=1) + "\n")


if __name__ == "__main__":
    main()
