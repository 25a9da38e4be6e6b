"""Cameras that a file names."""

import os
from dataclasses import replace
from math import pi

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import DeviceError, RenderError, SensorError, UnknownNameError

CARD = os.environ.get("KINETARIUM_GPU")
"""A card, or a program such as Mesa's llvmpipe."""

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
        ({"light": "noon"}, "give a Light"),
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
    for wrong in ({"eye": (0, 0)}, {"target": "ball"}, {"up": [(0, 1), 0, 0]}):
        with pytest.raises(RenderError, match=f"camera's {next(iter(wrong))} is .*: give 3 numbers"):
            kn.Camera().looking(**{"eye": (0, 0, 0), "target": (1, 1, 1), **wrong})
    with pytest.raises(RenderError, match=r"camera's position is .*: give 3 numbers"):
        kn.Camera(position=("a", "b", "c"))
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


def test_sun_shadows_and_squares_are_the_camera_s_to_choose(sim):
    camera = replace(kn.Camera.of(sim.model, "above"), channels=("rgb", "depth"), checker=0.0)
    plain = sim.render(camera, worlds=0)
    floor = np.isclose(plain.depth[0], 5)

    def seen(**light):
        return sim.render(replace(camera, light=kn.Light(**light)), worlds=0).rgb[0][floor].astype(int)

    # From straight above, the rod's shadow is below it, where the camera does not see it.
    assert np.ptp(seen(to_sun=(0, 0, 1)), axis=0).max() <= 1
    aside = seen(to_sun=(0, 1, 1))
    assert np.ptp(aside[:, 0]) > 25
    assert np.ptp(seen(to_sun=(0, 1, 1), shadows=False), axis=0).max() <= 1
    red = seen(to_sun=(0, 0, 1), sun=(1, 0, 0), sky=(0, 0, 0))
    assert (red[:, 0] > 50).all() and (red[:, 1:] == 0).all()
    squares = sim.render(replace(camera, checker=0.5, light=kn.Light(to_sun=(0, 0, 1))), worlds=0).rgb[0][floor]
    assert np.ptp(squares[:, 0]) > 10
    with pytest.raises(RenderError, match="direction to the sun"):
        seen(to_sun=(0, 0, 0))
    with pytest.raises(RenderError, match="checker's squares is -1"):
        sim.render(replace(camera, checker=-1.0))
    with pytest.raises(RenderError, match="light's to_sun is 1: give 3 numbers"):
        kn.Light(to_sun=1)


def test_lamps_shine_where_they_are_and_where_their_body_is(sim):
    camera = replace(kn.Camera.of(sim.model, "above"), channels=("rgb", "depth"), checker=0.0)
    floor = np.isclose(sim.render(camera, worlds=0).depth[0], 5)
    dark = kn.Light(sun=(0, 0, 0), sky=(0, 0, 0), ground=(0, 0, 0))

    def seen(*lamps):
        rgb = sim.render(replace(camera, light=replace(dark, lamps=lamps)), worlds=0).rgb[0]
        return np.where(floor[..., None], rgb, 0).astype(int)

    assert not seen().any()
    beam = kn.Lamp("parallel", direction=(0, 0, -1), color=(0.5, 0, 0), shadows=False)
    red = seen(beam)
    assert np.ptp(red[floor], axis=0).max() == 0 and red[..., 0].any() and not red[..., 1:].any()
    spot = kn.Lamp("spot", position=(0, 0, 2), direction=(0, 0, -1), cutoff=0.3, shadows=False)
    lit = seen(spot)[..., 0] > 0
    assert 0 < lit.sum() < 0.7 * floor.sum()
    # On the rod, of which the origin is elsewhere in the other world.
    on_rod = replace(spot, body=sim.model.body_names[0], mode="track")
    assert (seen(on_rod)[..., 0] > 0).any()
    with pytest.raises(kn.errors.UnknownNameError, match="no body"):
        seen(kn.Lamp(body="nobody"))
    with pytest.raises(RenderError, match="cutoff"):
        seen(kn.Lamp("spot", cutoff=4.0))
    with pytest.raises(kn.errors.UnknownNameError, match="kind of lamps"):
        seen(kn.Lamp("neon"))
    with pytest.raises(RenderError, match="direction is"):
        kn.Lamp(direction=(0, 0, 0))
    with pytest.raises(RenderError, match="give Lamps"):
        kn.Light(lamps=["bulb"])


def test_images_of_a_card_that_is_not_there_are_refused(sim):
    with pytest.raises(DeviceError, match="has `no such card` in its name; found: "):
        sim.render("above", device="gpu:no such card")
    with pytest.raises(DeviceError, match="unknown device `cuda` for images; known are cpu, auto, gpu"):
        sim.render("above", device="cuda")
    with pytest.raises(SensorError, match="no such card"):
        eye = kn.sensors.Camera("eye", camera="above", device="gpu:no such card")
        kn.Simulation(sim.model, sensors=[eye])


@pytest.mark.skipif(CARD in (None, "cuda"), reason="KINETARIUM_GPU names no card")
def test_a_card_draws_what_rays_meet(sim):
    card = f"gpu:{CARD}"
    camera = replace(kn.Camera.of(sim.model, "above"), channels=("rgb", "depth", "body", "shape"))
    cast, drawn = sim.render(camera), sim.render(camera, device=card)
    np.testing.assert_allclose(drawn.depth, cast.depth, rtol=1e-4)
    assert (drawn.body == cast.body).mean() > 0.99 and (drawn.shape == cast.shape).mean() > 0.99
    assert abs(drawn.rgb.astype(int) - cast.rgb).mean() < 4
    eye = kn.sensors.Camera("eye", camera=camera, device=card)
    seeing = kn.Simulation(sim.model, worlds=2, sensors=[eye])
    assert (seeing.sensors["eye"].rgb == drawn.rgb).all()
    # What is asked for is drawn, or refused; by itself no program stands in for a card.
    fine = replace(camera, samples=4, occlusion=1)
    with pytest.raises(DeviceError, match="occlusion rays: ask for 0"):
        sim.render(fine, device=card)
    if "llvmpipe" in CARD:
        assert (sim.render(fine, device="auto").rgb == sim.render(fine).rgb).all()


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
