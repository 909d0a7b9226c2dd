# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies that follow their drawing.

`solve` (numpy only) makes the body of a sketch, on a lattice that stays or on the best one; `reading` finds the
stroke of a body without changing anything; `engine` makes bodies anew; `handlers` decides when; `family` keeps bodies
and drawings together; `outlined` and `linework` make bodies with outlines of their own; `migration` takes over those of
0.1.0; `properties` is what a body remembers; `ui` has the operators and the panel.
"""
