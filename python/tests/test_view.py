"""The page, pictures, plots and the program, as Python starts them."""

import json
import os
import socket
import subprocess
import sys
import urllib.request
import webbrowser

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

import kinetarium as kn
from kinetarium.errors import (
    FileError,
    OutOfRangeError,
    RenderError,
    ShapeError,
    SimulationError,
    SkinError,
    UnknownNameError,
    ViewerError,
)
from kinetarium.view import open_browser


def test_a_page_is_served_until_it_is_closed(capsys):
    sim = kn.Simulation(kn.examples.n_pendula(3), worlds=4, dtype="float64")
    view = sim.view(browser=False)
    assert view.url in capsys.readouterr().out
    with urllib.request.urlopen(view.url) as page:
        assert b"<html" in page.read()
    assert f'src="{view.url}"' in view._repr_html_()
    sim.step(10)
    assert sim.view(browser=False) is view
    view.close()
    assert not view.is_open
    with pytest.raises(OSError):
        urllib.request.urlopen(view.url, timeout=5)
    assert sim.step(10).size == 0
    again = sim.view(browser=False)
    sim.close()
    assert not again.is_open


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_forked_process_leaves_the_page_alone():
    program = """
import os, pytest, sys, urllib.request
import kinetarium as kn
from kinetarium.errors import ForkedError, ViewerError

sim = kn.Simulation(kn.examples.n_pendula(2))
view = sim.view(browser=False)

def use():
    assert not view.is_open
    with pytest.raises(ForkedError):
        sim.view(browser=False)
    with pytest.raises(ViewerError):
        view.dress(None, "plain")

def drop():
    global sim, view
    del sim, view

for do in use, lambda: view.close(), lambda: sim.close(), drop, sys.exit:
    child = os.fork()
    if child == 0:
        do()
        sys.exit()
    assert os.waitpid(child, 0)[1] == 0, do
with urllib.request.urlopen(view.url, timeout=5) as page:
    print(view.is_open, b"<html" in page.read())
"""
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", program]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert ran.stderr == "" and ran.stdout.split()[1:] == ["True", "True"], ran.stderr


def test_an_open_page_stays_at_its_address():
    sim = kn.Simulation(kn.examples.n_pendula(1))
    view = sim.view(address="127.0.0.1:0", browser=False)
    assert sim.view(address="127.0.0.1:0", browser=False) is view
    with pytest.raises(ViewerError, match=f'open at {view.url}.*close it.*"127.0.0.1:7357"'):
        sim.view(address="127.0.0.1:7357", browser=False)
    with pytest.raises(ViewerError, match="another token"):
        sim.view(token="secret", browser=False)
    view.close()
    assert sim.view(token="secret", browser=False) is not view
    sim.close()


def test_a_notebook_has_the_page_below_the_cell():
    cells = [
        "import kinetarium as kn\nsim = kn.Simulation(kn.examples.n_pendula(2))\nsim.view()\nsim.step(10)",
        "from urllib.request import urlopen\npage = urlopen(sim.view(browser=False).url)\nb'<html' in page.read()",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in cells])
    NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    first, second = (cell.outputs for cell in notebook.cells)
    shown = [out.data["text/html"] for out in first if out.output_type == "display_data"]
    assert len(shown) == 1 and "<iframe" in shown[0], first
    assert second[-1].data["text/plain"] == "True"


def test_browsers_with_a_window_are_opened(monkeypatch):
    opened = []
    for browser in (
        webbrowser.BackgroundBrowser("xdg-open"),
        webbrowser.Chrome("chrome"),
        webbrowser.GenericBrowser("w3m"),
    ):
        monkeypatch.setattr(type(browser), "open", lambda self, url, *_: not opened.append(self.name))
        monkeypatch.setattr(webbrowser, "get", lambda browser=browser: browser)
        assert open_browser("http://127.0.0.1") is (browser.name != "w3m")
    assert opened == ["xdg-open", "chrome"]


def test_addresses_are_checked():
    sim = kn.Simulation(kn.examples.n_pendula(1))
    with pytest.raises(ViewerError, match=r"give one as 127\.0\.0\.1:7357"):
        sim.view(address="localhost", browser=False)


