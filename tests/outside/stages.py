"""Judges files of Universal Scene Description: Pixar's library reads them without an error, its validators find
nothing, and the solids are where the world's parts are."""

import numpy as np
import shapely
import trimesh
from pxr import Usd, UsdGeom, UsdPhysics, UsdValidation
from shapely.geometry import Point, Polygon

from bodies import compare, expected, judge_places, judge_provenance


def judge(world, report):
    """Reads the stage of a world and compares it with its parts."""
    stage = Usd.Stage.Open(str(world.path("usda")))
    for error in stage.GetCompositionErrors():
        report.complain(f"USD: {error}")
    registry = UsdValidation.ValidationRegistry()
    found = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators()).Validate(stage)
    for error in found:
        report.complain(f"USD: {error.GetName()}: {error.GetMessage()}")
    if UsdGeom.GetStageUpAxis(stage) != "Z" or UsdGeom.GetStageMetersPerUnit(stage) != 1:
        report.complain("USD: the stage is not in metres with z up")
    root = stage.GetDefaultPrim()
    provenance = root.GetAttribute("userProperties:provenance").Get()
    judge_provenance("USD", provenance, world.data, report)
    parts = expected(world.data)
    bodies, places = {}, {}
    for prim in root.GetChildren():
        matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0))
        name = prim.GetName()
        if name in ("start", "goal") or name.startswith("victim_"):
            places[name] = [*matrix[3, :2], np.arctan2(matrix[0, 1], matrix[0, 0])]
            continue
        if name == "floor_plane":
            judge_floor(prim, matrix, world.data, report)
            continue
        form = None if prim.IsA(UsdGeom.Sphere) else body(prim, matrix, report)
        if prim.HasAPI(UsdPhysics.CollisionAPI):
            bodies[name] = form
        check_extent(prim, report)
    compare("USD", bodies, parts, report)
    judge_places("USD", places, world.data, report)


def judge_floor(prim, matrix, data, report):
    """What robots drive on collides, is not drawn, and ends at z = 0 below the whole world."""
    corners = placed(0.5 * np.array([(-1, -1, -1), (1, 1, 1)]), matrix)
    bounds = np.array([data["bounds"]["min"], data["bounds"]["max"]])
    is_below = np.allclose(corners[:, :2], bounds) and np.isclose(corners[1, 2], 0)
    is_hidden = UsdGeom.Imageable(prim).GetPurposeAttr().Get() == UsdGeom.Tokens.guide
    if not (is_below and is_hidden and prim.HasAPI(UsdPhysics.CollisionAPI)):
        report.complain("USD: the floor_plane is not what robots drive on")


def body(prim, matrix, report):
    """The outline, bottom and top of a prim."""
    if prim.IsA(UsdGeom.Cylinder):
        form = UsdGeom.Cylinder(prim)
        half, (x, y, z) = form.GetHeightAttr().Get() / 2, matrix[3, :3]
        if form.GetAxisAttr().Get() != "Z":
            report.complain(f"USD: {prim.GetName()} is not upright")
        return Point(x, y).buffer(form.GetRadiusAttr().Get(), quad_segs=64), z - half, z + half
    if prim.IsA(UsdGeom.Cube):
        half = UsdGeom.Cube(prim).GetSizeAttr().Get() / 2
        corners = half * np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, 1)])
        corners = placed(corners, matrix)
        return Polygon(corners[:, :2]), corners[0, 2], corners[3, 2]
    if not prim.IsA(UsdGeom.Mesh):
        report.complain(f"USD: {prim.GetName()} is a {prim.GetTypeName()}")
        return Point(0, 0), 0, 0
    form = UsdGeom.Mesh(prim)
    counts = np.array(form.GetFaceVertexCountsAttr().Get())
    faces = np.array(form.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    points = placed(np.array(form.GetPointsAttr().Get()), matrix)
    mesh = trimesh.Trimesh(points, faces, process=False)
    normals = np.array(form.GetNormalsAttr().Get()).reshape(-1, 3, 3)
    outward = np.einsum("ijk,ik->ij", normals, mesh.face_normals)
    sound = mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
    if not (sound and (counts == 3).all() and outward.min() > 0.5):
        report.complain(f"USD: {prim.GetName()} is not a closed surface seen from outside")
    top = shapely.polygons(points[faces[mesh.face_normals[:, 2] > 0.5], :2])
    return shapely.union_all(top, grid_size=1e-6), points[:, 2].min(), points[:, 2].max()


def placed(points, matrix):
    """Points in the stage's frame: USD multiplies rows from the left."""
    return points @ matrix[:3, :3] + matrix[3, :3]


def check_extent(prim, report):
    """The extent that a prim states holds its form, as the library computes it."""
    boundable = UsdGeom.Boundable(prim)
    if not boundable:
        report.complain(f"USD: {prim.GetName()} has no extent")
        return
    stated = np.array(boundable.GetExtentAttr().Get())
    computed = UsdGeom.Boundable.ComputeExtentFromPlugins(boundable, Usd.TimeCode.Default())
    if not np.allclose(stated, np.array(computed), atol=1e-6):
        report.complain(f"USD: {prim.GetName()} states the extent {stated}, not {computed}")
