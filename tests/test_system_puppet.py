"""Bodies of the Anny model where it is not installed: what is made of a puppet of its bones."""

import sys
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from puppet import BONES, PARENTS, hanging_on, heads, puppet

from common.body.body import JOINT_NAMES
from synth.anny_people import (
    anatomy,
    anny_examples,
    cloth,
    figures,
    hair_and_face,
    limb_regions,
    retarget,
    skirt,
)
from synth.anny_people.anatomy import Anatomy
from synth.anny_people.figures import Figure
from synth.anny_people.folds import folds
from synth.anny_people.limb_regions import NOWHERE, SEAT, Regions
from synth.motion.footing import posed
from synth.person.people import Look, person
from synth.person.rings import MATERIAL
from synth.person.skeleton import ANGLES, BONE_INDEX, HEAD_FORWARD, JOINTS, bone_frames
from synth.person.wardrobe import dressed
from synth.picture.actors import palette
from synth.picture.picture_examples import PICTURES
from synth.picture.silhouette_examples import PEOPLE

Use = Callable[[Anatomy], None]
PLAIN = person(2).look._replace(
    sleeve="long", shorts=False, hair="short", loose_top_m=0.02, loose_legs_m=0.03, hem_m=0.01
)


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Use:
    """Puts a puppet in the model's place."""

    def used(known: Anatomy) -> None:
        for module in (figures, limb_regions, cloth, skirt, retarget):
            monkeypatch.setattr(module, "anatomy", lambda: known)

    return used


class Chance:
    """A source of chance that gives what it is told to, and keeps what it was asked for."""

    def __init__(self, *shares: float) -> None:
        self.shares, self.asked = [*shares], list[Any]()

    def random(self) -> float:
        return self.shares.pop(0)

    def uniform(self, low: float, high: float) -> float:
        self.asked.append((low, high))
        return low + self.shares.pop(0) * (high - low)

    def normal(self, middle: float, spread: float) -> float:
        self.asked.append((middle, spread))
        return middle + self.shares.pop(0) * spread

    def dirichlet(self, alpha: list[float]) -> np.ndarray:
        self.asked.append(alpha)
        return np.array([0.2, 0.3, 0.5])


class Tensor:
    """What torch gives."""

    def __init__(self, values: Any) -> None:
        self.values = np.array(values)

    def numpy(self) -> np.ndarray:
        return self.values

    def __getitem__(self, at: int) -> "Tensor":
        return Tensor(self.values[at])


