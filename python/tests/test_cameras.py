"""Cameras that a file names."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import RenderError, UnknownNameError

ROBOT = """
<mujoco><worldbody>
  <geom name="floor" type="plane" size="50 50 1"/>
  <camera name="above" pos="0 0 5" fovy="60" resolution="32 24"/>
  <body name="arm" pos="0 0 2">
    <joint type="hinge" axis="0 0 1"/>
    <geom name="rod" type="box" size="1 .1 .1"/>
    <camera name="hand" pos="0 0 1" quat="1 0 0 0"/>
    <camera name="beside" mode="track" pos="0 0 1"/>
  </body>
</worldbody></mujoco>
"""


@pytest.fixture
def sim():
    return kn.Simulation(kn.parse(ROBOT), worlds=2)


def test_the_model_s_cameras_go_by_their_names(sim):
    assert sim.model.camera_names == ["above", "hand", "beside"]
    above = kn.Camera.of(sim.model, "above")
    assert (above.width, above.height, above.body, above.mode) == (32, 24, None, "fixed")
    assert above.field_of_view == pytest.approx(pi / 3)
    assert (above.position, above.orientation) == ([0, 0, 5], [0, 0, 0, 1])
    assert sim.render("above").rgb.shape == (2, 24, 32, 3)
    # 5 m above the floor, beside the rod, whose upper face is 2.9 m below.
    depth = sim.render(replace(above, channels=("depth",))).depth
    assert depth[0, 0, 0] == pytest.approx(5.0, abs=1e-5)
    assert depth[0, 12, 16] == pytest.approx(2.9, abs=1e-5)
    with pytest.raises(UnknownNameError, match='did you mean "above"'):
        sim.render("abov")
    eye = kn.Simulation(sim.model, worlds=2, sensors=[kn.sensors.Camera("eye", camera="above")])
    assert (eye.sensors["eye"].rgb == sim.render("above").rgb).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"principal": (1, 1)}, "without focal"),
        ({"channels": ()}, "one or more"),
        ({"channels": "rgb"}, "one or more"),
        ({"width": 0}, "width is 0"),
        ({"height": -1}, "height is -1"),
        ({"occlusion": -1}, "occlusion is -1"),
        ({"focal": 60.0}, "focal is 60.0: give 2 numbers"),
        ({"orientation": (0, 0, 1)}, "give 4 numbers"),
    ],
)
def test_cameras_that_cannot_be(options, message):
    with pytest.raises(RenderError, match=message):
        kn.Camera(**options)


def test_no_camera_looks_at_itself(sim):
    for target in [(1, 2, 3), (np.nan, 0, 0)]:
        with pytest.raises(RenderError, match="give two points"):
            kn.Camera().looking((1, 2, 3), target)
    with pytest.raises(RenderError, match="camera's up is"):
        kn.Camera().looking((1, 2, 3), (0, 0, 0), up=(0, 0, 0))
    with pytest.raises(TypeError, match=r"width is 9\.5: it must be a whole number"):
        kn.Camera(9.5)
    with pytest.raises(RenderError, match="the camera is 3: give a Camera"):
        sim.render(3)
    with pytest.raises(ValueError, match="width is 0"):
        sim.framing(width=0)


def test_notebooks_show_images(sim, tmp_path):
    images = sim.render("above")
    assert images == images and replace(images, rgb=None)._repr_png_() is None
    matplotlib = pytest.importorskip("matplotlib.image")
    (tmp_path / "image.png").write_bytes(images._repr_png_())
    shown = matplotlib.imread(tmp_path / "image.png")
    assert (np.round(255 * shown[..., :3]) == images.rgb[0]).all()


def test_a_camera_turns_with_its_body_or_tracks_it(sim):
    sim.set_state(joint_position=np.array([[0.0], [0.7]]))
    views = {name: replace(kn.Camera.of(sim.model, name), channels=("shape",)) for name in ("hand", "beside")}
    hand, beside = (sim.render(view).shape for view in views.values())
    # Seen from the hand, the rod stands still, whose image the other camera sees turn.
    assert (hand[0] == hand[1]).all() and (hand[0] == beside[0]).all()
    assert (beside[0] != beside[1]).any()
    with pytest.raises(UnknownNameError, match='no mode of cameras "ride"'):
        sim.render(replace(views["hand"], mode="ride"))


@pytest.mark.parametrize("lens", [{}, {"focal": (40, 50)}, {"focal": (40, 50), "principal": (10, 20)}])
def test_depth_and_calibration_make_points(sim, lens):
    camera = replace(kn.Camera.of(sim.model, "above"), channels=("depth", "shape"), **lens)
    images = sim.render(camera, worlds=0)
    v, u = np.indices(images.depth.shape[1:]) + 0.5
    seen = np.stack([u, v, np.ones_like(u)], axis=-1) * images.depth[0][..., None].astype(float)
    right, down, ahead = np.moveaxis(seen @ np.linalg.inv(camera.intrinsics).T, -1, 0)
    floor, rod = images.shape[0] == 0, images.shape[0] == 1
    np.testing.assert_allclose(5 - ahead[floor], 0, atol=1e-5)
    np.testing.assert_allclose(5 - ahead[rod & (ahead < 3)], 2.1, atol=1e-5)
    assert rod.any() and (abs(right[rod]) < 1.001).all() and (abs(down[rod]) < 0.101).all()


def test_meshes_are_read_when_a_model_is_first_seen(tmp_path):
    mesh = tmp_path / "roof.obj"
    mesh.write_text("v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "roof.xml").write_text("""
<mujoco><asset><mesh name="roof" file="roof.obj"/></asset><worldbody>
  <camera name="above" pos="0 0 5"/>
  <geom type="mesh" mesh="roof" contype="0" conaffinity="0"/>
</worldbody></mujoco>""")
    sim = kn.Simulation(kn.load(tmp_path / "roof.xml"), dt=0.01)
    first = sim.render("above").rgb
    mesh.unlink()
    assert (sim.render("above").rgb == first).all()
