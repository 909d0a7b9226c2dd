"""What the reviewers of an extension platform look at is told, module by module, in docs/releasing.md."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
MODULES = {"ctypes", "mmap", "shutil", "socket", "subprocess", "tempfile", "urllib", "multiprocessing"}
CALLS = {"open", "read_bytes", "read_text", "write_bytes", "write_text", "rename"}


def uses(source: str) -> set[str]:
    """Return which of the things that reviewers ask about stand in a source text."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Name) and node.id == "__file__":
            found.add("__file__")
        if isinstance(node, ast.Import):
            found |= {name.name.partition(".")[0] for name in node.names} & MODULES
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            found |= {node.module.partition(".")[0]} & MODULES
        if isinstance(node, ast.Call):
            called = node.func
            name = called.id if isinstance(called, ast.Name) else getattr(called, "attr", "")
            if name in CALLS or (name == "unlink" and not node.args):
                found.add("files")
            if name in {"eval", "exec", "compile"} and isinstance(called, ast.Name):
                found.add(name)
    return found


def told() -> dict[str, set[str]]:
    """Return the table of docs/releasing.md: what each module is said to use."""
    text = (ROOT / "docs" / "releasing.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(addon/[\w/]+\.py)` \| (.+?) \| (.+?) \|$", text, re.MULTILINE)
    assert all(reason.strip() for _, _, reason in rows)
    return {module: set(re.findall(r"`?(\w+)`?", used)) for module, used, _ in rows}


def test_uses_are_found():
    source = "import subprocess\nfrom pathlib import Path\nx = Path(__file__).read_text()\neval('1')\n"
    assert uses(source) == {"subprocess", "__file__", "files", "eval"}
    assert uses("from . import files\nfiles.listed()\nimport math\n") == set()


def test_every_use_of_files_and_processes_has_its_reason():
    found = {}
    for path in sorted((ROOT / "addon").rglob("*.py")):
        used = uses(path.read_text(encoding="utf-8"))
        if used:
            found[path.relative_to(ROOT).as_posix()] = used
    assert found == told()