def test_the_model_is_read_upright_and_coarser_where_fingers_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of three vertices of a finger within eight millimetres the middle one stays, of three of the
    trunk each; a face that loses a corner goes."""
    asked: list[Any] = []
    places = [
        (0, 0, 1), (0, 0.001, 1), (0, 0, 1.002),
        (0.4011, -0.2, 0.9), (0.4021, -0.2, 0.9), (0.4051, -0.2, 0.9), (0.4085, -0.2, 0.9),
    ]  # fmt: skip
    model = SimpleNamespace(
        bone_labels=["root", "finger2-1.L"],
        bone_parents=[-1, 0],
        template_vertices=Tensor(np.array(places, np.float32)),
        vertex_bone_indices=Tensor([[0, 1]] * 3 + [[1, 0]] * 4),
        vertex_bone_weights=Tensor([[0.75, 0.25], [1.0, 0.0], [0.9, 0.1]] + [[0.6, 0.4]] * 4),
        faces=Tensor([[0, 1, 2], [1, 2, 3], [2, 3, 5], [3, 4, 6], [4, 6, 0]]),
    )

    def made(**how: object) -> Any:
        asked.append(how)
        return model

    monkeypatch.setitem(sys.modules, "anny", SimpleNamespace(Anny=made))
    known = anatomy.anatomy.__wrapped__()
    assert asked == [{"topology": "notoes", "phenotypes": "all", "skinning_method": "lbs"}]
    assert known.model is model
    assert (known.bones, known.parents) == (("root", "finger2-1.L"), (-1, 0))
    assert known.kept.tolist() == [0, 1, 2, 4, 6]
    assert known.faces.tolist() == [[0, 1, 2], [1, 2, 3], [3, 4, 0]]
    assert known.weights == pytest.approx(
        np.array([[0.75, 0.25], [1.0, 0.0], [0.9, 0.1], [0.4, 0.6], [0.4, 0.6]])
    )


@pytest.mark.parametrize(
    ("bone", "size_m"),
    [("head", 0.008), ("neck03", 0.008), ("neck02", 0), ("finger3-1.L", 0.008), ("wrist.R", 0.008),
     ("metacarpal1.L", 0.008), ("foot.L", 0.012), ("toe3-1.R", 0.012), ("lowerarm02.L", 0)],
)  # fmt: skip
def test_the_surface_is_finest_about_hands_feet_and_head(bone: str, size_m: float) -> None:
    assert anatomy._cell_m(bone) == size_m


@pytest.mark.parametrize(
    ("chance", "span"),
    [(0.14, (0.48, 0.6)), (0.16, (0.8, 1.0)), (0.34, (0.8, 1.0)), (0.36, (0.6, 0.8))],
)
def test_a_phenotype_is_of_the_age_and_build_that_chance_has(
    chance: float, span: tuple[float, float]
) -> None:
    """One in seven is a youth, one in five old; one in ten is between man and woman."""
    rng: Any = Chance(chance, 0.25, 0.09, 0.7, 0.4, -9.0, 9.0, 0.5, 1.0, -1.0, 0.0)
    found = figures._phenotype(rng)
    assert rng.asked[0] == span
    assert found["age"] == pytest.approx(0.75 * span[0] + 0.25 * span[1])
    assert found["gender"] == 0.7
    assert {name: found[name] for name in ("african", "asian", "caucasian")} == {
        "african": 0.2, "asian": 0.3, "caucasian": 0.5,
    }  # fmt: skip
    assert (found["muscle"], found["weight"]) == (0.02, 0.98)
    rest = {name: found[name] for name in ("height", "proportions", "cupsize", "firmness")}
    due = {"height": 0.41, "proportions": 0.75, "cupsize": 0.3, "firmness": 0.5}
    assert rest == pytest.approx(due)
    rng = Chance(chance, 0.25, 0.11, 0.5, 0.6, *[0.0] * 6)
    assert figures._phenotype(rng)["gender"] == pytest.approx(1.0 - 0.06)
    assert rng.asked[1] == [0.5, 0.5, 0.5]


def test_a_figure_stands_on_its_soles_with_knees_where_they_bend(use: Use) -> None:
    bones = {name: at + np.array([0.0, 0.5, 0.0]) for name, at in heads().items()}
    there = np.array([[at[0], -at[2], at[1]] for at in bones.values()])
    asked: list[Any] = []

    class Model:
        def get_phenotype_blendshape_coefficients(self, **how: float) -> str:
            asked.append({*how})
            return "shape"

        def get_rest_model(self, shape: str) -> dict[str, Tensor]:
            assert shape == "shape"
            vertices = [[[0, 0, 0.3], [0.1, 0, 0.5], [0, -0.2, 2.2]]]
            return {"rest_vertices": Tensor(vertices), "rest_bone_heads": Tensor([there])}

    use(Anatomy(Model(), np.array([1, 2]), np.zeros(0, int), np.zeros(0), BONES, PARENTS))
    figure = figures.anny_figure(np.random.default_rng(3))
    assert figure.vertices_m == pytest.approx(np.array([[0.1, 0.0, 0.0], [0.0, 1.7, 0.2]]))
    ours = heads()
    assert figure.heads_m["neck01"] == pytest.approx(ours["neck01"])
    for side, sign in (("L", 1.0), ("R", -1.06)):
        knee, ankle = ours[f"lowerleg01.{side}"], ours[f"foot.{side}"]
        assert figure.heads_m[f"foot.{side}"] == pytest.approx(ankle)
        due = [sign * (0.1 + 0.06 * 0.01), 0.48 - 0.06 * 0.41, 0.01 - 0.06 * 0.04]
        assert figure.heads_m[f"lowerleg01.{side}"] == pytest.approx(due)
        assert knee[1] == 0.48
    assert asked[0] >= {"gender", "age", "muscle", "asian"}
    crown = figure.crown_m()
    assert crown[1] == pytest.approx(1.7)
    assert crown[0] == 0.0
    assert crown[2] == pytest.approx(-0.02 + HEAD_FORWARD * (1.7 - 1.42))


ARM_AT, FORE_AT = np.array([0.17, 1.38, -0.01]), np.array([0.35, 1.15, 0.0])
WRIST_AT, HIP_AT = np.array([0.5, 0.95, 0.1]), np.array([0.09, 0.92, 0.0])
KNEE_AT, ANKLE_AT = np.array([0.1, 0.48, 0.01]), np.array([0.11, 0.07, -0.03])


def way(start: np.ndarray, end: np.ndarray, share: float, right: bool = False) -> Any:
    turn = np.array([-1.06 if right else 1.0, 1.0, 1.0])
    return tuple((turn * (start + share * (end - start))).tolist())


def test_a_vertex_lies_along_the_limb_whose_bone_it_hangs_on(use: Use) -> None:
    """By hand: a quarter of the way is a quarter, on either side."""
    known, figure = hanging_on(
        [
            ("upperarm02.L", way(ARM_AT, FORE_AT, 0.25)),
            ("clavicle.R", way(ARM_AT, FORE_AT, -0.5, right=True)),
            ("lowerarm01.R", way(FORE_AT, WRIST_AT, 0.4, right=True)),
            ("finger3-2.L", way(WRIST_AT, 2 * WRIST_AT - FORE_AT, 0.6)),
            ("wrist.R", way(WRIST_AT, 2 * WRIST_AT - FORE_AT, -0.2, right=True)),
            ("pelvis.L", way(HIP_AT, KNEE_AT, -0.1)),
            ("upperleg02.R", way(HIP_AT, KNEE_AT, 0.75, right=True)),
            ("lowerleg02.L", way(KNEE_AT, ANKLE_AT, 0.3)),
            ("toe3-1.R", (0.0, 0.0, 0.0)),
            ("root", (0.0, 1.0, 0.0)),
            ("spine05", (0.0, 1.0, 0.0)),
            ("spine01", (0.0, 1.3, 0.0)),
            ("neck02", (0.0, 1.5, 0.0)),
        ]
    )
    known.weights[11, BONES.index("neck01")], known.weights[11, BONES.index("spine01")] = 0.3, 0.7
    use(known)
    near = limb_regions.regions(figure)
    N = NOWHERE
    assert near.arm == pytest.approx([0.25, -0.5, 1.4, 2.6, 2.0, N, N, N, N, N, N, N, N])
    assert near.leg == pytest.approx([N, N, N, N, N, -0.1, 0.75, 1.3, 3.0, SEAT, SEAT, N, N])
    assert near.head == pytest.approx([0.0] * 11 + [0.3, 1.0])


def test_cloth_falls_from_the_widest_place_by_three_hundredths_a_ring(use: Use) -> None:
    """A hoop about the middle of a body's depth; below it is nothing to go round."""
    use(puppet()[0])
    around = np.linspace(0.0, 2 * np.pi, 1000)
    hoop = np.stack([0.2 * np.sin(around), np.full(1000, 1.0), 0.2 * np.cos(around) + 0.05], axis=1)
    tube = skirt.tube_about(hoop, (1.0, 0.4), 0.02)
    rings = tube.vertices_m.reshape(7, 28, 3)
    assert rings[:, 0, 1] == pytest.approx(np.linspace(1.0, 0.4, 7))
    assert (rings[..., 1] == rings[:, :1, 1]).all()
    radii = np.linalg.norm(rings[..., [0, 2]] - [0.0, 0.05], axis=2)
    assert radii == pytest.approx(0.22, rel=2e-3)
    assert rings[0, 7] == pytest.approx([0.22, 1.0, 0.05], abs=1e-3)  # a quarter from ahead is left
    low = hoop - [0.0, 0.06, 0.0]
    both = np.concatenate([hoop, low * [0.5, 1.0, 0.5] + [0, 0, 0.025]])
    narrow = skirt.tube_about(both, (1.0, 0.94), 0.0).vertices_m.reshape(7, 28, 3)
    widths = np.linalg.norm(narrow[..., [0, 2]] - [0.0, 0.05], axis=2).mean(axis=1)
    reach = [0.2] * 4 + [0.2 * 0.97**n for n in (1, 2, 3)]  # 4 cm about a height is what it meets
    assert widths == pytest.approx(reach, rel=5e-3)


