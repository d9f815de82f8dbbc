"""Takes the leaves off the sample ficus by their colour, looks at the result, and exports it.

    PYTHONPATH=build python3 samples/python/remove_and_compare.py

Run it cell by cell in an editor that knows `# %%`, or as a whole.
"""
# %% Open a baked scene. Every change below is an edit that undo() reverts.
import sys
from pathlib import Path

import numpy as np

import rebake

samples = Path(__file__).resolve().parents[1]
out = Path(sys.argv[1]) if len(sys.argv) > 1 else samples / "out"
document = rebake.open(samples / "scenes/ficus")
for node in document.nodes:
    print(f"{node['name']}: {node['triangles']} triangles")

# %% The geometry as NumPy arrays, without a copy.
vertices, faces = document.vertices("ficus"), document.faces("ficus")
print("box:", vertices.min(axis=0), vertices.max(axis=0))

# %% Select all triangles whose colour is similar to the topmost one, a leaf.
before = document.render(400, 400)
centres = vertices[faces].mean(axis=1)
top = centres[centres[:, 1].argmax()]
mask = document.select_like(point=top, color=0.15)["ficus"]
print(f"{mask.sum()} triangles are like the topmost one")

# %% Remove them, and measure how much of the picture changed.
document.delete()
after = document.render(400, 400)
print(f"{100 * (before != after).any(axis=2).mean():.1f} % of the pixels changed")

# %% Export in the same format, and save the work as a project.
out.mkdir(parents=True, exist_ok=True)
for note in document.export(out / "bare_ficus"):
    print("note:", note)
document.save(out / "bare_ficus.rebake")
print("written:", out / "bare_ficus")
