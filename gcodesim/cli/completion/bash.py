"""Completion for bash, from version 3.2 on and without the package bash-completion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from gcodesim.cli.outline import Command, Value

_SCRIPT = """# completion of gcodesim for bash: eval "$(gcodesim completion bash)"

# files that begin with $1 and end in one of the others, any file if there is none; and folders
_gcodesim_files() {
    local cur=$1 one ending fits
    local -a all=() fit=()
    shift
    while IFS= read -r one; do
        if [[ -d $one ]]; then
            COMPREPLY+=("$one")
            continue
        fi
        fits=
        for ending in "$@"; do [[ $one == *".$ending" ]] && fits=1; done
        all+=("$one")
        [[ -n $fits ]] && fit+=("$one")
    done < <(compgen -f -- "$cur")
    if [[ ${#fit[@]} -gt 0 ]]; then
        COMPREPLY+=("${fit[@]}")
    elif [[ ${#all[@]} -gt 0 ]]; then
        COMPREPLY+=("${all[@]}")
    fi
    compopt -o filenames 2>/dev/null
}

_gcodesim() {
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} at= words= files= folders=
    [[ $prev == = ]] && prev=${COMP_WORDS[COMP_CWORD-2]}
    if [[ $cur == = ]]; then cur=; fi
    [[ $COMP_CWORD -gt 1 ]] && at=${COMP_WORDS[1]}
    case $at in
        @GROUPS@) [[ $COMP_CWORD -gt 2 ]] && at+=" ${COMP_WORDS[2]}" ;;
    esac
    COMPREPLY=()
    case "$at $prev" in
@VALUES@
        *)
            if [[ $cur == -* ]]; then
                case $at in
@OPTIONS@
                esac
            else
                case $at in
@PLACES@
                esac
            fi
            ;;
    esac
    if [[ -n $words ]]; then
        local one
        while IFS= read -r one; do COMPREPLY+=("$one"); done < <(compgen -W "$words" -- "$cur")
    fi
    if [[ -n $folders ]]; then
        local one
        while IFS= read -r one; do COMPREPLY+=("$one"); done < <(compgen -d -- "$cur")
        compopt -o filenames 2>/dev/null
    fi
    if [[ -n $files ]]; then
        set -f
        _gcodesim_files "$cur" $files
        set +f
    fi
}
complete -F _gcodesim gcodesim
"""


def script(whole: Command) -> str:
    """The script."""
    commands = [whole, *(one for command in whole.actions for one in (command, *command.actions))]
    groups = [command.name for command in whole.actions if command.actions]
    parts = {
        "@GROUPS@": "|".join(groups),
        "@VALUES@": "\n".join(line for command in commands for line in _values(command)),
        "@OPTIONS@": "\n".join(_arm(command.name, _words(_option_names(command)), 20) for command in commands),
        "@PLACES@": "\n".join(_arm(command.name, _places(command), 20) for command in commands),
    }
    text = _SCRIPT
    for name, part in parts.items():
        text = text.replace(name, part)
    return text


def _values(command: Command) -> Iterator[str]:
    """An arm for each option that takes a value; one that may go without is completed as if it had."""
    for option in command.options:
        if option.value is None:
            continue
        values = [option.value, *(command.places if option.value.counts == "?" else ())]
        patterns = "|".join(f'"{command.name} {name}"' for name in option.names)
        yield _arm(patterns, _assignments(values), 8, quoted=True)


def _option_names(command: Command) -> list[str]:
    return [name for option in command.options for name in option.names if name.startswith("--")]


def _places(command: Command) -> str:
    if command.actions:
        return _words([action.path[-1] for action in command.actions])
    return _assignments(command.places)


def _assignments(values: Iterable[Value]) -> str:
    values = list(values)
    words = [word for value in values for word in value.words]
    files = [ending for value in values for ending in value.files]
    texts = [_words(words)] if words else []
    texts += [f"files='{' '.join(dict.fromkeys(files))}'"] if files else []
    texts += ["folders=1"] if any(value.folders for value in values) else []
    return " ".join(texts) or ":"


def _words(words: Iterable[str]) -> str:
    return f"words='{' '.join(words)}'"


def _arm(pattern: str, body: str, indent: int, *, quoted: bool = False) -> str:
    return f"{' ' * indent}{pattern if quoted else repr(pattern)}) {body} ;;"
