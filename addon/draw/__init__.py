# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing bodies straight into the viewport.

`gesture` (numpy only) is the stroke while it is drawn, with its preview; `planes` is where it lies in space;
`drawing` makes bodies and outlines of finished strokes; `operator` is the modal operator and the toolbar tool.
"""