def test_pictures():
    sim = kn.Simulation(kn.examples.n_pendula(3), worlds=3)
    picture = sim.render()
    assert picture.rgb.shape == (1, 480, 640, 3) and picture.rgb.dtype == np.uint8
    assert picture.rgb.std() > 5
    camera = kn.Camera(40, 30, channels=("rgb", "depth", "body", "shape", "normal"), body="link0")
    images = sim.render(camera, worlds=[2, 0])
    assert images.normal.shape == (2, 30, 40, 3) and images.depth.dtype == np.float32
    with pytest.raises(UnknownNameError, match="heat"):
        sim.render(kn.Camera(channels=("heat",)))
    with pytest.raises(RenderError, match="field of view"):
        sim.render(kn.Camera(field_of_view=4.0))
    with pytest.raises(UnknownNameError, match="link9"):
        sim.render(kn.Camera(body="link9"))


def test_the_program_is_the_same(tmp_path):
    program = [sys.executable, "-m", "kinetarium"]
    told = subprocess.run([*program, "--version"], capture_output=True, text=True, check=True)
    assert told.stdout == f"kinetarium {kn.__version__}\n"
    wrong = subprocess.run([*program, "run", "missing.xml"], capture_output=True, text=True, cwd=tmp_path)
    assert wrong.returncode == 2 and "missing.xml" in wrong.stderr


def test_import_brings_no_more_than_numpy():
    code = "import kinetarium, sys; print([m for m in ('gymnasium', 'matplotlib', 'torch') if m in sys.modules])"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout == "[]\n"


def test_modules_come_when_they_are_asked_for():
    code = """import kinetarium as kn
assert {"plot", "types", "sensors"} <= set(dir(kn)) and not hasattr(kn, "plots")
kn.plot.record, kn.types.Vector
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_what_cannot_be_imported_is_no_attribute():
    code = """import inspect, pydoc, sys
sys.modules["gymnasium"] = None  # as if it were not installed
import kinetarium as kn
assert not hasattr(kn, "envs") and "envs" not in dir(kn)
assert "Simulation" in dict(inspect.getmembers(kn)) and "Simulation" in pydoc.render_doc(kn)
try:
    kn.envs
except AttributeError as error:
    assert error.__cause__ and str(error) == "kinetarium.envs needs gymnasium: `pip install gymnasium`", error
try:
    from kinetarium import envs
except ModuleNotFoundError as error:
    assert "gymnasium" in error.name
else:
    raise AssertionError
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_plots(tmp_path):
    pytest.importorskip("matplotlib")
    from kinetarium import plot

    sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2)
    track = plot.record(sim, {"joint_position": None, "kinetic_energy": None}, seconds=0.1)
    assert track["time"].shape == (51,) and track["joint_position"].shape == (51, 2, 3)
    figure = plot.over_time(track, "joint_position", names=sim.model.coordinate_names, world=1)
    figure.savefig(tmp_path / "joints.png")
    assert (tmp_path / "joints.png").stat().st_size > 5000
    for error, options in [
        (UnknownNameError, {"quantity": "x"}),
        (OutOfRangeError, {"quantity": "kinetic_energy", "world": 2}),
        (ShapeError, {"quantity": "joint_position", "names": ["one"]}),
    ]:
        with pytest.raises(error):
            plot.over_time(track, **options)
    for options in ({"seconds": -1}, {"seconds": np.inf}, {"seconds": 1, "every": 0}):
        with pytest.raises(SimulationError, match="it must be"):
            plot.record(sim, {}, **options)
    with pytest.raises(SimulationError, match='named "time"'):
        plot.record(sim, {"time": lambda s: s.time}, seconds=0.1)


def websocket(url: str) -> socket.socket:
    """A page's connection to its engine, as browsers open it."""
    host, port = url.removeprefix("http://").rstrip("/").split(":")
    connection = socket.create_connection((host, int(port)), timeout=20)
    head = f"GET /session HTTP/1.1\r\nHost: {host}:{port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    head += "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    connection.sendall(head.encode())
    answer = b""
    while not answer.endswith(b"\r\n\r\n"):
        answer += connection.recv(1)
    return connection


