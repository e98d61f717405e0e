"""Sentences that can be translated: a template and its arguments, English by default."""

from __future__ import annotations

from typing import Any


class Text(str):
    """A sentence that remembers how it was made.

    It *is* the English sentence (a ``str``) and carries ``template`` and ``arguments``, so the application
    can translate the template at the border and fill in the arguments again.

    >>> t = Text("{count} of {total} photos oriented", count=11, total=12)
    >>> str(t), t.template
    ('11 of 12 photos oriented', '{count} of {total} photos oriented')
    """

    template: str
    arguments: dict[str, Any]

    def __new__(cls, template: str, **arguments: Any) -> Text:
        made = super().__new__(cls, template.format(**arguments) if arguments else template)
        made.template = template
        made.arguments = arguments
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return _remake, (self.template, self.arguments)


def _remake(template: str, arguments: dict[str, Any]) -> Text:
    return Text(template, **arguments)
