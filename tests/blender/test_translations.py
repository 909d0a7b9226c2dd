"""Every text of the interface is in every language, and no language has texts that are nowhere."""

import ast

import bpy
import pytest
from conftest import ROOT
from test_messages import all_messages

import addon
from addon.text import translations
from addon.ui import keys, preset_files

ADDON = ROOT / "addon"

# Texts of Blender's own, which it translates itself, and names.
OWN = {"GridMesh", "X", "Y", "Z"}


def of_classes():
    for cls in addon._classes():
        rna = cls.bl_rna
        if issubclass(cls, bpy.types.Operator):
            group, name = cls.bl_idname.split(".")
            rna = getattr(getattr(bpy.ops, group), name).get_rna_type()
            yield rna.description
        yield getattr(cls, "bl_label", "")  # property groups have none
        if issubclass(cls, (bpy.types.Operator, bpy.types.PropertyGroup, bpy.types.AddonPreferences)):
            for option in rna.properties:
                if option.identifier in {"rna_type", "name", "bl_idname"} or option.is_hidden:
                    continue
                yield from (option.name, option.description)
                for item in getattr(option, "enum_items_static", ()):
                    yield from (item.name, item.description)


def of_layouts():
    """Literal texts that are drawn, or translated before they are shown."""
    for path in sorted(ADDON.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and any(
                "WorkSpaceTool" in ast.unparse(base) for base in node.bases
            ):
                yield from of_tool(node)
            if isinstance(node, ast.Call):
                if ast.unparse(node.func).endswith(("pgettext_iface", "pgettext_tip")):
                    literals = (
                        part.value for part in ast.walk(node.args[0]) if isinstance(part, ast.Constant)
                    )
                    yield from literals
                if ast.unparse(node.func).endswith(
                    "Property"
                ):  # those that are put on Blender's own types too
                    hidden = "HIDDEN" in ast.unparse(node)
                    said = (
                        keyword.value for keyword in node.keywords if keyword.arg in {"name", "description"}
                    )
                    yield from (text.value for text in said if isinstance(text, ast.Constant) and not hidden)
                for keyword in node.keywords:
                    if keyword.arg == "text" and isinstance(keyword.value, ast.Constant):
                        yield keyword.value.value


def of_tool(node):
    """Name and description of a tool; tools are no classes of Blender's."""
    for line in node.body:
        if isinstance(line, ast.Assign) and ast.unparse(line.targets[0]) in {"bl_label", "bl_description"}:
            yield ast.literal_eval(line.value)


def of_presets():
    for folder in preset_files.FOLDER.iterdir():
        yield from preset_files.shipped(folder.name)


def texts():
    """Labels, names and tooltips; messages have tests of their own."""
    found = {*of_classes(), *of_layouts(), *of_presets()}
    return {text for text in found if text and text not in OWN}


@pytest.mark.parametrize("locale", translations.LANGUAGES)
def test_every_text_is_translated(locale):
    assert sorted(texts() - translations.LANGUAGES[locale].keys()) == []


@pytest.mark.parametrize("locale", translations.LANGUAGES)
def test_no_text_is_translated_that_is_nowhere(locale):
    assert sorted(translations.LANGUAGES[locale].keys() - texts() - all_messages()) == []


@pytest.mark.parametrize("locale", translations.LANGUAGES)
def test_translations_keep_the_rules_of_texts(locale):
    for english, other in translations.LANGUAGES[locale].items():
        assert other.strip() == other != ""
        assert english.endswith(".") == other.endswith(".")


def test_blender_knows_them():
    table = translations.table()
    assert table["de_DE"]["Operator", "Strokes to Mesh"]
    assert table["de_DE"]["*", "Close Gaps"]
    translations.unregister()
    translations.unregister()
    translations.register()


def test_words_of_blender_do_not_come_before_ours():
    """ "Triangles" was "Triangulieren" in German, a verb: Blender's word for something else."""
    table = translations.table()["de_DE"]
    for cls in addon._classes():
        if not issubclass(cls, (bpy.types.Operator, bpy.types.PropertyGroup)):
            continue
        rna = cls.bl_rna
        if issubclass(cls, bpy.types.Operator):
            group, name = cls.bl_idname.split(".")
            rna = getattr(getattr(bpy.ops, group), name).get_rna_type()
        for option in rna.properties:
            if option.identifier in {"rna_type", "name", "bl_idname"} or option.is_hidden:
                continue
            assert option.translation_context == translations.CONTEXT, f"{cls.__name__}.{option.identifier}"
            assert option.name in OWN or (option.translation_context, option.name) in table


@pytest.mark.parametrize("idname", [folder.name for folder in preset_files.FOLDER.iterdir()])
def test_presets_run_and_set_options_that_exist(idname):
    group, name = idname.split(".")
    rna = getattr(getattr(bpy.ops, group), name).get_rna_type()
    for file in (preset_files.FOLDER / idname).glob("*.py"):
        label = bpy.path.display_name(file.stem, has_ext=False)
        for option, value in preset_files.shipped(idname)[label].items():
            known = rna.properties[option]
            if known.type == "ENUM":
                assert value in known.enum_items.keys()  # noqa: SIM118
    assert bpy.utils.preset_paths("operator").count(str(preset_files.FOLDER)) == 1


def test_no_shortcut_is_taken():
    items = [
        item
        for keymap in bpy.context.window_manager.keyconfigs.addon.keymaps
        if not keymap.name.startswith("3D View Tool")  # only while the tool is chosen in the toolbar
        for item in keymap.keymap_items
        if "gridmesh" in item.idname
    ]
    assert {item.idname for item in items} == {idname for _, idname in keys.ENTRIES}
    assert len(items) == len(keys.ENTRIES)
    assert {item.type for item in items} == {"NONE"}
