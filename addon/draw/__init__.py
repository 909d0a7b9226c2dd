# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing bodies straight into the viewport.

    interaction (the mouse) -> gesture -> trace -> decision -> drawing, joining, pencil (to Blender)

`gesture`, `trace`, `decision` and `memory` are numpy only: the stroke while it is drawn, its sight lines, what it does
to which body, and how long it is remembered. `shapes` reads the bodies that it may meet, `planes` is where it lies in
space, `preview` shows what release will do. `operator` has the operators, `tool` the toolbar's entry; `simplifying` and
`fewer` leave fewer points of outlines.
"""
