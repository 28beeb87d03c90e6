"""Completion for zsh, by its own `_arguments`."""

from __future__ import annotations

from collections.abc import Iterator

from gcodesim.cli.outline import ANY, Command, Option, Value

_HEAD = """#compdef gcodesim
# completion of gcodesim for zsh: eval "$(gcodesim completion zsh)" behind compinit, or a file _gcodesim in $fpath
"""
_TAIL = """
if [[ ${funcstack[1]} == _gcodesim ]]; then
    _gcodesim "$@"
else
    compdef _gcodesim gcodesim
fi
"""


def script(whole: Command) -> str:
    """The script."""
    return "\n".join([_HEAD, *_functions(whole), _TAIL]).replace("\n\n\n", "\n\n")


def _functions(command: Command) -> Iterator[str]:
    """The function of each command, those of its actions first."""
    for action in command.actions:
        yield from _functions(action)
    own = "".join(f" \\\n        {spec}" for spec in _specs(command))
    if not command.actions:
        yield f"{_function(command)}() {{\n    _arguments -s -S{own}\n}}\n"
        return
    rows = "\n".join(f"        {_quoted(f'{one.path[-1]}:{one.says}')}" for one in command.actions)
    arms = "\n".join(f"        {one.path[-1]}) {_function(one)} ;;" for one in command.actions)
    yield f"""{_function(command)}() {{
    local -a actions
    actions=(
{rows}
    )
    if (( CURRENT == 2 )); then
        _describe -t commands command actions
        _arguments -S{own}
        return
    fi
    shift words
    (( CURRENT-- ))
    case ${{words[1]}} in
{arms}
    esac
}}
"""


def _function(command: Command) -> str:
    return "_".join(["_gcodesim", *(word.replace("-", "_") for word in command.path)])


def _specs(command: Command) -> Iterator[str]:
    for option in command.options:
        yield from _option(option)
    for number, place in enumerate(command.places, start=1):
        where = "*" if place.counts in ("*", "+") else str(number)
        yield _quoted(f"{where}:{':' if place.counts == '?' else ''}{_text(place.name)}:{_offered(place)}")


def _option(option: Option) -> Iterator[str]:
    others = "" if option.repeats else f"({' '.join(option.names)})"
    for name in option.names:
        head = f"{'*' if option.repeats else others}{name}"
        says = f"[{_text(option.says)}]"
        if option.value is None:
            yield _quoted(f"{head}{says}")
            continue
        after = "=" if name.startswith("--") else "+"
        mark = "::" if option.value.counts == "?" else ":"
        yield _quoted(f"{head}{after}{says}{mark}{_text(option.value.name)}:{_offered(option.value)}")


def _offered(value: Value) -> str:
    """The action by which zsh finds what may stand there."""
    sources = []
    if value.folders:
        sources.append("_files -/")
    if value.files:
        sources.append("_files" if value.files == ANY else f'_files -g "*.({"|".join(value.files)})(-.)"')
    if not sources:
        return f"({' '.join(value.words)})" if value.words else " "
    if value.words:
        sources.insert(0, f"compadd -- {' '.join(value.words)}")
    return sources[0] if len(sources) == 1 else "{ " + "; ".join(sources) + " }"


def _text(text: str) -> str:
    for sign in "\\[]:":
        text = text.replace(sign, f"\\{sign}")
    return text


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"
