"""Hundreds of random acts in a row: `run.py ZIP random_play --seed 5 --acts 200`."""

import os

import bmesh
import bpy
from random_acts import Play, in_object_mode
from random_edits import Editing
from setting import begin, bodies, modules, stage


def check_closed():
    """Every body and character that nobody changed by hand, and that is no flat sheet, is closed."""
    by_hand = modules("data.written").by_hand
    wholes = modules("join.following").wholes()
    for ob in [*(ob for ob in bodies() if ob.gridmesh_live.shape == "BODY"), *wholes]:
        mesh = bmesh.new()
        mesh.from_mesh(ob.data)
        open_edges = sum(not edge.is_manifold for edge in mesh.edges)
        mesh.free()
        assert open_edges == 0 or by_hand(ob.data), f"{ob.name}: {open_edges} edges are not manifold"


def played(kind):
    seed, number = int(os.environ.get("SEED", "1")), int(os.environ.get("ACTS", "150"))
    play = kind(seed)
    yield from begin()
    for k in range(number):
        act = play.random.choice(kind.OFTEN)
        print(f"{seed}/{k} {act.__name__} in {bpy.context.mode}, {len(bpy.data.objects)} objects", flush=True)
        yield from act(play)
        if k % 4 == 0:
            yield from in_object_mode()
            check_closed()
        if k % 50 == 49:
            yield from stage.picture(f"{kind.__name__.lower()}_{seed}_{k + 1}")


def random_play():
    """No act leads to an exception, a crash or another scene than before a step there and back."""
    yield from played(Play)


def random_edits():
    """The same in Edit Mode, with the cut tool and with other meshes."""
    yield from played(Editing)


SCENES = (random_play, random_edits)
