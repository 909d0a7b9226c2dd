"""What is shipped must go with the licence of the extension: every crate that is linked, by its own declaration."""

import json
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# Compatible with GPL 3, under which the extension is shipped.
ALLOWED = {
    *("MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "ISC", "Zlib", "Unlicense", "Unicode-3.0"),
    *("CC0-1.0", "0BSD", "BSL-1.0", "MPL-2.0", "Apache-2.0 WITH LLVM-exception"),
}


def allows(expression):
    """Whether one of the choices of an SPDX expression, or of its old form with slashes, is allowed whole."""
    tokens = re.findall(r"\(|\)|[^()\s]+(?:\s+WITH\s+[^()\s]+)?", expression.replace("/", " OR "))

    def either():
        value = both()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            value = both() or value
        return value

    def both():
        value = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            value = one() and value
        return value

    def one():
        token = tokens.pop(0)
        if token != "(":
            return " ".join(token.split()) in ALLOWED
        value = either()
        assert tokens.pop(0) == ")"
        return value

    value = either()
    assert not tokens, expression
    return value


def test_expressions_are_read():
    assert allows("MIT")
    assert allows("GPL-2.0-only OR MIT")
    assert allows("MIT/Apache-2.0")
    assert allows("(MIT OR GPL-2.0-only) AND Unicode-3.0")
    assert allows("Apache-2.0 WITH LLVM-exception OR Proprietary")
    assert not allows("MIT AND GPL-2.0-only")
    assert not allows("(MIT OR Zlib) AND Proprietary")


def test_every_crate_has_a_licence_that_goes_with_the_extensions():
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    crates = json.loads(answer.stdout)["packages"]
    assert {"faer", "gridmesh", "spade"} <= {crate["name"] for crate in crates}
    wrong = {crate["name"]: crate["license"] for crate in crates if not allows(crate["license"] or "none")}
    assert not wrong
