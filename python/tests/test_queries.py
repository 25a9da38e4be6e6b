"""Queries about shapes: shapes of arrays, worlds, and what is refused. Their geometry is tested in Rust."""

import numpy as np
import pytest

import kinetarium as kn
from kinetarium import Geometry, Seen, Shape
from kinetarium.errors import ModelError, OutOfRangeError, ShapeError, SimulationError, UnknownNameError

BALL = Geometry.sphere(0.5)


@pytest.fixture
def sim():
    """A ball on a slider along y, in five worlds, above a floor; world k has it at 2 + k / 10 m. The ball is shape 0,
    the floor 1, and a box beside it 2: shapes of bodies come first."""
    world = kn.Builder("balls")
    things = world.object("things")
    things.scenery(Shape(Geometry.plane()))
    things.scenery(Shape(Geometry.box((1, 1, 1)), position=(9, 1, 0), collides=False, membership=2))
    ball = things.body("ball", BALL, position=(0, 2, 0))
    things.prismatic("slider", child=ball, axis=(0, 1, 0))
    sim = kn.Simulation(world.build(), worlds=5, dtype="float64")
    sim.set_state(0.1 * np.arange(5)[:, None])
    return sim


def test_a_shape_is_cast_in_one_world_and_in_several(sim):
    hits = sim.cast_shape(Geometry.sphere(0.25), [[0, 9, 0], [4, 9, 0], [0, 1, 0]], (0, -2, 0))
    assert hits.distance == pytest.approx([9 - 2.75, 8.75, 0.75])
    assert hits.shape.tolist() == [0, 1, 1] and hits.body.tolist() == [0, -1, -1]
    assert hits.position[0] == pytest.approx([0, 2.5, 0]) and hits.normal.shape == (3, 3)
    some = sim.cast_shape(Geometry.box((0.1, 0.1, 0.1)), (0, 9, 0), (0, -1, 0), worlds=[4, 1])
    assert some.distance == pytest.approx(np.array([[9 - 3.0], [9 - 2.7]]))
    starts = np.tile([0.0, 9.0, 0.0], (5, 2, 1))
    starts[:, 1, 0] = 4
    turned = sim.cast_shape(
        Geometry.capsule(0.1, 0.5), starts, (0, -1, 0), orientations=(0, 0, 1, 1), worlds=None, max_distance=8.0
    )
    assert turned.distance.shape == (5, 2) and turned.position.shape == (5, 2, 3)
    assert turned.distance[:, 0] == pytest.approx(6.4 - 0.1 * np.arange(5))
    assert np.isinf(turned.distance[:, 1]).all() and (turned.shape[:, 1] == -1).all()
    assert np.isnan(turned.normal[:, 1]).all() and (turned.body[:, 1] == -1).all()


def test_nearest_shapes_are_in_order_and_padded(sim):
    near = sim.nearest([[0, 1, 0], [0, 2.2, 0]], 3, max_distance=5.0)
    assert near.distance.shape == (2, 3) and near.normal.shape == (2, 3, 3)
    assert near.shape.tolist() == [[0, 1, -1], [0, 1, -1]]
    assert near.distance[:, :2] == pytest.approx(np.array([[0.5, 1.0], [-0.3, 2.2]]))
    for k in (4, 10**9, 2**62):
        assert sim.nearest((0, 1, 0), k).shape.tolist() == [[0, 1, 2]]
    everywhere = sim.nearest((0, 1, 0), worlds=None)
    assert everywhere.distance[:, 0, 0] == pytest.approx(0.5 + 0.1 * np.arange(5))
    sim.set_state(1.0, worlds=[3])
    assert sim.nearest((0, 2, 0), worlds=3).distance == pytest.approx(0.5)


