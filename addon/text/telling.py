# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages in the user's language: reports, errors, reasons, status texts, hints.

Below the interface every message is English, with its numbers and names in it: it is raised as an error, kept in a
file, printed by the command line. Where it is shown, `told` looks for the template that it was made from. A template is
an entry of `translations.LANGUAGES` with a `{}` for each value, exactly as the source has it (an f-string of Python, a
`write!` of Rust); its translation numbers the values, `{0}`, `{1}`, since their order may change. A test holds the
templates to be complete and each to be found again from what it makes.

Values are translated too where they are entries themselves ("outline", "3 bodies"); what stands in single quotes is a
name and stays. What no template fits is a list: its lines, or its parts between "; ", ": " and ", ", are told apart.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache

import bpy

from .translations import LANGUAGES

_NAME = re.compile(r"(?<![^\W_])'(.*?)'(?![^\W_])", re.DOTALL)
"""A name in single quotes; an apostrophe inside a word is none."""

_PIECES = re.compile(rf"({_NAME.pattern.replace('(.*?)', '.*?')}|\{{\}})", re.DOTALL)
"""The values and names of a template."""

_KEPT = re.compile("\0[0-9]+\0")
"""A name that was put aside."""

_SEPARATOR = re.compile("\n|; |: |, ")


def told(text: str, of: str = "reports") -> str:
    """Return a message in the user's language; English where that has no translations or the user wants none.

    of : what the message is, of Blender's preferences: "reports", "interface" or "tooltips".
    """
    locale = bpy.app.translations.locale
    if locale not in LANGUAGES or not getattr(bpy.context.preferences.view, f"use_translate_{of}"):
        return text
    return translate(text, locale)


@lru_cache(maxsize=512)
def translate(text: str, locale: str) -> str:
    """Return a message in a language of `LANGUAGES`."""
    names: list[str] = []

    def put_aside(found: re.Match[str]) -> str:
        names.append(found.group(1))
        return f"'\0{len(names) - 1}\0'"

    said = _translated(_NAME.sub(put_aside, text), locale)
    return _KEPT.sub(lambda found: names[int(found.group(0)[1:-1])], said)


def _translated(text: str, locale: str) -> str:
    """Translate what has its names put aside."""
    said = _by_template(text, locale)
    if said is not None:
        return said
    cuts = [(cut.start(), cut.end()) for cut in _SEPARATOR.finditer(text)]
    if not cuts:
        return text
    # A sentence may have separators of its own: the longest end, or else the longest beginning, that is known.
    for end, start in cuts:
        said = _by_template(text[start:], locale)
        if said is not None:
            return _translated(text[:end], locale) + text[end:start] + said
    for end, start in reversed(cuts):
        said = _by_template(text[:end], locale)
        if said is not None:
            return said + text[end:start] + _translated(text[start:], locale)
    end, start = cuts[0]
    return text[:end] + text[end:start] + _translated(text[start:], locale)


def _by_template(text: str, locale: str) -> str | None:
    """Translate by the entry that fits the whole text; None if there is none."""
    entries, templates = _entries(locale)
    forms = dict.fromkeys((text, text[:1].lower() + text[1:], text[:1].upper() + text[1:]))
    said = next((entries[form] for form in forms if form in entries), None)
    if said is None:
        # The template with the most of its own, however the message begins: short ones fit nearly anything.
        found = [match for match in (_match(form, templates) for form in forms) if match is not None]
        if not found:
            return None
        _, values, template = max(found, key=lambda match: match[0])
        said = template.format(*(_value(value, locale) for value in values))
    return said[:1].upper() + said[1:] if text[:1].isupper() else said


def _match(
    text: str, templates: list[tuple[re.Pattern[str], str, int]]
) -> tuple[int, tuple[str, ...], str] | None:
    """Return the length of the first template that fits the whole text, the values in it, and its translation."""
    for pattern, template, length in templates:
        found = pattern.fullmatch(text)
        if found is not None:
            return length, found.groups(), template
    return None


def _value(text: str, locale: str) -> str:
    """Translate a value of a template; numbers and names stay."""
    if not any(char.isalpha() for char in text):
        return text
    return _translated(text, locale)


@cache
def _entries(locale: str) -> tuple[dict[str, str], list[tuple[re.Pattern[str], str, int]]]:
    """Texts without values, and patterns of those with values: those with the most of their own first."""
    made = LANGUAGES[locale]
    templates = sorted((text for text in made if _PIECES.search(text)), key=lambda text: (-len(text), text))
    plain = {text: said for text, said in made.items() if text not in templates}
    return plain, [(_pattern(text), made[text], len(text)) for text in templates]


def _pattern(template: str) -> re.Pattern[str]:
    """Pattern of what a template makes, names put aside."""
    parts = []
    for piece in _PIECES.split(template):
        if piece == "'{}'":
            parts.append("'(\0[0-9]+\0)'")
        elif _NAME.fullmatch(piece):
            parts.append("'\0[0-9]+\0'")
        elif piece == "{}":
            parts.append("(.+?)")
        else:
            parts.append(re.escape(piece))
    return re.compile("".join(parts), re.DOTALL)