def test_cloth_is_a_closed_band_of_faces_seen_from_outside(use: Use) -> None:
    faces = skirt._faces()
    assert faces.shape == (2 * 6 * 28, 3)
    assert faces[[0, 27]].tolist() == [[0, 28, 1], [27, 55, 0]]
    assert faces[[168, 195]].tolist() == [[1, 28, 29], [0, 55, 28]]
    assert np.bincount(faces.ravel()).tolist() == [3] * 28 + [6] * 140 + [3] * 28


def test_cloth_follows_the_thighs_from_the_pelvis_down(use: Use) -> None:
    """By hand: half way down it follows by half of 0.85, and 5 cm to the left a thigh by 0.75."""
    use(puppet()[0])
    places = np.array(
        [[0.2, 0.96, 0], [0.05, 0.8, 0], [-0.3, 0.6, 0], [0.0, 0.725, 0], [0.1, 0.6, 0]]
    )
    weights = skirt._weights(places, 1.0)
    named = {
        name: weights[:, BONES.index(name)] for name in ("root", "upperleg02.L", "upperleg02.R")
    }
    share = 0.85 * 0.75**2 * (3 - 1.5)
    follow = np.array([0.0, 0.425, 0.85, share, 0.85])
    assert named["root"] == pytest.approx(1 - follow)
    assert named["upperleg02.L"] == pytest.approx(follow * [1, 0.75, 0, 0.5, 1])
    assert named["upperleg02.R"] == pytest.approx(follow * [0, 0.25, 1, 0.5, 0])
    assert weights.sum(axis=1) == pytest.approx(1.0)


def test_normals_of_a_cube_point_out_of_its_corners() -> None:
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    # each square twice, cut along either diagonal, so that its corners weigh the same
    cuts = ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3))
    faces = [[quad[corner] for corner in cut] for quad in quads for cut in cuts]
    found = cloth._normals(corners, np.array(faces))
    assert found == pytest.approx((2 * corners - 1) / np.sqrt(3))


