"""Every message that a user can read is told in the user's language, and is found there."""

import ast
import re

import bpy
import pytest
from conftest import ROOT

from addon.text import messages, translations
from addon.text.telling import told, translate

ADDON, LIBRARY = ROOT / "addon", ROOT / "rust" / "gridmesh" / "src"

TABLES = {"translations.py", "german_messages.py"}

# Literals with a space that no user reads.
NOT_SHOWN = {
    "Base Color",  # sockets of Blender's
    "Emission Color",
    "Emission Strength",
    "Specular IOR Level",
    "GridMesh Profile",  # names of data
    "{} Bodies",
    "{} Outline",
    "GridMesh Outline",
    "the other outline",  # put in other words in errors of the library
    "the outline",
    "the stroke",
    "GridMesh: {}",  # printed, beside what is shown
    "Grease Pencil Edit Mode",  # keymaps of Blender's, translated by it
    "Grease Pencil Paint Mode",
    "Object Mode",
    "-1 where lattices have no say",  # hidden properties, for scripts
    "{} numbers are no table of three columns",  # an error of scripts
    "irregular vertex",  # nouns, told with their numbers
    "irregular vertices",
    "pair of loops",
    "pairs of loops",
}

# Literals of the library that are no part of an error: debugging, and points in brackets.
INTERNAL = {
    " + ",
    ", ",
    "broken link from {} to {}: {}",
    "the path reverses at {}",
    "the {} is wrong",
    "turn sum",
    "{}, {}",
    "({}, {}), ({}, {})",
}

TOLD = {"report": 1, "status_text_set": 0, "header_text_set": 0, "poll_message_set": 0}
"""What shows a text, and which argument that is."""


def sources():
    for path in sorted(ADDON.rglob("*.py")):
        if path.name not in TABLES and not {"cli", "formats"} & set(path.parts):
            yield path.relative_to(ADDON).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def template_of(node):
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)


def literals(tree):
    """Templates of all texts in code, without docstrings, and the nouns of numbers."""
    aside = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            aside.add(node.value)
        elif isinstance(node, ast.JoinedStr):
            aside.update(node.values)
            aside.update(value.format_spec for value in node.values if isinstance(value, ast.FormattedValue))
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "counted":
            noun = node.args[1]
            aside.add(noun)
            for one in ast.walk(noun):
                if isinstance(one, ast.Constant):
                    for number in (1, 2):
                        yield "{}" + messages.counted(number, one.value)[1:]
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr | ast.Constant) and node not in aside:
            whole = template_of(node)
            # A message of several lines is told line by line.
            for text in whole.split("\n") if isinstance(node, ast.JoinedStr) else [whole]:
                if re.search(r"[^\W\d_]{2}", text) and " " in text.strip():
                    yield text.strip()


def library_literals():
    """Templates of all texts with a space in the library that its tests and assertions do not own."""
    text = re.compile(r'"((?:[^"\\]|\\.|\\\n)*)"')
    for path in sorted(LIBRARY.rglob("*.rs")):
        if re.search("oracle|tests|svg", path.as_posix()):
            continue
        code = re.split(
            r"#\[cfg\(test\)\]\s*(?:pub\(super\) )?mod tests \{", path.read_text(encoding="utf-8")
        )[0]
        code = re.sub(r"//[^\n]*", "", code)
        code = re.sub(r"#!?\[(?!error)(?:[^\[\]]|\[[^\]]*\])*\]", "", code)
        code = re.sub(r"(?:debug_)?assert\w*!\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)", "", code)
        for found in text.finditer(code):
            one = re.sub(r"\\\n\s*", "", found.group(1)).replace('\\"', '"')
            if " " in one:
                yield re.sub(r"\{[^}]*\}", "{}", one).removesuffix("; ")


def own_words():
    """Messages without a space that are told somewhere, and things that errors of the library name."""
    nouns = {f"{{}} {noun}" for noun in ("body", "bodies", "sheet", "sheets")}
    return nouns | {"cancelled", "fill", "inflation", "loop", "mesh", "outline", "stroke", "values"}


def all_messages():
    found = {text for _, tree in sources() for text in literals(tree)} - NOT_SHOWN
    found |= set(library_literals()) - INTERNAL
    return found | own_words()