def hear(connection: socket.socket, kind: str) -> dict:
    """The next text message of a type; all else is passed over, but for pings, which are answered as browsers do."""

    def take(count: int) -> bytes:
        taken = b""
        while len(taken) < count:
            part = connection.recv(count - len(taken))
            assert part, "the page was sent away"
            taken += part
        return taken

    while True:
        opcode, length = take(2)
        wide = {126: 2, 127: 8}.get(length)
        content = take(int.from_bytes(take(wide), "big") if wide else length)
        if opcode & 15 == 9:
            connection.sendall(bytes([0x8A, 0x80 | len(content)]) + bytes(4) + content)
        if opcode & 15 == 1 and (message := json.loads(content))["type"] == kind:
            return message


def test_the_page_has_its_turn_in_many_steps_and_a_key_may_close_it():
    program = """
import signal, sys, threading
import kinetarium as kn
sim = kn.Simulation(kn.examples.n_pendula(3), worlds=256)
view = sim.view(browser=False)
def close(*_):
    view.close()
    raise KeyboardInterrupt
signal.signal(signal.SIGINT, close)
threading.Thread(target=lambda: sys.stdin.readline() and signal.raise_signal(signal.SIGINT), daemon=True).start()
try:
    sim.step(10**9)
except KeyboardInterrupt:
    print(view.is_open, sim.time[0] > 0)
"""
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as running:
        try:
            with websocket(running.stdout.readline().strip()) as page:
                while hear(page, "status")["steps"] == 0:
                    pass
                told, _ = running.communicate("\n", timeout=60)
        finally:
            running.kill()
    assert told.split() == ["False", "True"]


GREEN = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c49444154789c6360f8cf000002"
    "0201007b0981780000000049454e44ae426082"
)


def test_bodies_wear_what_the_program_says(tmp_path):
    path = tmp_path / "green.png"
    path.write_bytes(GREEN)
    sim = kn.Simulation(kn.examples.n_pendula(3))
    before = sim.state.body_position.copy()
    view = sim.view(browser=False, skins={None: "speed", ("link0", "link1"): "#ff8000"})
    page = websocket(view.url)
    worn = hear(page, "dress")["outfits"]
    assert [outfit["bodies"] for outfit in worn] == [None, [0, 1]]
    assert worn[0]["skin"] == {"kind": "gauge", "gauge": "speed"}
    assert worn[1]["skin"]["color"] == pytest.approx([1, 128 / 255, 0, 1])
    view.dress("link2", str(path), fitted=False)
    file = hear(page, "skin_file")
    assert (file["name"], file["format"]) == ("green.png", "png")
    (outfit,) = hear(page, "dress")["outfits"]
    assert outfit == {"bodies": [2], "skin": {"kind": "file", "file": file["id"], "fitted": False}}
    for red in np.linspace(0, 1, 1001):
        view.dress("link0", (red, 0, 0, 0.5))
    while hear(page, "dress")["outfits"][0]["skin"]["color"] != [1, 0, 0, 0.5]:
        pass
    assert (sim.state.body_position == before).all() and sim.time[0] == 0
    assert sim.view(browser=False, skins={"link0": kn.Skin(path)}) is view
    assert hear(page, "dress")["outfits"][0]["bodies"] == [0]
    page.close()
    view.close()
    with pytest.raises(ViewerError, match="closed"):
        view.dress(None, "plain")


def test_skins_that_cannot_be_are_refused(tmp_path):
    sim = kn.Simulation(kn.examples.n_pendula(1))
    text, long = tmp_path / "skin.png", tmp_path / "long.png"
    text.write_text("no picture")
    long.write_bytes(GREEN.ljust((16 << 20) + 1))
    cases = [
        (UnknownNameError, "did you mean", "hight"),
        (FileError, "missing.glb cannot be read", tmp_path / "missing.glb"),
        (FileError, "first bytes", str(text)),
        (FileError, "longer than 16 MB", long),
        (SkinError, "each from 0 to 1", (0, 0, 1.5)),
        (SkinError, "each from 0 to 1", [np.nan, 0, 0]),
        (SkinError, "give a colour", (1, 2)),
        (SkinError, "give a colour", "#12345"),
        (SkinError, "give a colour", "#12345g"),
        (SkinError, "give a colour", None),
    ]
    for error, message, skin in cases:
        with pytest.raises(error, match=message):
            kn.Skin(skin)
    with pytest.raises(UnknownNameError, match="link9"):
        sim.view(browser=False, skins={"link9": "plain"})
    view = sim.view(browser=False)
    with pytest.raises(UnknownNameError, match='did you mean "link0"'):
        view.dress(["link0", "link9"], "spin")
    sim.close()
