"""An example of each finding: small files, the command that reads them, and what it prints."""

from __future__ import annotations

from importlib.resources import files

from gcodesim.frozen import frozen

_NOT_TO_READ = (".txt", ".stl", ".golden.json")
_PROMPT = "$ gcodesim "


@frozen
class Example:
    """The example's own `files` and those that the command names, by name with their text; `command` after
    `gcodesim`, and the findings as it prints them."""

    files: dict[str, str]
    command: str
    printed: str


def command_of(transcript: str) -> str:
    """The command that stands in the first line of a transcript."""
    first = transcript.partition("\n")[0]
    if not first.startswith(_PROMPT):
        raise ValueError(f"a transcript begins with `{_PROMPT}…`, not with `{first}`")
    return first.removeprefix(_PROMPT)


def example_of(code: str) -> Example | None:
    """The example of `code` (GSnnn); None when it has none."""
    folder = files("gcodesim") / "data" / "examples"
    transcript = folder / f"{code}.txt"
    if not transcript.is_file():
        return None
    text = transcript.read_text(encoding="utf-8")
    command = command_of(text)
    named = [word for word in command.split() if (folder / word).is_file()]
    beside = sorted(item.name for item in folder.iterdir() if item.name.startswith(f"{code}."))
    named += [name for name in beside if name not in named and not name.endswith(_NOT_TO_READ)]
    return Example(
        files={name: (folder / name).read_text(encoding="utf-8") for name in named},
        command=command,
        printed=text.partition("\n")[2],
    )