@pytest.mark.parametrize("locale", translations.LANGUAGES)
def test_every_message_is_in_every_language(locale):
    missing = {}
    for name, tree in sources():
        for text in set(literals(tree)) - NOT_SHOWN - translations.LANGUAGES[locale].keys():
            missing.setdefault(name, []).append(text)
    assert missing == {}
    assert sorted(set(library_literals()) - INTERNAL - translations.LANGUAGES[locale].keys()) == []


def test_every_text_that_is_shown_is_told():
    bare = []
    for name, tree in sources():
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
                continue
            shown = [node.args[TOLD[node.func.attr]]] if node.func.attr in TOLD and node.args else []
            if node.func.attr == "label":  # constants are translated by Blender
                given = [keyword.value for keyword in node.keywords if keyword.arg == "text"]
                shown = [value for value in given if not isinstance(value, ast.Constant)]
                shown += node.args[2:3]  # of what is wrapped into lines
                if any(
                    keyword.arg == "translate" for keyword in node.keywords
                ):  # names, and lines of what is told
                    shown = []
            for value in shown:
                if isinstance(value, ast.Constant) and value.value is None:
                    continue
                if not (isinstance(value, ast.Call) and ast.unparse(value.func) == "told"):
                    bare.append(f"{name}:{node.lineno}: {ast.unparse(value)}")
    assert bare == []


def test_sentences_are_whole():
    """No word is chosen inside a text, and no two values stand side by side: then its parts can be told apart."""
    broken = []
    for name, tree in sources():
        for node in ast.walk(tree):
            if not isinstance(node, ast.JoinedStr):
                continue
            values = [part for part in node.values if isinstance(part, ast.FormattedValue)]
            chosen = any(
                isinstance(inner, ast.IfExp) and isinstance(inner.body, ast.Constant)
                for value in values
                for inner in ast.walk(value.value)
            )
            text = template_of(node)
            if (chosen or "{}{}" in text) and " " in text:
                broken.append(f"{name}:{node.lineno}: {text}")
    assert broken == []


@pytest.mark.parametrize("locale", translations.LANGUAGES)
def test_each_template_is_found_again_from_what_it_makes(locale):
    """With numbers and names of every kind in it, names that look like messages too."""
    names = ["Tom's hat", "outline", "a: b; c", "3 bodies"]
    for english, other in translations.LANGUAGES[locale].items():
        at = [found.start() for found in re.finditer(r"\{\}", english)]
        values = [
            names[k % len(names)]
            if english[i - 1 : i] == "'" and english[i + 2 : i + 3] == "'"
            else f"{1.5 + k:g}"
            for k, i in enumerate(at)
        ]
        assert translate(english.format(*values), locale) == other.format(*values)
        # Reports begin with a capital.
        capital, said = (text.format(*values) for text in (english, other))
        assert translate(capital[:1].upper() + capital[1:], locale) in (said, said[:1].upper() + said[1:])
        assert sorted(set(re.findall(r"\{(\d*)\}", other))) == sorted({str(k) for k in range(len(at))})


def test_messages_made_of_messages():
    said = translate(
        "'outline', stroke 1 of 2: it is open: its ends are 0.3 apart; make the stroke cyclic or raise "
        "Close Gaps from 0.20 to 0.30",
        "de_DE",
    )
    assert said == (
        "'outline', Strich 1 von 2: er ist offen: seine Enden sind 0.3 voneinander entfernt; den Strich zyklisch machen "
        "oder „Lücken schließen“ von 0.20 auf 0.30 erhöhen"
    )
    said = translate(
        "2 strokes left out:\nThe hole 3 has 2 distinct points; at least 3 are needed, draw a closed shape\n"
        "... and 4 more",
        "de_DE",
    )
    assert said == (
        "2 Striche weggelassen:\nLoch 3: 2 verschiedene Punkte; mindestens 3 sind nötig, eine geschlossene Form zeichnen\n"
        "... und 4 weitere"
    )
    assert translate("Words that nobody knows: 'mesh'", "de_DE") == "Words that nobody knows: 'mesh'"


def test_english_stays_where_it_is_wanted(monkeypatch):
    text = "2 bodies"
    assert told(text) == text
    assert "de_DE" in translations.LANGUAGES
    view = bpy.context.preferences.view
    for of in ("reports", "interface", "tooltips"):
        assert hasattr(view, f"use_translate_{of}")