def some_regions() -> tuple[Figure, Regions, list[str]]:
    """Vertices at the edges of what is worn, and what a plain look has there: shirt down to 1 cm
    below the hips (0.92), sleeves to 1.85 of the arm, legs to 1.9, shoes to 3.5 cm over ankles."""
    rows: list[tuple[tuple[float, float, float], float, float, float, str]] = [
        ((0.0, 1.3, 0.1), NOWHERE, NOWHERE, 0.0, "shirt"),
        ((0.0, 1.41, -0.02), NOWHERE, NOWHERE, 0.3, "skin"),  # over the collar, 1.40 behind
        ((0.0, 1.39, -0.02), NOWHERE, NOWHERE, 0.3, "shirt"),
        ((0.0, 1.35, 0.08), NOWHERE, NOWHERE, 0.0, "skin"),  # it is 6 cm lower 10 cm ahead
        ((0.0, 1.33, 0.08), NOWHERE, NOWHERE, 0.0, "shirt"),
        ((0.13, 1.45, -0.02), -0.3, NOWHERE, 0.0, "shirt"),  # a shoulder
        ((0.11, 1.45, -0.02), -0.3, NOWHERE, 0.0, "skin"),
        ((-0.11, 1.45, -0.02), -0.1, NOWHERE, 0.0, "shirt"),
        ((0.0, 1.2, 0.0), NOWHERE, NOWHERE, 0.91, "skin"),
        ((0.4, 1.1, 0.0), 1.84, NOWHERE, 0.0, "shirt"),
        ((0.4, 1.1, 0.0), 1.86, NOWHERE, 0.0, "skin"),
        ((0.4, 0.8, 0.0), 1.5, NOWHERE, 0.0, "shirt"),
        ((0.1, 0.905, 0.0), NOWHERE, 0.1, 0.0, "trousers"),
        ((0.1, 0.915, 0.0), NOWHERE, 0.1, 0.0, "shirt"),
        ((0.1, 0.3, 0.0), NOWHERE, 1.89, 0.0, "trousers"),
        ((0.1, 0.3, 0.0), NOWHERE, 1.91, 0.0, "skin"),
        ((0.1, 0.10, 0.0), NOWHERE, 1.95, 0.0, "shoes"),
        ((0.1, 0.11, 0.0), NOWHERE, 1.95, 0.0, "skin"),
        ((0.1, 0.10, 0.0), NOWHERE, 1.8, 0.0, "trousers"),  # a leg's end hangs over the shoe
        ((0.1, 0.06, 0.0), NOWHERE, 1.8, 0.0, "shoes"),
        ((0.1, 0.06, 0.0), NOWHERE, 1.2, 0.0, "trousers"),
        ((0.1, 0.2, 0.0), NOWHERE, 2.6, 0.0, "shoes"),
        ((0.1, 0.2, 0.0), NOWHERE, 2.4, 0.0, "skin"),
    ]
    places = np.array([row[0] for row in rows])
    arm, leg, head = (np.array([row[k] for row in rows]) for k in (1, 2, 3))
    return Figure(places, heads()), Regions(arm, leg, head), [row[4] for row in rows]


def test_what_is_worn_ends_where_the_look_and_chance_have_it() -> None:
    figure, near, due = some_regions()
    chance: Any = Chance(0.5, 0.5, 0.5, 0.5, 0.1, 0.5)
    wear = cloth._worn(figure, near, PLAIN, 0.92, chance)
    collar = 1.42 - 0.02  # and 0.6 m lower a metre ahead
    assert figure.heads_m["neck01"][1] + 0.5 * (-0.075 + 0.035) == pytest.approx(collar)
    names = [*MATERIAL]
    assert [names[one] for one in wear] == due
    spans = [(-0.075, 0.035), (0.2, 1.0), (1.7, 2.0), (1.75, 2.05), (0.0, 0.07)]
    assert chance.asked == spans
    booted: Any = Chance(0.5, 0.5, 0.5, 0.5, 0.09, 0.5)
    short = PLAIN._replace(sleeve="short", shorts=True)
    wear = cloth._worn(figure, near, short, 0.92, booted)
    assert booted.asked[2:] == [(0.4, 0.95), (0.35, 1.2), (0.1, 0.3)]
    assert [names[wear[n]] for n in (9, 12, 14, 17, 22)] == [
        "skin",
        "trousers",
        "skin",
        "shoes",
        "shoes",
    ]


