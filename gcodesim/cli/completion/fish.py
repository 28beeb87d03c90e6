"""Completion for fish, from version 3 on."""

from __future__ import annotations

from collections.abc import Iterator

from gcodesim.cli.outline import ANY, Command, Option, Value

_HEAD = """# completion of gcodesim for fish: gcodesim completion fish > ~/.config/fish/completions/gcodesim.fish

# whether the words behind gcodesim begin with these; without any, whether there is no word yet
function __gcodesim_at
    set -l words (commandline -opc)
    set -e words[1]
    set -l most (count $argv)
    if test $most -eq 0
        test (count $words) -eq 0
        return
    end
    test (count $words) -ge $most; and test "$words[1..$most]" = "$argv"
end

# as __gcodesim_at, and nothing else has been said
function __gcodesim_only
    test (count (commandline -opc)) -eq (math (count $argv) + 1); and __gcodesim_at $argv
end

# files with one of these endings, any file if there is none; and folders
function __gcodesim_files
    set -l all (__fish_complete_path (commandline -ct))
    set -l endings (string join '|' $argv)
    if string match -qr '^[^\\t]*\\.('$endings')(\\t.*)?$' -- $all
        string match -r '^[^\\t]*(?:/|\\.(?:'$endings'))(?:\\t.*)?$' -- $all
    else
        string join \\n -- $all
    end
end

complete -c gcodesim -e
complete -c gcodesim -f
"""


def script(whole: Command) -> str:
    """The script."""
    return "\n".join([_HEAD, *_lines(whole)]) + "\n"


def _lines(command: Command) -> Iterator[str]:
    at = " ".join(["__gcodesim_at", *command.path])
    for action in command.actions:
        only = " ".join(["__gcodesim_only", *command.path])
        yield f"complete -c gcodesim -n '{only}' -a {action.path[-1]} -d {_quoted(action.says)}"
    for option in command.options:
        yield f"complete -c gcodesim -n '{at}' {_option(option)}"
    for place in command.places:
        if offered := _offered(place):
            yield f"complete -c gcodesim -n '{at}' {offered} -d {_quoted(place.name)}"
    for action in command.actions:
        yield from _lines(action)


def _option(option: Option) -> str:
    names = [f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option.names]
    says = f"-d {_quoted(option.says)}"
    if option.value is None:
        return " ".join([*names, says])
    needed = ["-f"] if option.value.counts == "?" else ["-x"]
    return " ".join([*names, *needed, *filter(None, [_offered(option.value)]), says])


def _offered(value: Value) -> str:
    sources = [*value.words]
    if value.folders:
        sources.append("(__fish_complete_directories)")
    if value.files == ANY:
        sources.append("(__fish_complete_path)")
    elif value.files:
        sources.append(f"(__gcodesim_files {' '.join(value.files)})")
    return f"-a {_quoted(' '.join(sources))}" if sources else ""


def _quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
