"""USD: an animated skinned stick figure, for video and game pipelines, by Pixar's library.

Source: OpenUSD 26.11, UsdSkel (the schemas SkelRoot, Skeleton, SkelAnimation and their binding).
Metres, +y up, the figure faces +z; one time code per frame, from 0.
"""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from animator.exchange import LibraryMissing
from animator.exchange.sticks import COLOUR, Sticks, sticks_of
from animator.skeleton.bones import Motion, Skeleton, offset_m, rest_origins_m
from animator.turns import unbroken

if TYPE_CHECKING:
    from pxr import Usd, UsdGeom, UsdSkel


def usd_bytes(skeleton: Skeleton, motion: Motion, step_s: float, ending: str = ".usdc") -> bytes:
    """A USD file.

    Args:
        skeleton: The body.
        motion: (n,) its motion.
        step_s: Seconds per frame.
        ending: Suffix of the file's name: `.usda` means text, all others binary.

    Raises:
        LibraryMissing: Without usd-core.
    """
    try:
        from pxr import Usd, UsdGeom, UsdSkel
    except ImportError as error:
        raise LibraryMissing("USD needs usd-core: pip install 'tritrack[usd]'") from error
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, UsdGeom.LinearUnits.meters)
    stage.SetTimeCodesPerSecond(1.0 / step_s)
    stage.SetFramesPerSecond(1.0 / step_s)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(len(motion.root_m) - 1)
    root = UsdSkel.Root.Define(stage, "/Body")
    stage.SetDefaultPrim(root.GetPrim())
    bones = _define_skeleton(stage, skeleton)
    moves = _define_motion(stage, skeleton, motion)
    UsdSkel.BindingAPI.Apply(bones.GetPrim()).CreateAnimationSourceRel().SetTargets(
        [moves.GetPath()]
    )
    figure = _define_figure(stage, sticks_of(skeleton))
    UsdSkel.BindingAPI.Apply(figure.GetPrim()).CreateSkeletonRel().SetTargets([bones.GetPath()])
    return _written(stage, ending)


def _define_skeleton(stage: "Usd.Stage", skeleton: Skeleton) -> "UsdSkel.Skeleton":
    from pxr import UsdSkel, Vt

    bones = UsdSkel.Skeleton.Define(stage, "/Body/Skeleton")
    bones.CreateJointsAttr(_paths(skeleton))
    offsets_m = np.array([offset_m(skeleton, i) for i in range(len(skeleton.bones))])
    offsets_m[0] = rest_origins_m(skeleton)[0]
    bones.CreateRestTransformsAttr(Vt.Matrix4dArray.FromNumpy(_shifts(offsets_m)))
    bones.CreateBindTransformsAttr(Vt.Matrix4dArray.FromNumpy(_shifts(rest_origins_m(skeleton))))
    return bones


def _define_motion(stage: "Usd.Stage", skeleton: Skeleton, motion: Motion) -> "UsdSkel.Animation":
    """Place and turn of each bone in its parent's axes, frame by frame."""
    from pxr import UsdSkel, Vt

    moves = UsdSkel.Animation.Define(stage, "/Body/Skeleton/Motion")
    moves.CreateJointsAttr(_paths(skeleton))
    count = len(skeleton.bones)
    moves.CreateScalesAttr(Vt.Vec3hArray.FromNumpy(np.ones((count, 3), np.float16)))
    offsets_m = np.array([offset_m(skeleton, i) for i in range(count)], np.float32)
    turns = np.stack([unbroken(own.as_quat()) for own in motion.turns], axis=1)
    places, quaternions = moves.CreateTranslationsAttr(), moves.CreateRotationsAttr()
    for frame, root_m in enumerate(motion.root_m):
        offsets_m[0] = root_m
        places.Set(Vt.Vec3fArray.FromNumpy(offsets_m), frame)
        own = np.ascontiguousarray(turns[frame], np.float32)  # x, y, z, w, the library's order
        quaternions.Set(Vt.QuatfArray.FromNumpy(own), frame)
    return moves


def _define_figure(stage: "Usd.Stage", sticks: Sticks) -> "UsdGeom.Mesh":
    from pxr import Gf, UsdGeom, UsdSkel, Vt

    figure = UsdGeom.Mesh.Define(stage, "/Body/Sticks")
    figure.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(sticks.places_m))
    figure.CreateFaceVertexCountsAttr([3] * len(sticks.faces))
    corners = np.ascontiguousarray(sticks.faces.reshape(-1), np.int32)
    figure.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
    figure.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    figure.CreateDisplayColorAttr([Gf.Vec3f(*COLOUR)])
    figure.CreateExtentAttr(
        [sticks.places_m.min(axis=0).tolist(), sticks.places_m.max(axis=0).tolist()]
    )
    binding = UsdSkel.BindingAPI.Apply(figure.GetPrim())
    binding.CreateJointIndicesPrimvar(False, 1).Set(
        Vt.IntArray.FromNumpy(sticks.bones.astype(np.int32))
    )
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * len(sticks.bones))
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d(1.0))
    return figure


def _paths(skeleton: Skeleton) -> list[str]:
    """Each bone's path, its name after its ancestors', as UsdSkel writes a tree: parents first."""
    paths: list[str] = []
    for bone in skeleton.bones:
        paths.append(f"{paths[bone.parent]}/{bone.name}" if bone.parent >= 0 else bone.name)
    return paths


def _shifts(places_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pure translations (n, 4, 4); the library multiplies rows, so the place is in the last one."""
    shifts = np.tile(np.eye(4), (len(places_m), 1, 1))
    shifts[:, 3, :3] = places_m
    return shifts


def _written(stage: "Usd.Stage", ending: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:  # the library writes only to paths
        path = Path(folder) / f"body{ending}"
        stage.GetRootLayer().Export(str(path))
        return path.read_bytes()
