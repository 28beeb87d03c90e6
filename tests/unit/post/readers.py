"""Readers of robot programs, by the controls' manuals: what a control would do with the files, in SI.

They share nothing with the writers: angles become rotations by their definitions, by multiplying single turns.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

X_NONE = np.eye(4)
NUMBER = r"[-+]?[0-9]*\.?[0-9]+(?:E[0-9]+)?"


@dataclass
class Target:
    """Joints [rad], or the tip in the control's base frame (4, 4); `stands` as the language says it."""

    joints: np.ndarray | None = None
    X_KT: np.ndarray | None = None
    stands: tuple[int | str, ...] = ()
    externals: tuple[float, ...] = ()


@dataclass
class Read:
    """One instruction: `joint`, `linear`, `circular`, `wait`, `set`, `await`, `call`, `halt`."""

    kind: str
    to: Target | None = None
    via: Target | None = None
    X_FT: np.ndarray = field(default_factory=lambda: np.eye(4))
    speed: float = 0.0
    blend: float = 0.0
    line: int = 0
    signal: str = ""
    value: float = 0.0


def about(axis: str, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    k = "xyz".index(axis)
    i, j = (k + 1) % 3, (k + 2) % 3
    R = np.eye(4)
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def at(x: float, y: float, z: float) -> np.ndarray:
    X = np.eye(4)
    X[:3, 3] = x, y, z
    return X


def of_abc(words: Mapping[str, float]) -> np.ndarray:
    """KUKA: A about Z, then B about the new Y, then C about the new X; mm and degrees."""
    a, b, c = (math.radians(words[name]) for name in "ABC")
    return at(*(words[n] / 1000 for n in "XYZ")) @ about("z", a) @ about("y", b) @ about("x", c)


def of_wpr(words: Mapping[str, float]) -> np.ndarray:
    """Fanuc: W about the fixed X, then P about the fixed Y, then R about the fixed Z."""
    w, p, r = (math.radians(words[name]) for name in "WPR")
    return at(*(words[n] / 1000 for n in "XYZ")) @ about("z", r) @ about("y", p) @ about("x", w)


def of_quaternion(p: list[float], q: list[float]) -> np.ndarray:
    """ABB: q1 is the real part; mm."""
    s, x, y, z = q
    assert abs(math.sqrt(s * s + x * x + y * y + z * z) - 1.0) < 1e-6
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    X = at(*(v / 1000 for v in p))
    X[:3, :3] = np.eye(3) + 2 * s * K + 2 * K @ K
    return X


def of_vector(values: list[float]) -> np.ndarray:
    """UR: position in m, axis times angle."""
    v = np.array(values[3:])
    angle = float(np.linalg.norm(v))
    X = at(*values[:3])
    if angle:
        n = v / angle
        K = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
        X[:3, :3] = np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return X


def line_in(text: str) -> int:
    found = re.search(r"line (\d+)", text)
    return int(found[1]) if found else 0


# ---- KRL


def read_krl(files: Mapping[str, str], name: str) -> list[Read]:
    """All instructions of NAME.src and of the programs that it calls."""
    points = _krl_points(files.get(f"{name}.dat", ""))
    return list(_krl(files, name, points, {"base": X_NONE, "tool": X_NONE, "speed": 0.0, "zone": 0.0}))


def _krl_points(text: str) -> dict[str, dict[str, float]]:
    return {m[1]: _words(m[2]) for m in re.finditer(r"DECL E6(?:POS|AXIS) (\w+)=\{(.*?)\}", text)}


def _words(text: str) -> dict[str, float]:
    return {m[1]: float(m[2]) for m in re.finditer(rf"([A-Z]\d?)\s+({NUMBER})", text)}


def _krl(files: Mapping[str, str], name: str, points: dict, state: dict) -> Iterator[Read]:
    for line in files[f"{name}.src"].splitlines():
        code = line.partition(";")[0].strip()
        if not code or code.startswith(("&", "DEF", "END", "$ADVANCE", "$ORI", "$CIRC", "$IPO", "BAS")):
            continue
        if m := re.fullmatch(r"\$(BASE|TOOL)=\{(.*)\}", code):
            state[m[1].lower()] = of_abc(_words(m[2]))
        elif m := re.fullmatch(r"\$VEL.CP=(.*)", code):
            state["speed"] = float(m[1])
        elif m := re.fullmatch(r"\$APO.CDIS=(.*)", code):
            state["zone"] = float(m[1]) / 1000
        elif m := re.fullmatch(r"WAIT SEC (.*)", code):
            yield Read("wait", value=float(m[1]))
        elif m := re.fullmatch(r"WAIT FOR \$IN\[(\w+)\]==(TRUE|FALSE)", code):
            yield Read("await", signal=m[1], value=float(m[2] == "TRUE"))
        elif m := re.fullmatch(r"CHANGE\((\d+)\)", code):
            yield Read("call", value=float(m[1]))
        elif code == "HALT":
            yield Read("halt")
        elif m := re.fullmatch(r"(?:TRIGGER WHEN DISTANCE=0 DELAY=0 DO )?\$(?:OUT|ANOUT)\[(\w+)\]=(.*)", code):
            value = {"TRUE": 1.0, "FALSE": 0.0}.get(m[2])
            yield Read("set", signal=m[1], value=float(m[2]) if value is None else value)
        elif m := re.fullmatch(r"(PTP|LIN|CIRC) (\w+)(?:,(\w+))?( C_\w+)?", code):
            targets = [_krl_target(points[p], state["base"]) for p in (m[2], m[3]) if p]
            yield Read(
                {"PTP": "joint", "LIN": "linear", "CIRC": "circular"}[m[1]],
                to=targets[-1],
                via=targets[0] if m[1] == "CIRC" else None,
                X_FT=state["tool"],
                speed=state["speed"],
                blend=state["zone"] if m[4] == " C_DIS" else 0.0,
                line=line_in(line),
            )
        elif m := re.fullmatch(r"(\w+)\(\)", code):
            yield from _krl(files, m[1], _krl_points(files[f"{m[1]}.dat"]), state)
        else:
            raise AssertionError(f"not KRL: {line}")


def _krl_target(words: dict[str, float], X_KP: np.ndarray) -> Target:
    externals = tuple(words[f"E{k}"] for k in range(1, 7) if f"E{k}" in words)
    if "A1" in words:
        return Target(joints=np.radians([words[f"A{k}"] for k in range(1, 7)]), externals=externals)
    stands = (int(words["S"]), int(words["T"])) if "S" in words else ()
    return Target(X_KT=X_KP @ of_abc(words), stands=stands, externals=externals)


# ---- RAPID


def _value(text: str) -> list:
    """An aggregate [..] as lists of numbers."""
    return json.loads(text.replace("TRUE", "1").replace("FALSE", "0"))


def _arguments(text: str) -> list[str]:
    """Divided at commas outside brackets."""
    parts, depth = [""], 0
    for c in text:
        depth += (c == "[") - (c == "]")
        if c == "," and not depth:
            parts.append("")
        else:
            parts[-1] += c
    return parts


def read_rapid(files: Mapping[str, str], name: str) -> list[Read]:
    text = "\n".join(files.values())
    tools = {m[1]: _value(m[2]) for m in re.finditer(r"PERS tooldata (\w+):=(.*);", text)}
    works = {m[1]: _value(m[2]) for m in re.finditer(r"PERS wobjdata (\w+):=(.*);", text.replace('""', "0"))}
    bodies = {m[1]: m[2] for m in re.finditer(r"PROC (\w+)\(\)\n(.*?)ENDPROC", text.replace("\r", ""), re.S)}
    return list(_rapid(bodies, name, tools, works))


def _rapid(bodies: dict, name: str, tools: dict, works: dict) -> Iterator[Read]:
    for line in bodies[name].splitlines():
        code = line.partition("!")[0].strip()
        if not code:
            continue
        assert code.endswith(";"), line
        word, _, rest = code[:-1].partition(" ")
        said = _arguments(rest)
        if word in bodies:
            yield from _rapid(bodies, word, tools, works)
        elif word == "MoveAbsJ":
            joints, externals = _value(said[0].partition("\\")[0])
            speed, tool = _value(said[1].partition("\\")[0]), tools[said[3].partition("\\")[0]]
            target = Target(joints=np.radians(joints), externals=tuple(v for v in externals if v < 9e9))
            yield Read("joint", to=target, X_FT=of_quaternion(*tool[1]), speed=speed[0] / 1000, line=line_in(line))
        elif word in ("MoveL", "MoveC", "MoveLDO"):
            count = 2 if word == "MoveC" else 1
            speed, zone, tool = said[count : count + 3]
            tool_name, _, work = tool.partition("\\WObj:=")
            X_KP = of_quaternion(*works[work][3]) @ of_quaternion(*works[work][4])
            targets = [_rapid_target(_value(text), X_KP) for text in said[:count]]
            yield Read(
                "circular" if count == 2 else "linear",
                to=targets[-1],
                via=targets[0] if count == 2 else None,
                X_FT=of_quaternion(*tools[tool_name][1]),
                speed=_value(speed)[0] / 1000,
                blend=0.0 if zone == "fine" else _value(zone)[1] / 1000,
                line=line_in(line),
            )
            if word == "MoveLDO":
                yield Read("set", signal=said[4], value=float(said[5]))
        elif word in ("SetDO", "SetAO"):
            yield Read("set", signal=said[0], value=float(said[1]))
        elif word == "WaitDI":
            yield Read("await", signal=said[0], value=float(said[1]))
        elif word == "CHANGE":
            yield Read("call", value=float(rest))
        elif word == "WaitTime":
            yield Read("wait", value=float(said[-1]))
        elif word == "Stop":
            yield Read("halt")
        else:
            raise AssertionError(f"not RAPID: {line}")


def _rapid_target(parts: list, X_KP: np.ndarray) -> Target:
    p, q, conf, externals = parts
    return Target(X_KT=X_KP @ of_quaternion(p, q), stands=tuple(conf), externals=tuple(v for v in externals if v < 9e9))


# ---- URScript


def read_urscript(files: Mapping[str, str], name: str) -> list[Read]:
    (text,) = files.values()
    found: list[Read] = []
    frames: dict[str, np.ndarray] = {}
    X_FT = X_NONE
    pose = r"p\[([^\]]*)\]"
    inside = waits = False
    for line in text.splitlines():
        code = line.partition("#")[0].strip()
        if m := re.fullmatch(r"while get_standard_digital_in\((\w+)\) != (True|False):", code):
            found.append(Read("await", signal=m[1], value=float(m[2] == "True")))
            waits = True
        elif waits:
            assert code in ("sync()", "end")
            waits = code != "end"
        elif m := re.fullmatch(r"CHANGE\((\d+)\)", code):
            found.append(Read("call", value=float(m[1])))
        elif code in (f"def {name}():", "end"):
            inside = code != "end"
        elif not code:
            continue
        elif code == f"{name}()":
            assert not inside
        elif m := re.fullmatch(rf"(frame_\d+) = {pose}", code):
            frames[m[1]] = of_vector([float(v) for v in m[2].split(",")])
        elif m := re.fullmatch(rf"set_tcp\({pose}\)", code):
            X_FT = of_vector([float(v) for v in m[1].split(",")])
        elif code.startswith("set_target_payload("):
            continue
        elif m := re.fullmatch(r"movej\(\[([^\]]*)\], a=1.4, v=([0-9.]+)(?:, t=[0-9.]+)?, r=([0-9.]+)\)", code):
            joints = np.array([float(v) for v in m[1].split(",")])
            found.append(Read("joint", to=Target(joints=joints), X_FT=X_FT, blend=float(m[3]), line=line_in(line)))
        elif code.startswith(("movel(", "movec(")):
            given = [
                Target(X_KT=frames[frame] @ of_vector([float(v) for v in values.split(",")]))
                for frame, values in re.findall(rf"pose_trans\((frame_\d+), {pose}\)", code)
            ]
            rest = re.search(r"v=([0-9.]+), r=([0-9.]+)", code)
            assert rest is not None and len(given) == (2 if code.startswith("movec") else 1)
            found.append(
                Read(
                    "circular" if len(given) == 2 else "linear",
                    to=given[-1],
                    via=given[0] if len(given) == 2 else None,
                    X_FT=X_FT,
                    speed=float(rest[1]),
                    blend=float(rest[2]),
                    line=line_in(line),
                )
            )
        elif m := re.fullmatch(r"set_standard_(?:digital|analog)_out\((\w+), (.*)\)", code):
            found.append(Read("set", signal=m[1], value=float({"True": 1, "False": 0}.get(m[2], m[2]))))
        elif m := re.fullmatch(r"sleep\((.*)\)", code):
            found.append(Read("wait", value=float(m[1])))
        elif code.startswith("popup("):
            found.append(Read("halt"))
        else:
            raise AssertionError(f"not URScript: {line}")
    return found


# ---- Fanuc


def read_fanuc_ls(files: Mapping[str, str], name: str) -> list[Read]:
    state: dict = {"UFRAME": {}, "UTOOL": {}, "UFRAME_NUM": 0, "UTOOL_NUM": 0, "PR": {}, "line": 0}
    return list(_fanuc(files, name, state))


def _fanuc_points(text: str) -> dict[int, dict]:
    points = {}
    for m in re.finditer(r"P\[(\d+)\]\{\s+GP1:\s+UF : (\d+), UT : (\d+),(.*?)\};", text, re.S):
        words = {w: float(v) for w, v in re.findall(rf"\b([A-Z]\d?)\s*=\s*({NUMBER}) (?:mm|deg)", m[4])}
        config = re.search(r"CONFIG : '(.*?)'", m[4])
        points[int(m[1])] = {"UF": int(m[2]), "UT": int(m[3]), "config": config[1] if config else "", **words}
    return points


def _fanuc(files: Mapping[str, str], name: str, state: dict) -> Iterator[Read]:
    text = files[f"{name}.ls"].replace("\r", "")
    points = _fanuc_points(text)
    body = text.partition("/MN\n")[2].partition("/POS")[0]
    count = re.search(r"LINE_COUNT = (\d+);", text)
    # an instruction may go on behind `:` in further lines of text; the semicolon ends it
    lines = re.findall(r"^ *(\d+):((?:[^;\n]*\n    :)?[^;\n]*?) *;$", body, re.M)
    assert sum(1 + text.count("\n") for _, text in lines) == body.count("\n")
    assert (
        count is not None and int(count[1]) == len(lines) and [int(n) for n, _ in lines] == [*range(1, len(lines) + 1)]
    )
    for _, line in lines:
        code = re.sub(r" *\n    : *", " : ", line.strip())
        if code.startswith("!"):
            state["line"] = line_in(code) or state["line"]
        elif m := re.fullmatch(r"PR\[99,(\d)\]=\(?(.*?)\)?", code):
            state["PR"]["XYZWPR"[int(m[1]) - 1]] = float(m[2])
        elif code == "PR[99]=LPOS":
            continue
        elif m := re.fullmatch(r"(UFRAME|UTOOL)\[(\d+)\]=PR\[99\]", code):
            state[m[1]][int(m[2])] = of_wpr(state["PR"])
        elif m := re.fullmatch(r"(UFRAME_NUM|UTOOL_NUM)=(\d+)", code):
            state[m[1]] = int(m[2])
        elif m := re.fullmatch(
            r"([JLC])(?: P\[(\d+)\] :)? P\[(\d+)\] ([0-9.]+)(mm/sec|cm/min|%|sec) (FINE|CNT\d+)", code
        ):
            assert (m[1] == "C") == (m[2] is not None), line
            point = points[int(m[3])]
            assert (point["UF"], point["UT"]) == (state["UFRAME_NUM"], state["UTOOL_NUM"])
            yield Read(
                {"J": "joint", "L": "linear", "C": "circular"}[m[1]],
                to=_fanuc_target(point, state),
                via=None if m[2] is None else _fanuc_target(points[int(m[2])], state),
                X_FT=state["UTOOL"][state["UTOOL_NUM"]],
                speed=float(m[4]) * {"mm/sec": 1e-3, "cm/min": 0.01 / 60}.get(m[5], 0.0),
                blend=0.0 if m[6] == "FINE" else math.inf,
                line=state["line"],
            )
        elif m := re.fullmatch(r"(?:DO|AO)\[(\w+)\]=(.*)", code):
            yield Read("set", signal=m[1], value=float({"ON": 1, "OFF": 0}.get(m[2], m[2])))
        elif m := re.fullmatch(r"WAIT (.*)\(sec\)", code):
            yield Read("wait", value=float(m[1]))
        elif m := re.fullmatch(r"WAIT DI\[(\w+)\]=(ON|OFF)", code):
            yield Read("await", signal=m[1], value=float(m[2] == "ON"))
        elif m := re.fullmatch(r"CALL CHANGE\((\d+)\)", code):
            yield Read("call", value=float(m[1]))
        elif code == "PAUSE":
            yield Read("halt")
        elif m := re.fullmatch(r"CALL (\w+)", code):
            yield from _fanuc(files, m[1], state)
        else:
            raise AssertionError(f"not a line of Fanuc: {line}")


def _fanuc_target(point: dict, state: dict) -> Target:
    externals = tuple(point[f"E{k}"] for k in range(1, 4) if f"E{k}" in point)
    if "J1" in point:
        q = np.radians([point[f"J{k}"] for k in range(1, 7)])
        q[2] += q[1]  # the control counts joint 3 from the horizontal
        return Target(joints=q, externals=externals)
    letters, _, turns = point["config"].partition(", ")
    stands = (*letters.split(), *(int(t) for t in turns.split(", ")))
    return Target(X_KT=state["UFRAME"][point["UF"]] @ of_wpr(point), stands=stands, externals=externals)


READERS = {"krl": read_krl, "rapid": read_rapid, "urscript": read_urscript, "fanuc-ls": read_fanuc_ls}
