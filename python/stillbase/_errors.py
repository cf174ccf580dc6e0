"""Errors of stillbase as exceptions."""

from __future__ import annotations

from typing import Any, Iterable, NamedTuple


class Finding(NamedTuple):
    """One thing wrong with an input, printed as `file:line: rule: message`."""

    file: str  #: as the user named it
    line: int  #: 1-based; 0: the file as a whole, or an object of Python
    rule: str  #: short name of the broken rule, e.g. "unknown-key"
    message: str  #: key, value, what is allowed


class InputError(ValueError):
    """A file, dict or keyword was refused; `findings` has everything wrong with it.

    `file`, `line`, `rule` and `message` are those of the first finding.
    """

    def __init__(self, text: str, findings: Iterable[tuple[str, int, str, str]]) -> None:
        self.findings = tuple(Finding(*finding) for finding in findings)
        super().__init__(text, self.findings)

    def __str__(self) -> str:
        return str(self.args[0])

    @property
    def file(self) -> str:
        """File of the first finding, as the user named it."""
        return self.findings[0].file

    @property
    def line(self) -> int:
        """Line of the first finding, 1-based; 0: the file as a whole, or an object of Python."""
        return self.findings[0].line

    @property
    def rule(self) -> str:
        """Rule of the first finding."""
        return self.findings[0].rule

    @property
    def message(self) -> str:
        """Text of the first finding: key, value, what is allowed."""
        return self.findings[0].message


class FileError(OSError):
    """A file could not be read or written."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a long call; `result` is what it had found until then."""

    def __init__(self, result: Any) -> None:
        super().__init__("interrupted; the result so far is in `result`")
        self.result = result
