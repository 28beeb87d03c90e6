#!/usr/bin/env python3
"""Run all shipped programs with two checkouts of gcodesim and tell what differs in what they write.

    scripts/compare_runs.py OLD [NEW] [--world bullet] [--only NAME] [--keep FOLDER]

OLD and NEW are folders of checkouts (NEW: this one). Both are run by this Python, each with its own sources, as
`gcodesim run` of every program in OLD's `programs/` in its cell, in both worlds. Every file is compared: numbers and
texts that OLD has must be the same to the last bit. What NEW has besides (keys, columns, topics, fields of messages)
is listed as gained. Status 1 when a number moved or something is gone.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from ruamel.yaml import YAML  # noqa: E402

from gcodesim.log.fields import leaves, parse_path, value_at  # noqa: E402
from gcodesim.log.logfile import LogFile  # noqa: E402
from gcodesim.log.reader import decoder_of  # noqa: E402

WORLDS = ("kinematic", "bullet")


class Difference(Counter[str]):
    """What differs: how often, by place."""


def main() -> int:
    arguments = _arguments()
    moved, gained = Difference(), Difference()
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(arguments.keep or scratch)
        for name, program, cell in _pairs(arguments.old):
            if arguments.only not in name:
                continue
            for world in arguments.world or WORLDS:
                old, new = (root / side / f"{name}-{world}" for side in ("old", "new"))
                status = [
                    _run(tree, program, cell, world, out) for tree, out in ((arguments.old, old), (arguments.new, new))
                ]
                before = sum(moved.values())
                if status[0] != status[1]:
                    moved[f"{name}, {world}: status {status[0]} became {status[1]}"] += 1
                _compare(old, new, moved, gained)
                print(f"{name}, {world}: {'same' if sum(moved.values()) == before else 'DIFFERS'}", flush=True)
    for title, found in (("moved or gone", moved), ("gained", gained)):
        print(f"{title}: {'nothing' if not found else ''}")
        for place, count in sorted(found.items()):
            print(f"  {place} ({count})")
    return 1 if moved else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path, nargs="?", default=HERE)
    parser.add_argument("--world", action="append", choices=WORLDS)
    parser.add_argument("--only", default="", help="pairs whose name contains this")
    parser.add_argument("--keep", help="folder for the files of all runs")
    return parser.parse_args()


def _pairs(tree: Path) -> Iterator[tuple[str, Path, Path]]:
    """Each shipped cell with its program: that of its test file, else that of the same name."""
    programs, cells = tree / "programs", tree / "cells"
    named: dict[str, Path] = {}
    for case in sorted(programs.glob("*.test.yaml")):
        content = YAML(typ="safe").load(case.read_text())
        stem = case.name.removesuffix(".test.yaml")
        named[Path(content["cell"]).name] = (
            programs / content["program"] if "program" in content else _program(programs, stem)
        )
    for cell in sorted(cells.glob("*.yaml")):
        program = named.get(cell.name) or _program(programs, cell.stem.split("_")[0])
        yield cell.stem, program, cell


def _program(folder: Path, stem: str) -> Path:
    return next(path for path in (folder / f"{stem}.nc", folder / f"{stem}.ngc") if path.exists())


def _run(tree: Path, program: Path, cell: Path, world: str, out: Path) -> int:
    command = [sys.executable, "-m", "gcodesim", "run", str(program), "--cell", str(cell), "--world", world]
    out.mkdir(parents=True)
    return subprocess.run(
        [*command, "--out", str(out.resolve() / "run")],
        cwd=tree,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=False,
    ).returncode


def _compare(old: Path, new: Path, moved: Difference, gained: Difference) -> None:
    files = {path.name: path for path in (old / "run").iterdir()}
    others = {path.name: path for path in (new / "run").iterdir()}
    for name in sorted(files.keys() | others.keys()):
        if name not in others:
            moved[f"{name} is gone"] += 1
        elif name not in files:
            gained[f"file {name}"] += 1
        elif files[name].read_bytes() != others[name].read_bytes():
            how = {".mcap": _logs, ".json": _json_files, ".csv": _tables}.get(files[name].suffix)
            if how is None:
                moved[f"{name}: bytes"] += 1
            else:
                how(files[name], others[name], moved, gained)


def _json_files(old: Path, new: Path, moved: Difference, gained: Difference) -> None:
    _values(json.loads(old.read_text()), json.loads(new.read_text()), old.name, moved, gained)


def _values(old: Any, new: Any, place: str, moved: Difference, gained: Difference) -> None:
    if isinstance(old, dict) and isinstance(new, dict):
        for key in old:
            if key in new:
                _values(old[key], new[key], f"{place}: {key}", moved, gained)
            else:
                moved[f"{place}: {key} is gone"] += 1
        for key in new.keys() - old.keys():
            gained[f"{place}: {key}"] += 1
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for one, other in zip(old, new, strict=True):
            _values(one, other, f"{place}[]", moved, gained)
    elif old != new or type(old) is not type(new):
        moved[f"{place}: {_short(old)} became {_short(new)}"] += 1


def _tables(old: Path, new: Path, moved: Difference, gained: Difference) -> None:
    before, after = (list(csv.reader(path.open(newline=""))) for path in (old, new))
    if len(before) != len(after):
        moved[f"{old.name}: {len(before)} rows became {len(after)}"] += 1
        return
    heads = before[0], after[0]
    for column in heads[1]:
        if column not in heads[0]:
            gained[f"{old.name}: {column}"] += 1
    for place, column in enumerate(heads[0]):
        if column not in heads[1]:
            moved[f"{old.name}: {column} is gone"] += 1
            continue
        other = heads[1].index(column)
        moved[f"{old.name}: {column}"] += sum(a[place] != b[other] for a, b in zip(before[1:], after[1:], strict=True))
    for name in [name for name, count in moved.items() if not count]:
        del moved[name]


def _logs(old: Path, new: Path, moved: Difference, gained: Difference) -> None:
    logs = LogFile.open(old), LogFile.open(new)
    topics = [{channel.topic: number for number, channel in log.channels.items()} for log in logs]
    for topic in topics[1].keys() - topics[0].keys():
        gained[f"log: topic {topic}"] += 1
    for topic, number in topics[0].items():
        if topic not in topics[1]:
            moved[f"log: topic {topic} is gone"] += 1
            continue
        both = [list(log.messages([at])) for log, at in ((logs[0], number), (logs[1], topics[1][topic]))]
        if len(both[0]) != len(both[1]):
            moved[f"log: {topic}: {len(both[0])} messages became {len(both[1])}"] += 1
            continue
        decode = [decoder_of(logs[0], number), decoder_of(logs[1], topics[1][topic])]
        for one, other in zip(*both, strict=True):
            if one.t_ns != other.t_ns:
                moved[f"log: {topic}: time"] += 1
            elif one.data != other.data:
                _messages(decode[0](one), decode[1](other), topic, moved, gained)
    for name in logs[0].attachments.keys() | logs[1].attachments.keys():
        if name in ("results.json", "layout.json"):  # the first is compared as a file, the second is how it looks
            continue
        if any(name not in log.attachments for log in logs):
            (gained if name in logs[1].attachments else moved)[f"log: attachment {name}"] += 1
        elif logs[0].attachment(name) != logs[1].attachment(name):
            moved[f"log: attachment {name}"] += 1
    _values(dict(logs[0].metadata), dict(logs[1].metadata), "log: metadata", moved, gained)


def _messages(old: Any, new: Any, topic: str, moved: Difference, gained: Difference) -> None:
    if topic.startswith("/scene/"):  # thousands of points: that they differ says enough
        moved[f"log: {topic}"] += 1
        return
    known = set(leaves(old))
    for path in leaves(new):
        if path not in known:
            gained[f"log: {topic}: {path}"] += 1
    for path in known:
        parts = parse_path(path)
        try:
            same = value_at(old, parts) == value_at(new, parts)
        except ValueError:
            same = False
        if not same:
            moved[f"log: {topic}: {path}"] += 1


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."


if __name__ == "__main__":
    sys.exit(main())
