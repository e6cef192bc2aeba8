"""A deployment as an animation for Blender, whose morph targets are modes, and an angle as a table."""

import orchestrator as fanfold

result = fanfold.simulate("workbench", estimate=False)
animation = fanfold.export_view(result, "workbench.glb", tolerance=1e-3)
table = fanfold.export_view(result, "workbench.csv", signals="hinge_left.angle", every=0.1)
print("written:", *(path.name for path in (*animation, *table)))
