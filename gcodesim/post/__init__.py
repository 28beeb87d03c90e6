"""What was checked, as a program of the control that will run it; `LANGUAGES[kind]` is the class."""

from typing import Any

from gcodesim.family import Family

_NOT_WORDS: dict[str, Any] = {"fanuc-ls": "gcodesim.post.fanuc_ls:FanucLs"}

LANGUAGES = Family(
    "posts",
    of="gcodesim.post.language:RobotLanguage",
    called="kind",
    krl="gcodesim.post.krl:Krl",
    rapid="gcodesim.post.rapid:RapidCode",
    urscript="gcodesim.post.urscript:UrScript",
    **_NOT_WORDS,
)

__all__ = ["LANGUAGES"]