def test_closest_points_and_overlaps_are_lists(sim):
    near = sim.closest_points([[0, 1, 0], [9, 5, 0], [9, 1, 0.5]], 0.9, worlds=[2, 0])
    assert near.world.tolist() == [2, 2, 0, 0] and near.query.tolist() == [0, 2, 0, 2]
    assert near.shape.tolist() == [0, 2, 0, 2] and near.body.tolist() == [0, -1, 0, -1]
    assert near.distance == pytest.approx([0.7, -0.5, 0.5, -0.5]) and len(near) == 4
    touched = sim.overlaps(Geometry.box((0.5, 1, 0.5)), [[0, 1, 0], [0, 1.5, 0]], worlds=[0, 3])
    assert touched.world.tolist() == [0, 0, 0, 3, 3, 3] and touched.query.tolist() == [0, 0, 1, 0, 0, 1]
    assert touched.shape.tolist() == [0, 1, 0, 0, 1, 0]
    assert touched.distance == pytest.approx([-0.5, 0, -1, -0.2, 0, -0.7]) and touched.normal.shape == (6, 3)
    assert len(sim.overlaps(BALL, np.zeros((0, 3)))) == 0


def test_some_shapes_are_not_seen(sim):
    def nearest(**seen):
        return sim.nearest((9, 3, 0), 3, seen=Seen(**seen)).shape[0].tolist()

    assert nearest() == [2, 1, 0]
    assert nearest(membership=2) == [2, -1, -1]
    assert nearest(colliding=True) == [1, 0, -1]
    assert nearest(except_bodies=["ball"]) == nearest(except_bodies=[0]) == [2, 1, -1]


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        (lambda s: s.cast_shape(BALL, (0, 0, 0), (0, 0, 0)), SimulationError, "direction of shape cast 0"),
        (lambda s: s.cast_shape(BALL, (0, np.nan, 0), (0, 1, 0)), SimulationError, "position of shape cast 0"),
        (lambda s: s.cast_shape(BALL, (0, 0, 0), (0, 1, 0), max_distance=-1.0), SimulationError, "largest distance"),
        (lambda s: s.cast_shape(Geometry.plane(), (0, 0, 0), (0, 1, 0)), SimulationError, "convex solid"),
        (lambda s: s.cast_shape(BALL, np.zeros((2, 3)), np.zeros((3, 3))), ShapeError, "do not broadcast"),
        (lambda s: s.cast_shape(BALL, (0, 0), (0, 1)), ShapeError, "positions has the shape"),
        (lambda s: s.overlaps(Geometry.sphere(-1.0), (0, 0, 0)), SimulationError, "half sizes of shape 0"),
        (lambda s: s.nearest(np.zeros((2, 2, 3))), ShapeError, "it must be"),
        (lambda s: s.nearest(np.zeros((2, 2, 3)), worlds=[0, 1, 2]), ShapeError, "do not broadcast"),
        (lambda s: s.nearest((0, 0, 0), 0), SimulationError, "k is 0"),
        (lambda s: s.nearest((0, 0, 0), worlds=5), OutOfRangeError, "world 5"),
        (lambda s: s.closest_points((0, 0, 0), -1.0), SimulationError, "largest distance is -1"),
        (lambda s: s.nearest((0, 0, 0), seen=Seen(except_bodies=[7])), OutOfRangeError, "body 7"),
        (lambda s: s.nearest((0, 0, 0), seen=Seen(except_bodies=[-1])), OutOfRangeError, "body -1 does not exist"),
        (lambda s: s.nearest((0, 0, 0), seen=Seen(except_bodies=[0.0])), TypeError, "its name or its row"),
        (lambda s: s.nearest((0, 0, 0), seen=Seen(except_bodies=["bal"])), UnknownNameError, "ball"),
        (lambda s: s.nearest((0, 0, 0), seen=Seen(except_bodies="ball")), TypeError, r"give a list, as \['ball'\]"),
        (lambda s: s.nearest((0, 0, 0), seen={}), TypeError, "give a Seen"),
        (lambda s: s.nearest((0, 0, 0), seen=Seen(membership=-1)), ModelError, "membership"),
    ],
)
def test_bad_queries_are_refused(sim, wrong, error, message):
    with pytest.raises(error, match=message):
        wrong(sim)
