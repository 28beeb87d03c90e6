"""One entry of the catalogue of findings."""

from dataclasses import dataclass

from gcodesim.diagnostics.finding import Severity


@dataclass(frozen=True, slots=True, kw_only=True)
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
