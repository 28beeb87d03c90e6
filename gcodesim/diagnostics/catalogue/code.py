"""One entry of the catalogue of findings."""

from __future__ import annotations

from gcodesim.diagnostics.finding import Severity
from gcodesim.frozen import frozen


@frozen
class Code:
    """A code's page in `gcodesim explain`.

    `title` names the fault in a few words, `what` says what it means, `why`
    why it matters on the shop floor, `remedy` what to do.
    """

    code: str
    severity: Severity
    title: str
    what: str
    why: str
    remedy: str