def test_cloth_is_off_the_skin_by_its_looseness_where_it_sags(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By hand, without folds: a shirt a quarter at the neck, all of it at the hips and elbows."""
    monkeypatch.setattr(cloth, "folds", lambda places, _: np.full(len(places), 0.5))
    places = np.array([[0, 1.32, 0], [0, 1.12, 0], [0, 0.92, 0], [0.3, 1.2, 0], [0.1, 0.6, 0],
                       [0.1, 0.3, 0], [0.1, 0.95, 0], [0.1, 0.02, 0], [0, 1.7, 0]])  # fmt: skip
    wear = np.array(
        [MATERIAL[name] for name in ("shirt",) * 4 + ("trousers",) * 3 + ("shoes", "skin")]
    )
    arm = np.array([NOWHERE] * 3 + [0.5] + [NOWHERE] * 5)
    leg = np.array([NOWHERE] * 4 + [0.6, 1.8, -0.3, 3.0, NOWHERE])
    near, figure = Regions(arm, leg, np.zeros(9)), Figure(places, heads())
    chance: Any = Chance(1.0, 0.25)
    found = cloth._off(figure, near, PLAIN, wear, chance)
    assert chance.asked == [(-0.01, 0.035), (0.006, 0.014)]
    top = [0.02 * share for share in (0.25, 0.625, 1.0, 0.625)]
    legs = [0.03 * 0.65, 0.03 + 0.035, 0.03 * 0.3]
    assert found == pytest.approx([1.15 * each for each in (*top, *legs)] + [0.008, 0.0])
    tight: Any = Chance(0.0, 0.25)
    close = PLAIN._replace(loose_top_m=0.0, loose_legs_m=0.0)
    found = cloth._off(figure, near, close, wear, tight)
    assert found == pytest.approx([0.003] * 7 + [0.008, 0.0])


@pytest.fixture
def plain_cloth(monkeypatch: pytest.MonkeyPatch, use: Use) -> Iterator[Figure]:
    """A body all of whose choices are made by hand; hair and face are asked for, no more."""
    known, figure = puppet()
    use(known)
    asked: list[Any] = []
    monkeypatch.setattr(cloth, "grow_hair", lambda *told: asked.append(told))
    monkeypatch.setattr(cloth, "paint_face", lambda *told: asked.append(told))
    yield figure
    (body, head, cut, wear, off_m, _), (same, painted) = asked
    assert body is same is figure
    assert head == pytest.approx(limb_regions.regions(figure).head)
    assert cut == "short"
    assert painted is wear
    assert off_m.shape == wear.shape == head.shape


@pytest.mark.parametrize(
    ("hem_m", "share", "material", "lowest_m"),
    [
        (0.02, 0.06, "", 0.0),
        (0.04, 0.06, "shirt", 0.88),
        (0.13, 0.04, "shirt", 0.79),
        (0.02, 0.04, "trousers", 0.92 - 0.15 - 0.25 * 0.45),
    ],
    ids=["shirt", "long shirt", "coat", "skirt"],
)
def test_what_hangs_below_the_hips_is_a_long_shirt_a_coat_or_a_skirt(
    plain_cloth: Figure,
    monkeypatch: pytest.MonkeyPatch,
    hem_m: float,
    share: float,
    material: str,
    lowest_m: float,
) -> None:
    asked: list[Any] = []
    tube_about = skirt.tube_about

    def about(inside: np.ndarray, reach: tuple[float, float], room: float) -> Any:
        asked.append((inside, reach, room))
        return tube_about(inside, reach, room)

    figure, shares = plain_cloth, [share] if hem_m < 0.12 else []
    chance: Any = Chance(*shares, *[0.5] * 6, 0.5, 0.5, 0.25)
    monkeypatch.setattr(cloth, "tube_about", about)
    monkeypatch.setattr(cloth, "folds", lambda places, _: np.zeros(len(places)))
    dressed = cloth.anny_dressed(figure, PLAIN._replace(hem_m=hem_m), chance)
    count, known = len(figure.vertices_m), puppet()[0]
    if not material:
        assert (len(dressed.vertices_m), asked) == (count, [])
        assert (dressed.faces == known.faces).all()
        return
    ((inside, reach, room),) = asked
    assert reach == pytest.approx((0.99, lowest_m))
    assert room == pytest.approx(0.3 * (0.03 if material == "trousers" else 0.02))
    assert len(dressed.vertices_m) == count + 7 * 28 == len(dressed.weights)
    tube = slice(len(known.faces), None)
    assert (dressed.materials[tube] == MATERIAL[material]).all()
    assert dressed.faces[tube].min() == count
    assert dressed.vertices_m[count:, 1].min() == pytest.approx(lowest_m)
    near = limb_regions.regions(figure)
    legs = (near.leg > -0.8) & (near.leg < 1.9)
    assert inside == pytest.approx(dressed.vertices_m[:count][legs])
    bare = (near.leg > 0.35) & (near.leg < 1.6) & (figure.vertices_m[:, 1] > 0.2)
    wear = {MATERIAL["skin"]} if material == "trousers" else {MATERIAL["trousers"]}
    of_legs = bare[known.faces].all(axis=1)
    assert {*dressed.materials[: len(known.faces)][of_legs].tolist()} == wear


def test_a_face_is_of_the_middle_one_of_its_corners_materials(plain_cloth: Figure) -> None:
    known, near = puppet()[0], limb_regions.regions(plain_cloth)
    chance: Any = Chance(*[0.5] * 6)
    wear = cloth._worn(plain_cloth, near, PLAIN, 0.92, chance)
    chance = Chance(0.5, *[0.5] * 6, 0.5, 0.5)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(cloth, "folds", lambda places, _: np.zeros(len(places)))
        dressed = cloth.anny_dressed(plain_cloth, PLAIN, chance)
    middle = [int(np.median(wear[list(face)])) for face in known.faces]
    assert dressed.materials.tolist() == middle
    off = dressed.vertices_m - plain_cloth.vertices_m
    ways = cloth._normals(plain_cloth.vertices_m, known.faces)
    shirt = wear == MATERIAL["shirt"]
    assert ((off * ways).sum(axis=1)[shirt] >= 0.003 - 1e-9).all()
    assert off[wear == MATERIAL["skin"]] == pytest.approx(0.0)


def head_of(*rows: tuple[float, float, float]) -> Figure:
    """Vertices of a head whose back is at -0.1, whose nose is at 0.1 and whose crown at 1.74 m, so
    that (aside, share of its height, share of its depth) are theirs."""
    rows = ((0.0, 1.0, 0.5), (0.0, 0.5, 0.0), (0.0, 0.5, 1.0), *rows)
    places = [(x, 1.42 + 0.32 * up, -0.1 + 0.2 * ahead) for x, up, ahead in rows]
    return Figure(np.array(places), heads())


def grown(
    figure: Figure, cut: Any, *shares: float, head: float = 1.0
) -> tuple[list[bool], np.ndarray, Chance]:
    """Where hair grows of the named vertices, how far it stands off, and what was asked."""
    count, chance = len(figure.vertices_m), Chance(*shares)
    wear, off_m = np.zeros(count, np.int64), np.zeros(count)
    follows = np.array([1.0] * 3 + [head] * (count - 3))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(hair_and_face, "folds", lambda places, _: np.full(len(places), 0.5))
        hair_and_face.grow_hair(figure, follows, cut, wear, off_m, chance)  # type: ignore[arg-type]
    assert chance.shares == []
    return (wear == MATERIAL["hair"])[3:].tolist(), off_m[3:], chance


def test_short_hair_ends_at_the_neck_the_ear_the_temple_and_the_brow() -> None:
    """By hand, at a brow of 0.85: 0.42 up to the ear, 0.62 at the temple, 0.85 over the eyes."""
    edges = [(0.42, 0.0), (0.42, 0.4), (0.62, 0.56), (0.85, 0.74), (0.91, 1.0)]
    figure = head_of(*((0.0, up + off, at) for up, at in edges for off in (0.01, -0.01)))
    hair, off_m, chance = grown(figure, "short", 0.5, 0.5, 0.5)
    assert hair == [True, False] * 5
    assert chance.asked == [(0.004, 0.03), (0.8, 0.9)]
    assert off_m[hair] == pytest.approx(0.017 * 1.15)
    assert grown(figure, "short", 0.5, 0.5, 0.5, head=0.55)[0] == hair  # half of it is a head
    assert grown(figure, "short", 0.5, 0.5, 0.5, head=0.45)[0] == [False] * 10
    assert off_m[~np.array(hair)] == pytest.approx(0.0)


def test_a_bob_hangs_behind_the_neck_and_is_thicker_there_and_a_bald_head_has_no_hair() -> None:
    """Half of those with a bob have it longer: here by 8 cm."""
    behind = head_of((0.1, -0.2, 0.1), (0.12, -0.2, 0.1), (0.0, -0.3, 0.1), (0.0, -0.2, 0.45))
    assert grown(behind, "bob", 0.5, 0.5, 0.49, 0.5, 0.5, head=0.4)[0] == [
        True,
        False,
        False,
        False,
    ]
    assert grown(behind, "bob", 0.5, 0.5, 0.51, 0.5, head=0.4)[0] == [False] * 4
    on_head = head_of((0.0, -0.05, 0.1), (0.0, 0.29, 0.1), (0.0, 0.31, 0.1))
    hair, off_m, _ = grown(on_head, "bob", 0.0, 0.5, 0.9, 0.5)
    assert hair == [True] * 3
    assert off_m == pytest.approx([0.0046 + 0.015, 0.0046 + 0.015, 0.0046])
    assert grown(on_head, "bald", 0.5, 0.5)[0] == [False] * 3


def test_a_tail_has_a_knot_behind() -> None:
    """At three quarters of the height: 5 cm at its middle, a fraction e of it 3.5 cm aside."""
    figure = head_of((0.0, 0.75, 0.0), (0.035, 0.75, 0.0), (0.0, 0.37, 0.1), (0.0, 0.35, 0.1))
    hair, off_m, chance = grown(figure, "tail", 0.5, 0.5, 0.5, 0.5)
    assert hair == [True, True, True, False]
    assert chance.asked[2] == (0.55, 0.95)
    puff_m = 0.017 * 1.15
    assert off_m[:2] == pytest.approx([puff_m + 0.05, puff_m + 0.05 * np.exp(-1)])


def test_a_beard_grows_about_the_chin_of_one_in_eight() -> None:
    figure = head_of(
        (0, 0.11, 0.46), (0, 0.09, 0.46), (0, 0.35, 0.9), (0, 0.37, 0.9), (0, 0.2, 0.44)
    )
    hair, off_m, chance = grown(figure, "bald", 0.5, 0.11, 0.5)
    assert hair == [True, False, True, False, False]
    assert off_m == pytest.approx([0.0065, 0, 0.0065, 0, 0])
    assert chance.asked[1] == (0.001, 0.012)
    assert grown(figure, "bald", 0.5, 0.13)[0] == [False] * 5


def test_eyes_brows_and_lips_are_painted_where_there_is_skin_in_front() -> None:
    """Eyes at 3 cm aside and 1.62 m up, flatter than wide; of what is worn nothing is painted."""
    rows = [
        (0.03, 1.62, 0.09, "dark"), (-0.045, 1.62, 0.09, "dark"), (0.047, 1.62, 0.09, "skin"),
        (0.03, 1.629, 0.09, "dark"), (0.03, 1.631, 0.09, "skin"), (0.03, 1.62, 0.084, "skin"),
        (0.011, 1.642, 0.09, "hair"), (0.051, 1.642, 0.09, "skin"), (-0.03, 1.647, 0.09, "hair"),
        (0.03, 1.649, 0.09, "skin"), (0.0, 1.548, 0.1, "lips"), (0.023, 1.556, 0.1, "lips"),
        (-0.025, 1.548, 0.1, "skin"), (0.0, 1.558, 0.1, "skin"), (0.0, 1.538, 0.1, "skin"),
    ]  # fmt: skip
    figure = Figure(np.array([row[:3] for row in rows]), heads())
    wear = np.full(len(rows), MATERIAL["skin"])
    hair_and_face.paint_face(figure, wear)
    assert [[*MATERIAL][one] for one in wear] == [row[3] for row in rows]
    worn = np.full(len(rows), MATERIAL["shirt"])
    hair_and_face.paint_face(figure, worn)
    assert (worn == MATERIAL["shirt"]).all()


def some_angles(count: int = 12) -> np.ndarray:
    angles = np.random.default_rng(2).uniform(-40.0, 70.0, (count, len(ANGLES)))
    bent = ["elbow" in name or "knee" in name for name in ANGLES]
    angles[:, bent] = np.abs(angles[:, bent])
    angles[:, ["foot" in name for name in ANGLES]] = 0.5
    return angles


def unit(joints: np.ndarray, start: str, end: str) -> np.ndarray:
    found = joints[:, JOINT_NAMES.index(end)] - joints[:, JOINT_NAMES.index(start)]
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def test_limbs_of_the_puppet_point_where_ours_do_and_keep_its_lengths(use: Use) -> None:
    known, figure = puppet()
    use(known)
    someone, angles = person(100_001), some_angles()
    ours = posed(someone.measures, angles, np.zeros(2)).joints_m
    ours = ours[:, [JOINTS.index(name) for name in JOINT_NAMES]]
    body = retarget.retargeted(figure, someone.measures, angles, np.random.default_rng(3))
    for side, own in (("L", "l"), ("R", "r")):
        for start, end, bones in (
            ("elbow", "wrist", ("lowerarm01", "wrist")),
            ("knee", "ankle", ("lowerleg01", "foot")),
        ):
            ends = f"{own}_{start}", f"{own}_{end}"
            assert (unit(ours, *ends) * unit(body.joints_m, *ends)).sum(axis=1).min() > 0.99
            way_m = (
                body.joints_m[:, JOINT_NAMES.index(ends[1])]
                - body.joints_m[:, JOINT_NAMES.index(ends[0])]
            )
            rest_m = figure.heads_m[f"{bones[1]}.{side}"] - figure.heads_m[f"{bones[0]}.{side}"]
            assert np.linalg.norm(way_m, axis=1).mean() == pytest.approx(
                np.linalg.norm(rest_m), rel=0.02
            )
    frames = bone_frames(someone.measures, {name: angles[:, i] for i, name in enumerate(ANGLES)})
    assert body.front == pytest.approx(frames[:, BONE_INDEX["chest"], :3, 2])
    pelvis = frames[:, 0, :, :3]
    hips = [figure.heads_m[f"upperleg01.{side}"] - figure.heads_m["root"] for side in "LR"]
    middle = np.einsum("nij,j->ni", pelvis, (hips[0] + hips[1]) / 2)
    assert body.joints_m[:, JOINT_NAMES.index("pelvis")] == pytest.approx(middle)
    left = np.einsum("nij,j->ni", pelvis, hips[0])
    assert body.joints_m[:, JOINT_NAMES.index("l_hip")] == pytest.approx(left)


def test_a_puppet_that_stands_straight_has_its_spine_above_its_pelvis(use: Use) -> None:
    """Nothing turns in the trunk: places are those at rest, from the root; arms come to hang."""
    known, figure = puppet()
    use(known)
    straight = np.zeros((1, len(ANGLES)))
    body = retarget.retargeted(figure, person(3).measures, straight, np.random.default_rng(3))
    for name in ("spine03", "neck01", "head", "clavicle.L", "clavicle.R", "upperleg01.R"):
        at = body.places_m[0, BONES.index(name)]
        assert at == pytest.approx(figure.heads_m[name] - figure.heads_m["root"])
    head_top = body.joints_m[0, JOINT_NAMES.index("head_top")]
    assert head_top == pytest.approx(figure.crown_m() - figure.heads_m["root"])
    for side in "LR":
        upper, fore, hand = (
            body.places_m[0, BONES.index(f"{name}.{side}")]
            for name in ("upperarm01", "lowerarm01", "wrist")
        )
        length_m = np.linalg.norm(
            figure.heads_m[f"wrist.{side}"] - figure.heads_m[f"lowerarm01.{side}"]
        )
        assert hand - fore == pytest.approx([0.0, -length_m, 0.0], abs=1e-6)
        assert (fore - upper)[1] < -0.99 * np.linalg.norm(fore - upper)
        knee, ankle = (
            body.places_m[0, BONES.index(f"{name}.{side}")] for name in ("lowerleg01", "foot")
        )
        assert (ankle - knee)[[0, 2]] == pytest.approx(0.0, abs=1e-6)
        at = {
            name: figure.heads_m[f"{name}.{side}"] for name in ("upperarm01", "lowerarm01", "wrist")
        }
        hinge = np.cross(at["wrist"] - at["lowerarm01"], at["lowerarm01"] - at["upperarm01"])
        hinge = body.turns[0, BONES.index(f"upperarm02.{side}")] @ hinge / np.linalg.norm(hinge)
        assert hinge[0] > 0.98  # elbows bend ahead
        tip, knuckle = (
            body.places_m[0, BONES.index(f"finger3-{joint}.{side}")] for joint in (3, 1)
        )
        assert (tip - knuckle)[1] < 0.0
        toes = body.turns[0, BONES.index(f"foot.{side}")] @ (
            figure.heads_m[f"toe3-1.{side}"] - figure.heads_m[f"foot.{side}"]
        )
        assert toes[0] == pytest.approx(0.0, abs=1e-6)
        assert toes[2] > 0.1


def test_palms_face_the_body_and_by_30_degrees_elsewhere(use: Use) -> None:
    """Of arms that hang the index finger is ahead of the little one."""
    known, figure = puppet()
    use(known)
    body = retarget.retargeted(
        figure, person(3).measures, np.zeros((900, len(ANGLES))), np.random.default_rng(3)
    )
    for side in "LR":
        index, little = (
            body.places_m[:, BONES.index(f"finger{finger}-1.{side}")] for finger in (2, 5)
        )
        off_deg = np.degrees(np.arctan2((index - little)[:, 0], (index - little)[:, 2]))
        assert off_deg.mean() == pytest.approx(0.0, abs=4.0)
        assert off_deg.std() == pytest.approx(30.0, abs=3.0)
        tip, knuckle = (body.places_m[:, BONES.index(f"finger3-{n}.{side}"), 0] for n in (3, 1))
        inwards = -1.0 if side == "L" else 1.0
        assert np.median(inwards * (tip - knuckle)) > 0.01  # curled


def test_bones_turn_by_their_shares_of_the_way(use: Use) -> None:
    """A trunk that yaws by 40 degrees: its bones by 6, 20, 32, 40; a head by 20 more likewise."""
    known, figure = puppet()
    use(known)
    angles = np.zeros((1, len(ANGLES)))
    angles[0, ANGLES.index("torso_yaw")], angles[0, ANGLES.index("head_yaw")] = 40.0, 20.0
    body = retarget.retargeted(figure, person(3).measures, angles, np.random.default_rng(3))
    due = {"root": 0, "spine05": 6, "spine04": 20, "spine03": 32, "spine02": 40, "spine01": 40,
           "neck01": 46, "neck02": 51, "neck03": 56, "head": 60}  # fmt: skip
    for name, yaw_deg in due.items():
        turn = body.turns[0, BONES.index(name)]
        assert np.degrees(np.arctan2(turn[0, 2], turn[0, 0])) == pytest.approx(yaw_deg, abs=1e-4)
        assert turn[1] == pytest.approx([0, 1, 0], abs=1e-9)
    sideways = body.turns[0, BONES.index("eye.L")]
    assert sideways == pytest.approx(body.turns[0, BONES.index("head")])


def test_vertices_go_with_their_bones_by_their_weights(use: Use) -> None:
    known, figure = puppet()
    use(known)
    body = retarget.retargeted(figure, person(3).measures, some_angles(4), np.random.default_rng(3))
    weights = known.weights.copy()
    weights[:, 1:] = 0.75 * weights[:, 1:] + 0.25 * weights[:, :-1]
    weights /= weights.sum(axis=1, keepdims=True)
    found = retarget.hung(figure.vertices_m, weights, figure, body)
    for n in (0, 3):
        for v in (5, 200, 400):
            due = np.zeros(3)
            for b, name in enumerate(BONES):
                turned = body.turns[n, b] @ (figure.vertices_m[v] - figure.heads_m[name])
                due += weights[v, b] * (turned + body.places_m[n, b])
            assert found[n, v] == pytest.approx(due, abs=1e-5)


def test_examples_of_a_puppet_are_one_persons_and_look_as_they_say(
    use: Use, monkeypatch: pytest.MonkeyPatch
) -> None:
    known, figure = puppet()
    use(known)
    shown: list[Any] = []

    def pictured(one: Any, _: np.random.Generator) -> Any:
        shown.append(one)
        return None if len(shown) == 2 else len(shown)

    monkeypatch.setattr(anny_examples, "anny_figure", lambda _: figure)
    monkeypatch.setattr(anny_examples, "pictured", pictured)
    examples = [*anny_examples.anny_examples(4)]
    count, rng = PICTURES, np.random.default_rng([4, 83])
    someone = dressed(person(int(rng.integers(*PEOPLE))), rng)
    for material in ("shirt", "hair", "skin"):
        due = palette(someone.look)[MATERIAL[material]]
        assert shown[0].colours[MATERIAL[material]] == pytest.approx(due)
    assert (len(shown), examples) == (count, [1, *range(3, count + 1)])
    for one in shown:
        vertices, joints, front, stature_m = one[0], one[-3], one[-2], one[-1]
        assert vertices.shape == one[1].shape
        assert joints.shape == (15, 3)
        assert np.linalg.norm(front) == pytest.approx(1.0)
        assert stature_m == 1.74
        knee = joints[JOINT_NAMES.index("l_knee")]
        near = np.linalg.norm(figure.vertices_m - figure.heads_m["lowerleg01.L"], axis=1) < 0.05
        count = len(figure.vertices_m)
        assert np.linalg.norm(vertices[:count][near].mean(axis=0) - knee) < 0.05
    assert not np.allclose(shown[0][0], shown[1][0])


def test_eyes_are_darker_and_lips_redder_than_the_skin() -> None:
    look: Look = person(5).look
    chance: Any = Chance(0.5)
    colours = anny_examples._colours(look, chance)
    assert chance.asked == [(0.25, 0.7)]
    assert colours[MATERIAL["dark"]] == pytest.approx(0.475 * np.array(look.skin))
    assert colours[MATERIAL["lips"]] == pytest.approx(np.array([0.7, 0.7, 0.95]) * look.skin)
    assert colours[MATERIAL["skin"]] == pytest.approx(np.array(look.skin))


def test_folds_are_the_mean_of_four_waves() -> None:
    """By the numbers that the same seed draws, one wave after the other."""
    places = np.random.default_rng(1).normal(size=(7, 3))
    rng = np.random.default_rng(9)
    ways, rates = rng.normal(size=(4, 3)), rng.uniform(18.0, 75.0, (4, 1))
    begins = rng.uniform(0.0, 2 * np.pi, 4)
    due = np.zeros(7)
    for wave in range(4):
        along = places @ (ways[wave] / np.linalg.norm(ways[wave])) * rates[wave, 0]
        due += 0.5 * np.sin(along + begins[wave])
    assert folds(places, np.random.default_rng(9)) == pytest.approx(due)
