"""Work that is waited for: without a window the events come from here; tests/window has those of a user."""

import time
import types

import bpy
import numpy as np
import pytest
from drawings import bean, grease_pencil, mesh_objects

from addon import api
from addon.ui import waiting


class Manager:
    """Stand-in for the window manager."""

    def __init__(self):
        self.timers = []

    def event_timer_add(self, step, window):
        self.timers.append(step)
        return step

    def event_timer_remove(self, timer):
        self.timers.remove(timer)

    def modal_handler_add(self, operator):
        pass


class Operator(waiting.Waiting):
    bl_label = "Test"

    def __init__(self):
        self.texts = []
        self.manager = Manager()
        workspace = types.SimpleNamespace(status_text_set=self.texts.append)
        self.context = types.SimpleNamespace(window=None, window_manager=self.manager, workspace=workspace)

    def execute(self, context):
        self.result = self.take_done()
        return {"FINISHED"}

    def event(self, kind="TIMER", value="NOTHING"):
        return self.modal(self.context, types.SimpleNamespace(type=kind, value=value))

    def end(self):
        until = time.monotonic() + 60
        while (said := self.event()) == {"RUNNING_MODAL"}:
            assert time.monotonic() < until
        return said


def test_the_result_is_taken_once():
    operator = Operator()
    assert operator.wait(operator.context, lambda progress: (progress(0.5), "done")[1]) == {"RUNNING_MODAL"}
    assert operator.end() == {"FINISHED"}
    assert operator.result == "done"
    assert operator.take_done() is None
    assert operator.waited() == 0
    assert operator.texts[-1] is None
    assert not operator.manager.timers


def until_stopped(progress):
    while progress(0.1):
        pass
    raise api.CancelledError


def test_escape_stops_the_work():
    operator = Operator()
    operator.wait(operator.context, until_stopped)
    assert operator.event("A", "PRESS") == {"RUNNING_MODAL"}
    assert operator.event("Z", "PRESS") == {"RUNNING_MODAL"}
    assert operator.event("WHEELUPMOUSE", "PRESS") == {"PASS_THROUGH"}
    operator.event("ESC", "PRESS")
    with pytest.raises(api.CancelledError):
        operator.end()
    assert not operator.manager.timers
    assert operator.texts[-1] is None


def test_blender_ends_the_operator():
    operator = Operator()
    operator.wait(operator.context, until_stopped)
    operator.cancel(operator.context)
    assert not operator._work.is_alive()
    assert not operator.manager.timers


def test_scripts_do_not_wait():
    grease_pencil([bean()])
    assert bpy.ops.object.gridmesh_from_strokes("INVOKE_DEFAULT", triangles=60_000) == {"FINISHED"}
    assert len(mesh_objects()) == 1


@pytest.mark.parametrize("options", [{"triangles": 1000}, {"edge_length": 0.08}])
def test_expected_triangles_are_about_right(options):
    from addon.bodies.outlines import Stroke

    stroke = Stroke(points=bean(), cyclic=True, source="", layer="", index=0, count=1)
    sketches, _, _ = api.sketches_of([stroke], close_gaps=0.2, holes=True)
    (body,), _ = api.build(sketches, options, None)
    assert np.isclose(api.expected_triangles(sketches, options), len(body.faces), rtol=0.15)
    assert api.expected_triangles(sketches, {"edge_length": 0.0}) == 0
