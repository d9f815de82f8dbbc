# Written by rebake.python_stub(); the edits are those of the one table.
"""Edit and compose baked NeRF scenes (MobileNeRF format).

Lengths are in scene units, angles in degrees, colours display values from 0 to 1. Names and fields are those of scripts.
"""
from os import PathLike
from typing import Any, Callable, Literal, Sequence, TypedDict

import numpy as np
from numpy.typing import NDArray

Vector = Sequence[float] | NDArray[np.floating[Any]]
Node = str | int
Progress = Callable[[str, float], object]
class AxisAngle(TypedDict):
    axis: Vector
    degrees: float
Rotation = AxisAngle | Sequence[float]
class Box(TypedDict):
    min: Vector
    max: Vector
class Sphere(TypedDict):
    center: Vector
    radius: float
class HalfSpace(TypedDict):
    point: Vector
    normal: Vector
class Brush(TypedDict):
    points: Sequence[Sequence[float]]
    radius: float
class Camera(TypedDict, total=False):
    eye: Vector
    target: Vector
    up: Vector
    fov: float
    ortho_height: float
    near: float
    far: float

class Error(RuntimeError):
    """Base of everything that Rebake raises on purpose."""
class FileError(Error):
    """Something is wrong with a file or folder; the message starts with its path."""
class FieldError(Error):
    """A field does not hold what it should; the message starts with its name."""
class EditError(Error):
    """An edit cannot be carried out on this scene."""
class DeviceError(Error):
    """The machine lacks something: no OpenGL, no memory on the GPU."""

def open(path: str | PathLike[str], axes: Literal["360", "forward"] = "360",
         progress: Progress | None = None, sources: dict[str, str | list[str]] = {}) -> Document:
    """Opens a MobileNeRF folder, a Rebake scene or a project (.rebake). `sources` maps moved folders of a project to
    their new paths."""
def recover(journal: str | PathLike[str], sources: dict[str, str | list[str]] = {},
            progress: Progress | None = None) -> Document:
    """The work that a journal kept; goes on writing it. `sources`: where moved ones lie now, old path to new."""
def move_by_cage(points: NDArray[np.float64], vertices: NDArray[np.float64], faces: NDArray[np.uint32],
                 moved: NDArray[np.float64], coordinates: Literal["mean_value", "green", "harmonic"] = "mean_value",
                 resolution: int = 32) -> NDArray[np.float64]:
    """Where points (n × 3) go when a closed cage's vertices move to `moved`."""
def wrap(points: NDArray[np.float64], faces: NDArray[np.uint32],
         coarseness: float = 0.1) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """A closed cage around triangles: its vertices and faces. Coarseness is a share of their size, 0.005 to 0.5."""
def python_stub() -> str:
    """This text."""

