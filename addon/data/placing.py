# SPDX-License-Identifier: GPL-3.0-or-later
"""New data blocks: all of them or none, and the collections that they go to."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import bpy


class Transaction:
    """Data blocks made so far; all are removed again if the work is not finished."""

    def __init__(self) -> None:
        self._made: list[tuple[Any, bpy.types.ID]] = []
        self.notes: list[str] = []
        """What the user should know of choices made on the way."""

    def __enter__(self) -> Transaction:
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        if kind is not None:
            for collection, block in reversed(self._made):
                with suppress(ReferenceError):  # with a mesh go the objects that have it
                    collection.remove(block)

    def new(self, collection: Any, *arguments: Any) -> Any:
        """Make a data block with `collection.new` and remember it."""
        return self.remember(collection, collection.new(*arguments))

    def remember(self, collection: Any, block: Any) -> Any:
        """Remember a data block that was made in another way."""
        self._made.append((collection, block))
        return block


def home(context: bpy.types.Context, transaction: Transaction) -> bpy.types.Collection:
    """Return the active collection, or one around it that is shown: new objects are never out of sight."""
    return Collections(context, transaction, "ACTIVE").of("")


class Collections:
    """Where new objects go. A new collection is made with the first object that needs it."""

    def __init__(self, context: bpy.types.Context, transaction: Transaction, choice: str):
        self.context, self.transaction, self.choice = context, transaction, choice
        self.usable = set(_usable(context.view_layer.layer_collection))
        self.made: bpy.types.Collection | None = None

    def of(self, source: str) -> bpy.types.Collection:
        """Return the collection for what is made of the object named `source`."""
        if self.choice == "ACTIVE":
            return self._active()
        beside = self._beside(source)
        if self.choice == "SOURCE":
            return beside
        if self.made is None:
            self.made = self.transaction.new(bpy.data.collections, f"{source} Bodies")
            beside.children.link(self.made)
        return self.made

    def _beside(self, source: str) -> bpy.types.Collection:
        """First collection of the source that is shown and can be changed, else the active one."""
        ob = self.context.view_layer.objects.get(source)
        own = ob.users_collection if ob is not None else ()
        home = next((one for one in own if one in self.usable), None)
        if home is not None:
            return home
        active = self._active()
        if own:
            self.transaction.notes.append(
                f"the collection '{own[0].name}' of '{source}' is hidden, excluded or linked; "
                f"what was made of it is in '{active.name}'"
            )
        return active

    def _active(self) -> bpy.types.Collection:
        """Return the active collection, or one around it that is shown; new objects are never out of sight."""
        active = self.context.collection
        if active in self.usable:
            return active
        root = self.context.scene.collection
        self.transaction.notes.append(
            f"the active collection '{active.name}' is hidden, excluded or linked; "
            f"what was made is in '{root.name}'"
        )
        return root


def _usable(layer_collection: bpy.types.LayerCollection) -> list[bpy.types.Collection]:
    """All collections of the view layer that are shown and can be changed."""
    own = layer_collection.collection
    changeable = own.is_editable and not own.override_library
    found = [own] if changeable and layer_collection.is_visible else []
    for child in layer_collection.children:
        found += _usable(child)
    return found
