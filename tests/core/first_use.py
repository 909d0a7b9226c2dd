"""Use the installed module once, with nothing but numpy: for platforms on which the other tests do not run."""

import gridmesh
import numpy as np

t = np.linspace(0, 2 * np.pi, 200, endpoint=False)
r = 1 + 0.3 * np.cos(3 * t)
patch = gridmesh.mesh_sketch(np.c_[r * np.cos(t), r * np.sin(t)], triangles=2000)
body = gridmesh.inflate(patch)
assert body.report["watertight"]
assert body.report["genus"] == 0
assert len(gridmesh.fill_holes(body.vertices, body.triangles[50:])) > 0
print(
    f"gridmesh {gridmesh.__version__}: {len(body.triangles)} triangles, {body.report['irregular']} irregular"
)