class Document:
    """A scene with its history. An edit that raises leaves everything as it was."""
    progress: Progress | None
    """Called, ten times a second at most, with what is done and its share while something long is; what it raises stops
    that, as Ctrl+C does, and nothing is changed."""
    def __init__(self) -> None: ...
    @property
    def nodes(self) -> list[dict[str, Any]]:
        """Every node: id, name, parent, visible, locked, triangles, to_world (4×4)."""
    def edit(self, edit: dict[str, Any]) -> None:
        """Carries out one edit, given as a line of a script."""
    def edits(self) -> list[dict[str, Any]]:
        """What was done, as lines of a script; nodes by number."""
    def undo(self) -> bool:
        """False where there is nothing to undo."""
    def redo(self) -> bool:
        """False where there is nothing to redo."""
    def keep_journal(self, path: str | PathLike[str]) -> None:
        """From here on every edit is on the disk before it returns."""
    def discard_journal(self) -> None: ...
    def save(self, path: str | PathLike[str]) -> None:
        """Writes a project (.rebake), or a scene folder that keeps every node."""
    def export(self, path: str | PathLike[str], layout: Literal["split", "chunked", "unsplit"] | None = None,
               format: Literal["mobilenerf", "rebake"] = "mobilenerf", plain: bool = False,
               width: int | Literal["auto"] = "auto",
               way: Literal["keep", "train", "new", "side_by_side"] | None = None, keep: str = "auto",
               psnr: float | None = None, seconds: float = 0, report: str | PathLike[str] = "") -> list[str]:
        """Writes the MobileNeRF format or another; returns what the result cannot hold or was converted, and with
        plain (one folder for any scene) what was measured."""
    def render(self, width: int = 800, height: int = 800, samples: int = 4, camera: Camera | None = None,
               view: str = "") -> NDArray[np.uint8]:
        """A picture, height × width × 3; without camera and view, one that frames the scene."""
    def selection(self, node: Node) -> NDArray[np.bool_]:
        """Which of an object's triangles are selected, in the order of faces() set by set."""
    def select_mask(self, node: Node, mask: NDArray[np.bool_],
                    mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects an object's triangles by a mask, as selection() gives one; recorded as select_triangles."""
    def vertices(self, node: Node, texture_set: int = 0) -> NDArray[np.float64]:
        """Positions in the object's own space, n × 3; a read-only view, nothing is copied."""
    def uvs(self, node: Node, texture_set: int = 0) -> NDArray[np.float64]:
        """Texture coordinates, n × 2, v up; a read-only view."""
    def faces(self, node: Node, texture_set: int = 0) -> NDArray[np.uint32]:
        """Vertex numbers, n × 3; a read-only view."""
    def tiles(self, node: Node, texture_set: int = 0) -> list[list[NDArray[np.uint8]]]:
        """The texels, 256 × 256 × 8 a tile (feat0 RGBA, feat1 RGBA), by row and column; read-only, unpacked by each call."""
    def texture(self, node: Node, texture_set: int = 0) -> NDArray[np.uint8]:
        """The same in one piece, height × width × 8; a copy."""
    def import_(self, *, path: str, as_: str = "", axes: Literal["360", "forward"] = "360", ground: bool = False, content: str = "") -> None:
        """Reads a MobileNeRF folder or a Rebake scene into the scene.

        path: folder to read
        as_: name of the new node; empty: the folder's name
        axes: which way a MobileNeRF folder is oriented; scenes say so themselves
        ground: whether the scene's ground moves to its lowest point
        content: hash of the folder's files as projects and journals record it: anything else there is refused
        """
    def remove(self, *, node: Node) -> None:
        """Takes a node and its children out of the scene.

        node: node to remove
        """
    def rename(self, *, node: Node, name: str) -> None:
        """Gives a node another name.

        node: node to rename
        name: new name, not in use yet
        """
    def duplicate(self, *, node: Node, as_: str = "", translate: Vector = [0.0,0.0,0.0]) -> None:
        """Adds a copy of a node and its children after it; triangles and texels stay shared.

        node: node to copy
        as_: name of the copy; empty: the node's with a number
        translate: how far from the node the copy stands (scene units)
        """
    def group(self, *, nodes: Sequence[Node], as_: str = "") -> None:
        """Puts nodes into a new group; they stay where they are in the world.

        nodes: nodes to put together
        as_: name of the group; empty: group
        """
    def reorder(self, *, node: Node, index: int, parent: Node | None = None, top: bool = False) -> None:
        """Moves a node within the outline, to another place or group; it stays where it is in the world.

        node: node to move
        index: place among its new siblings, from 0; later ones are drawn on top where depths are equal
        parent: group to move into; left out: stays in its group
        top: move to the top level, out of all groups
        """
    def show(self, *, node: Node) -> None:
        """Makes a node visible again.

        node: node
        """
    def hide(self, *, node: Node) -> None:
        """Hides a node and its children; they are neither drawn nor exported; save keeps them.

        node: node
        """
    def lock(self, *, node: Node) -> None:
        """Protects a node and its children from edits.

        node: node
        """
    def unlock(self, *, node: Node) -> None:
        """Allows edits again.

        node: node
        """
    def view(self, *, name: str, camera: Camera) -> None:
        """Stores a camera under a name.

        name: name of the view
        camera: the camera; what is left out has its usual value, and planes fit what is visible
        """
    def rename_view(self, *, name: str, to: str) -> None:
        """Gives a stored view another name.

        name: name of the view
        to: new name, not in use yet
        """
    def remove_view(self, *, name: str) -> None:
        """Forgets a stored view.

        name: name of the view
        """
    def background(self, *, color: Vector) -> None:
        """Sets the colour behind everything.

        color: display red, green and blue (share)
        """
    def ground(self, *, height: float | None = None, foot: bool = False, selection: bool = False, points: Sequence[Sequence[float]] = []) -> None:
        """Sets the scene's ground plane, which drop, snapping and the grid use; its normal is up for sky light. Without it the ground is y = 0.

        height: level ground at this y (scene units)
        foot: level ground at the lowest point of everything visible
        selection: the plane that fits the selected triangles best
        points: ground through three points
        """
    def light(self, *, effects: Sequence[str] = ["auto"], source: str = "", zenith: Vector = [0.75,0.88,1.1], ground: Vector = [0.34,0.3,0.27], sun: Vector = [0.5,0.8,0.45], sun_color: Vector = [1.15,1.05,0.9], sun_degrees: float = 5.0, picture: str = "", picture_degrees: float = 0.0, content: str = "", bounce: Vector = [0.0,0.0,0.0], budget: float = 1.0, rays: int = 256) -> None:
        """Makes light follow the scene's edits: shadows on what is bent, between objects, and of what is gone; highlights.

        effects: auto: self, cast, removed and highlights, each where it would be seen; or some of them: self (shadows of what moved in itself), highlights (that it mirrors; self must be named too), cast (between objects), removed (of what is gone); and match: all objects in one light, the given one, or as the first object's is spread; none: colours stay as baked
        source: of the light: estimated from each object's colours; uniform: the zenith's everywhere; sky: zenith, ground and a sun, about the objects' own upright axis; picture: of all directions; left out: the picture where one is named, else estimated
        zenith: uniform and sky: linear radiance from above, red, green and blue
        ground: sky: the same from below
        sun: sky: direction towards the sun, in the objects' own space as they were read; with match in the world
        sun_color: sky: linear, what the sun sends back from a white surface that faces it; 0, 0, 0: none
        sun_degrees: sky: the sun's radius as seen, up to 45, which softens shadows (degrees)
        picture: file with an equirectangular picture, twice as wide as high: OpenEXR, Radiance HDR, PNG, JPEG, TIFF, WebP; its middle towards -z; bright spots in it become suns
        picture_degrees: by which it is turned about the upright axis (degrees)
        content: hash of the picture as projects and journals record it: anything else there is refused
        bounce: given light: linear radiance of surfaces that hide it
        budget: how far colours may be off for what is left out, of 255; at most 255
        rays: from each point, 16 to 16384: about 4 % off at 64, 1.1 % at 256
        """
    def transform(self, *, node: Node, selection: bool = False, translate: Vector = [0.0,0.0,0.0], rotate: Rotation = [1.0,0.0,0.0,0.0], scale: float | Vector = [1.0,1.0,1.0], scale_axes: Rotation = [1.0,0.0,0.0,0.0], pivot: Vector | None = None) -> None:
        """Scales, then turns, then moves a node or its selected triangles about a pivot.

        node: node to transform
        selection: only the selected triangles
        translate: how far it moves (scene units)
        rotate: rotation
        scale: factor; negative mirrors, 0 is refused
        scale_axes: turn of the axes along which scale acts, from the world's
        pivot: world point that scale and rotation keep; left out: the centre of the box of what is transformed
        """
    def place(self, *, node: Node, position: Vector | None = None, rotation: Rotation | None = None, scale: float | Vector | None = None) -> None:
        """Says where a node stands, how it is turned and how large it is, in its parent.

        node: node to place
        position: of its origin; left out: as it is (scene units)
        rotation: from its parent's axes; left out: as it is
        scale: factor along its own axes; negative mirrors, 0 is refused; left out: as it is
        """
    def drop(self, *, node: Node, ground: float | None = None) -> None:
        """Lets a node fall onto what is visible below it, or onto the scene's ground plane. A node that intersects something is lifted out of it first.

        node: node that falls, with those inside it
        ground: height of a level ground to use in place of the scene's (scene units)
        """
    def align(self, *, nodes: Sequence[Node], axis: Literal["x", "y", "z"] = "x", to: Literal["least", "middle", "greatest", "spread"] = "middle") -> None:
        """Moves nodes along an axis so that their boxes' ends or middles are at the first one's, or with the same gap between neighbours.

        nodes: two or more; the first stays, or in a spread the outermost
        axis: of the world
        to: the boxes' least ends, middles or greatest ends; spread: equal gaps
        """
    def select(self, *, node: Node | None = None, all: bool = False, none: bool = False, invert: bool = False, box: Box | None = None, sphere: Sphere | None = None, half_space: HalfSpace | None = None, connected: Vector | None = None, texture_set: int | None = None, saved: str = "", mode: Literal["set", "add", "remove", "intersect"] = "set", frame: Literal["world", "node", "bounds"] = "world") -> dict[str, NDArray[np.bool_]]:
        """Selects triangles by their centres.

        node: only of this node and those inside it; left out: of all that are visible and not locked
        all: every triangle
        none: no triangle
        invert: those not selected now
        box: inside a box
        sphere: inside a sphere; radius in units of the frame, in frame bounds as a share of the box diagonal
        half_space: on the side that the normal points to
        connected: joined through shared corners to the triangle nearest to this point
        texture_set: of this texture set, counted from 0
        saved: stored by store_selection under this name
        mode: how the result joins the present selection
        frame: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        """
    def select_picture(self, *, node: Node | None = None, polygon: Sequence[Sequence[float]] | None = None, brush: Brush | None = None, depth: Sequence[float] | None = None, view: str = "", camera: Camera | None = None, size: Sequence[int] = [800,800], through: bool = False, mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects triangles in a camera's picture: those seen through a pixel of the region, or with through all whose centre falls into it.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        polygon: inside a polygon in the picture
        brush: under a brush stroke in the picture
        depth: only at these depths along the view axis (scene units)
        view: name of the stored view whose picture it is
        camera: the camera whose picture it is
        size: the picture's size, in whose pixels points are given
        through: hidden triangles too
        mode: how the result joins the present selection
        """
    def select_connected(self, *, node: Node | None = None, point: Vector | None = None, tolerance: float = 0.0, gap: float = 0.0, mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects the connected parts (triangles that share an edge, opaque along it) that hold the triangle nearest to a point, or the present selection.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        point: world point, near a triangle that shows something; left out: from the present selection
        tolerance: corners at most this far apart count as one; 0: only equal ones (the object's units)
        gap: opaque texels at most this far apart are connected too; they are sampled up to a quarter of it apart, so only connections of up to 0.6 of it are sure to be found (the object's units)
        mode: how the result joins the present selection
        """
    def select_like(self, *, node: Node | None = None, point: Vector | None = None, color: float | None = None, features: float | None = None, opacity: float | None = None, size: float | None = None, orientation: float | None = None, contiguous: bool = False, mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects triangles that are like the picked ones: within every tolerance that is given, of the mean over the present selection or of the triangle nearest to a point.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        point: world point, near a triangle that shows something; left out: like the present selection
        color: distance of mean decoded colours, channels 0 to 1
        features: root mean square difference of mean features (share)
        opacity: difference of the share of opaque texels (share)
        size: between areas in the world, at least 1 (factor)
        orientation: between planes in the world, 0 to 90 (degrees)
        contiguous: only those that hang together with what they are compared with, through corners they share
        mode: how the result joins the present selection
        """
    def select_floaters(self, *, node: Node | None = None, at_most: int = 100, tolerance: float = 0.0, gap: float = 0.0, mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects small parts that hang together with nothing else, across opaque texels; look at the count, then delete.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        at_most: triangles of a part that counts as floating
        tolerance: corners at most this far apart count as one; 0: only equal ones (the object's units)
        gap: opaque texels at most this far apart are connected too; they are sampled up to a quarter of it apart, so only connections of up to 0.6 of it are sure to be found (the object's units)
        mode: how the result joins the present selection
        """
    def select_unneeded(self, *, node: Node | None = None, transparent: bool = False, duplicates: bool = False, unseen: int = 0, distance: float = 3.0, unseen_from: Sequence[str] | None = None, mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects triangles that no picture needs, for cleaning: look at the count, then delete.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        transparent: without an opaque texel in it or within one texel of its edges
        duplicates: same corners and same texels as a triangle drawn later
        unseen: not seen from this many eyes on a sphere around the object; other objects hide nothing
        distance: of the eyes, in half diagonals of the object's box
        unseen_from: names of stored views: not seen from any of their eyes
        mode: how the result joins the present selection
        """
    def select_triangles(self, *, node: Node, triangles: Sequence[int | Sequence[int]], mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects triangles of an object by their numbers, set after set as in its files.

        node: the object
        triangles: which ones, counted from 0
        mode: how the result joins the present selection
        """
    def select_folded(self, *, node: Node | None = None, mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects triangles that the last deformation of their object folded or collapsed (det J ≤ 0 at a corner).

        node: only of this node and those inside it; left out: of all that is visible and not locked
        mode: how the result joins the present selection
        """
    def grow(self, *, node: Node | None = None, steps: int = 1, tolerance: float = 0.0) -> dict[str, NDArray[np.bool_]]:
        """Adds the triangles that share a corner with the selection.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        steps: how often
        tolerance: corners at most this far apart count as one; 0: only equal ones (the object's units)
        """
    def shrink(self, *, node: Node | None = None, steps: int = 1, tolerance: float = 0.0) -> dict[str, NDArray[np.bool_]]:
        """Takes away the selected triangles that share a corner with others.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        steps: how often
        tolerance: corners at most this far apart count as one; 0: only equal ones (the object's units)
        """
    def fill(self, *, node: Node | None = None, at_most: int = 1000, tolerance: float = 0.0) -> dict[str, NDArray[np.bool_]]:
        """Adds the islands inside the selection: unselected triangles, joined through edges, that border it.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        at_most: triangles of an island that is filled
        tolerance: corners at most this far apart count as one; 0: only equal ones (the object's units)
        """
    def store_selection(self, *, name: str) -> None:
        """Stores the present selection of all nodes under a name, for select's field saved; replaces what had the name.

        name: name of the selection
        """
    def delete(self, *, node: Node | None = None) -> None:
        """Removes the selected triangles; a node that loses all goes too.

        node: only of this node; left out: of all that are visible and not locked
        """
    def separate(self, *, node: Node, as_: str = "") -> None:
        """Makes the selected triangles of a node a node of its own, after it.

        node: node to separate from
        as_: name of the new node; empty: the node's with a number
        """
    def merge(self, *, nodes: Sequence[Node], as_: str = "") -> None:
        """Makes objects of one decoder one node, in place of the first; parts that were separated before fit together again as they were.

        nodes: nodes to merge, in drawing order
        as_: name of the result; empty: the first one's
        """
    def erase(self, *, node: Node | None = None, box: Box | None = None, sphere: Sphere | None = None, half_space: HalfSpace | None = None, frame: Literal["world", "node", "bounds"] = "world", polygon: Sequence[Sequence[float]] | None = None, brush: Brush | None = None, depth: Sequence[float] | None = None, view: str = "", camera: Camera | None = None, size: Sequence[int] = [800,800], through: bool = False) -> None:
        """Clears the opacity of texels inside a region or in a picture, where an object's edge runs through triangles; all other texels stay bit for bit.

        node: only of this node and those inside it; left out: of all that is visible and not locked
        box: inside a box
        sphere: inside a sphere; radius as for select
        half_space: on the side that the normal points to
        frame: of box, sphere and half_space, as for select
        polygon: inside a polygon in the picture
        brush: under a brush stroke in the picture
        depth: only at these depths along the view axis (scene units)
        view: name of the stored view whose picture it is
        camera: the camera whose picture it is
        size: the picture's size, in whose pixels points are given
        through: in a picture: hidden texels too
        """
    def slim(self, *, node: Node | None = None, views: Sequence[str] | None = None, eyes: Box | None = None, rays: int = 16384, psnr: float = 0.0) -> None:
        """Removes triangles that nobody sees and duplicates, packs the texels that are left, and, where psnr is given, lets patches that look alike share texels and keeps fewer bits of the features: smaller folders, faster pictures.

        node: only this node and those inside it; left out: all that is visible. Objects hide themselves only
        views: names of stored views: what none of their eyes sees goes, as far as rays find out: what was done says how sure that is
        eyes: box in the world: what no eye in it sees goes; with neither, what no eye outside the object sees
        rays: at most, from each triangle before it counts as unseen, 16 to 1048576: 1024, doubled until that finds nothing more
        psnr: dB that texels' colours keep, 20 to 80, against those as they are now, while patches that look alike become one (so that erasing in one erases in all of them) and features lose bits; 0: texels that are kept stay as they are
        """
    def cage(self, *, moves: Sequence[dict[str, Any]], node: Node | None = None, selection: bool = False, box: Box | None = None, frame: Literal["world", "node", "bounds"] = "world", falloff: float = 0.0, lattice: Sequence[int] | None = None, wrap: float | None = None, mesh: str | dict[str, Any] | None = None, coordinates: Literal["mean_value", "green", "harmonic"] = "mean_value", resolution: int = 32) -> None:
        """Deforms triangles by a cage around them: its points move, what is inside follows, colours turn along.

        node: with those inside it; left out: all that have selected triangles
        selection: only its selected triangles
        box: only triangles whose centre lies inside
        frame: of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        falloff: width of the soft border towards triangles that are not deformed; 0: a hard border (scene units)
        lattice: a box around the triangles, of so many cells along x, y and z
        wrap: a wrap of the triangles that show something; its coarseness of their size, 0.005 to 0.5 (share)
        mesh: a closed triangle mesh in world space: a file (.obj, .off, .ply), or its vertices and faces
        moves: what moves, one after the other; boxes and spheres in world units, or in shares of the cage's box where the edit's field frame is bounds
        coordinates: mean_value: anywhere; green: keeps shapes, inside only; harmonic: around corners, not across, inside only, on a grid
        resolution: harmonic: cells of the grid along the cage's longest side, 8 to 256; finer is nearer and slower
        """
    def handles(self, *, moves: Sequence[dict[str, Any]], node: Node | None = None, selection: bool = False, box: Box | None = None, frame: Literal["world", "node", "bounds"] = "world", falloff: float = 0.0, lattice: Sequence[int] | None = None, wrap: float | None = None, mesh: str | dict[str, Any] | None = None, fixed: Sequence[dict[str, Any]] = [], iterations: int = 200) -> None:
        """Deforms triangles as rigidly as possible: some points of a wrap around them are held or moved, the rest follows.

        node: with those inside it; left out: all that have selected triangles
        selection: only its selected triangles
        box: only triangles whose centre lies inside
        frame: of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        falloff: width of the soft border towards triangles that are not deformed; 0: a hard border (scene units)
        lattice: a box around the triangles, of so many cells along x, y and z
        wrap: a wrap of the triangles that show something; its coarseness of their size, 0.005 to 0.5 (share)
        mesh: a closed triangle mesh in world space: a file (.obj, .off, .ply), or its vertices and faces
        moves: points of the cage that are moved; boxes and spheres in world units, or in shares of the cage's box where the edit's field frame is bounds
        fixed: points of the cage that are held where they are
        iterations: 1 to 1000, at most; it ends sooner where nothing moves by more than a millionth of the cage's size
        """
    def bend(self, *, degrees: float, node: Node | None = None, selection: bool = False, box: Box | None = None, frame: Literal["world", "node", "bounds"] = "world", falloff: float = 0.0, axis: Vector = [0.0,1.0,0.0], origin: Vector | None = None, spine: Sequence[Sequence[float]] = [], from_: float | None = None, to: float | None = None, direction: Vector = [1.0,0.0,0.0]) -> None:
        """Bends triangles along an axis into an arc: the axis keeps its length, what lies beyond the limits follows.

        node: with those inside it; left out: all that have selected triangles
        selection: only its selected triangles
        box: only triangles whose centre lies inside
        frame: of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        falloff: width of the soft border towards triangles that are not deformed; 0: a hard border (scene units)
        degrees: in all, from one limit to the other (degrees)
        axis: direction of the axis, in world axes
        origin: world point on the axis; left out: where it enters the box of what is deformed, in the middle
        spine: world points of a curved line in place of the axis, which then only says across what it bends; from and to are lengths along it; not for tapers
        from_: where it begins along the axis, from the origin; left out: where the triangles begin (scene units)
        to: where it ends; left out: where the triangles end (scene units)
        direction: where the far end goes; its part across the axis counts
        """
    def twist(self, *, degrees: float, node: Node | None = None, selection: bool = False, box: Box | None = None, frame: Literal["world", "node", "bounds"] = "world", falloff: float = 0.0, axis: Vector = [0.0,1.0,0.0], origin: Vector | None = None, spine: Sequence[Sequence[float]] = [], from_: float | None = None, to: float | None = None) -> None:
        """Twists triangles about an axis, more and more between the limits.

        node: with those inside it; left out: all that have selected triangles
        selection: only its selected triangles
        box: only triangles whose centre lies inside
        frame: of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        falloff: width of the soft border towards triangles that are not deformed; 0: a hard border (scene units)
        degrees: in all, from one limit to the other (degrees)
        axis: direction of the axis, in world axes
        origin: world point on the axis; left out: where it enters the box of what is deformed, in the middle
        spine: world points of a curved line in place of the axis, which then only says across what it bends; from and to are lengths along it; not for tapers
        from_: where it begins along the axis, from the origin; left out: where the triangles begin (scene units)
        to: where it ends; left out: where the triangles end (scene units)
        """
    def taper(self, *, factor: float, node: Node | None = None, selection: bool = False, box: Box | None = None, frame: Literal["world", "node", "bounds"] = "world", falloff: float = 0.0, axis: Vector = [0.0,1.0,0.0], origin: Vector | None = None, spine: Sequence[Sequence[float]] = [], from_: float | None = None, to: float | None = None) -> None:
        """Makes triangles thinner or thicker across an axis, more and more between the limits.

        node: with those inside it; left out: all that have selected triangles
        selection: only its selected triangles
        box: only triangles whose centre lies inside
        frame: of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        falloff: width of the soft border towards triangles that are not deformed; 0: a hard border (scene units)
        factor: size at the upper limit, of what it is now (factor)
        axis: direction of the axis, in world axes
        origin: world point on the axis; left out: where it enters the box of what is deformed, in the middle
        spine: world points of a curved line in place of the axis, which then only says across what it bends; from and to are lengths along it; not for tapers
        from_: where it begins along the axis, from the origin; left out: where the triangles begin (scene units)
        to: where it ends; left out: where the triangles end (scene units)
        """
    def stretch(self, *, factor: float, node: Node | None = None, selection: bool = False, box: Box | None = None, frame: Literal["world", "node", "bounds"] = "world", falloff: float = 0.0, axis: Vector = [0.0,1.0,0.0], origin: Vector | None = None, spine: Sequence[Sequence[float]] = [], from_: float | None = None, to: float | None = None) -> None:
        """Makes triangles longer or shorter along an axis, between the limits.

        node: with those inside it; left out: all that have selected triangles
        selection: only its selected triangles
        box: only triangles whose centre lies inside
        frame: of the box: world; node: the object's own coordinates; bounds: shares of the object's own box, 0 to 1
        falloff: width of the soft border towards triangles that are not deformed; 0: a hard border (scene units)
        factor: length between the limits, of what it is now (factor)
        axis: direction of the axis, in world axes
        origin: world point on the axis; left out: where it enters the box of what is deformed, in the middle
        spine: world points of a curved line in place of the axis, which then only says across what it bends; from and to are lengths along it; not for tapers
        from_: where it begins along the axis, from the origin; left out: where the triangles begin (scene units)
        to: where it ends; left out: where the triangles end (scene units)
        """
