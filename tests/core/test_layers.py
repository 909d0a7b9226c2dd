"""The layers of docs/architecture.md, kept by reading what each module imports."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

LIBRARY, ADDON = ROOT / "rust" / "gridmesh" / "src", ROOT / "addon"

LAYERS = {
    "lattice": 0,
    "geometry": 1,
    "drawing": 1,
    "picture": 1,
    "path": 1,
    "bend": 1,
    "relax": 1,
    "sketch": 2,
    "patch": 2,
    "body": 2,
    "cover": 2,
    "cutout": 2,
    "fill": 2,
    "cut": 2,
    "join": 2,
    "svg": 2,
}
OF_NO_LAYER = {"lib", "error", "progress", "options"}

BLENDER = {"bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "blf", "bpy_extras", "bl_ui"}
WITHOUT_BLENDER = {
    "api",
    "native",
    "bodies/nesting",
    "bodies/outlines",
    "bodies/sampling",
    "bodies/density",
    "fill/holes",
    "fill/patches",
    "fill/creases",
    "cut/cutsweep",
    "cut/cutting",
    "cut/cutextension",
    "cut/cutcorners",
    "cut/drawnline",
    "join/uniting",
    "data/attributes",
    "data/defaults",
    "cli/params",
    "draw/gesture",
    "draw/steady",
    "draw/trace",
    "draw/decision",
    "draw/memory",
    "draw/parts",
    "draw/regions",
    "draw/fewer",
    "live/solve",
    "overlay/quality",
    "regrid/carried",
    "pictures/cutouts",
    "pictures/formats/gltf",
    "pictures/formats/godot",
    "pictures/formats/rig",
    "pictures/formats/sheet",
    "pictures/formats/spine",
    "text/messages",
}


# ----------------------------------------------------------------------------------------------- reading


@cache
def rust_modules():
    """Path of each module of the library: its own code, without comments and tests."""
    found = {}
    for file in sorted(LIBRARY.rglob("*.rs")):
        if file.stem.endswith("_tests"):
            continue
        text = re.sub(r"//[^\n]*", "", file.read_text())
        own = re.split(r"#\[cfg\(test\)\]\n(?:pub\(super\) )?mod ", text)[0]
        found["/".join(file.relative_to(LIBRARY).with_suffix("").parts)] = own
    return found


def paths_of(tree):
    """The single paths of a `use` tree: `a::{b, c::d}` is a::b and a::c::d."""
    inner = re.match(r"(.*?)\{(.*)\}$", tree, re.DOTALL)
    if inner is None:
        return [tree.split(" as ")[0].strip()]
    depth, parts, start = 0, [], 0
    body = inner[2] + ","
    for at, letter in enumerate(body):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            parts.append(body[start:at].strip())
            start = at + 1
    return [inner[1].strip() + path for part in parts if part for path in paths_of(part)]


def rust_imports(modules):
    """Module: modules of the library that it names."""
    result = {}
    for name, text in modules.items():
        own = name.split("/")
        text = re.sub(r"pub\(in [\w:]+\)", "pub", text)
        used = [
            path
            for tree in re.findall(r"\buse\s+([^;]+);", text)
            for path in paths_of(" ".join(tree.split()))
        ]
        used += re.findall(r"\b(?:crate|super)(?:::\w+)+", text)
        found = set()
        for path in used:
            parts = path.split("::")
            if parts[0] == "crate":
                parts = parts[1:]
            elif parts[0] == "self":
                parts = own + parts[1:]
            elif parts[0] == "super":
                ups = sum(part == "super" for part in parts)
                parts = own[: len(own) - ups] + parts[ups:]
            else:
                parts = own + parts
            for n in range(len(parts), 0, -1):
                if "/".join(parts[:n]) in modules:
                    found.add("/".join(parts[:n]))
                    break
        result[name] = found - {name, "lib"}
    return result


@cache
def python_imports(*, always):
    """Module of the extension: what it imports of the others, and whether it imports Blender.

    always : also what is imported within functions.
    """
    files = {}
    for file in sorted(ADDON.rglob("*.py")):
        parts = file.relative_to(ADDON).with_suffix("").parts
        if parts[0] != "presets":
            files["/".join(parts).removesuffix("/__init__")] = file
    result, blender = {}, set()
    for name, file in files.items():
        package = name.split("/") if file.stem == "__init__" else name.split("/")[:-1]
        package = [] if name == "__init__" else package
        tree = ast.parse(file.read_text())
        found = set()
        for node in ast.walk(tree) if always else tree.body:
            if isinstance(node, ast.Import):
                blender |= {name} if {a.name.split(".")[0] for a in node.names} & BLENDER else set()
            elif isinstance(node, ast.ImportFrom) and not node.level:
                blender |= {name} if node.module.split(".")[0] in BLENDER else set()
            elif isinstance(node, ast.ImportFrom):
                base = package[: len(package) - (node.level - 1)] + (node.module or "").split(".")
                base = [part for part in base if part]
                for alias in node.names:
                    whole = "/".join([*base, alias.name])
                    found.add(whole if whole in files else "/".join(base) or "__init__")
        result[name] = found - {name}
    return result, blender


def circle_of(imports):
    """A circle of imports, or nothing."""
    done, path = set(), []

    def visit(name):
        if name in path:
            return [*path[path.index(name) :], name]
        if name in done:
            return None
        path.append(name)
        for other in sorted(imports.get(name, ())):
            if circle := visit(other):
                return circle
        path.pop()
        done.add(name)
        return None

    return next(filter(None, map(visit, sorted(imports))), None)


# ------------------------------------------------------------------------------------------------- tests


def test_the_readers_read():
    assert paths_of("a::{b, c::{d as e, f}}") == ["a::b", "a::c::d", "a::c::f"]
    assert circle_of({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]
    imports = rust_imports(rust_modules())
    assert "geometry/segments" in imports["drawing/symmetry"]
    assert "lattice/axial" in imports["lattice/dir"]
    assert sum(map(len, imports.values())) > 300


def test_library_modules_use_their_own_layer_and_those_below():
    wrong = []
    for name, others in rust_imports(rust_modules()).items():
        for other in others:
            a, b = name.split("/")[0], other.split("/")[0]
            if a not in OF_NO_LAYER and b not in OF_NO_LAYER and LAYERS[b] > LAYERS[a]:
                wrong.append(f"{name} uses {other}")
            if a in OF_NO_LAYER - {"lib"} and b not in OF_NO_LAYER:
                wrong.append(f"{name}, which belongs to no layer, uses {other}")
    assert not wrong


def test_every_folder_of_the_library_has_a_layer_and_nothing_lies_beside_them():
    assert {name.split("/")[0] for name in rust_modules()} == LAYERS.keys() | OF_NO_LAYER


def test_no_import_circle_in_the_library():
    assert circle_of(rust_imports(rust_modules())) is None


def test_no_float_in_the_lattice():
    texts = {name: text for name, text in rust_modules().items() if name.split("/")[0] == "lattice"}
    assert len(texts) > 5
    assert not [name for name, text in texts.items() if re.search(r"\b(f32|f64|DVec\w*|\d+\.\d+)\b", text)]


def test_no_import_circle_in_the_extension():
    imports, _ = python_imports(always=False)
    assert circle_of(imports) is None


@pytest.mark.parametrize("name", sorted(WITHOUT_BLENDER))
def test_modules_of_numbers_know_nothing_of_blender(name):
    imports, blender = python_imports(always=True)
    assert name not in blender
    assert not (imports[name] & blender), "it uses a module that imports Blender"


def test_work_can_be_called_without_operators():
    imports, _ = python_imports(always=True)
    operators = {
        name for name in imports if name.split("/")[-1] in ("operator", "draw_operator", "weights_operator")
    }
    assert len(operators) >= 4
    allowed = operators | {"__init__", "ui/panels", "ui/keys"}
    users = {name for name, others in imports.items() if others & operators}
    assert all(
        name in allowed or name.startswith(("draw/", "live/ui")) or name == "cut/tool" for name in users
    ), users - allowed


def test_only_what_every_reader_needs_first_lies_in_the_extension_itself():
    assert {file.stem for file in ADDON.glob("*.py")} == {"__init__", "__main__", "api", "native"}
