"""The page about a simulation: in a browser, in a notebook, or at an address that is printed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

from kinetarium._engine import Viewer
from kinetarium.errors import ViewerError
from kinetarium.skins import Skin
from kinetarium.types import Vector

Wearable = Skin | Vector | str | PathLike[str]
"""A skin, or what one is made of."""
Skins = Mapping[str | tuple[str, ...] | None, Wearable]
"""Skins of bodies by their names; of several by a tuple of names, of all by none."""


class View:
    """A page that shows a simulation and steers it, as long as it is open; made by `Simulation.view`.

    In a notebook it is shown as a frame below the cell.
    """

    def __init__(self, viewer: Viewer, address: str | None, token: str | None) -> None:
        self._viewer = viewer
        self._address, self._token = address, token
        self._height = 600
        self._cell: int | None = None  # in which the frame is shown already

    @property
    def url(self) -> str:
        """Where the page is, with its token where there is one."""
        return self._viewer.url

    @property
    def is_open(self) -> bool:
        """Whether the page is still served, by this process: to one that was forked it is closed."""
        return self._viewer.is_open

    def dress(self, bodies: str | Sequence[str] | None, skin: Wearable, *, fitted: bool = True) -> None:
        """Has bodies wear a skin on the page: the one of this name, those of these names, or all of them (`None`),
        until they are dressed again. The physics does not know of it, nor do cameras.

        `skin` is a `Skin`, or what one is made of: a colour, a name, a path to a picture or a GLB model, which is
        `fitted` to the body or as large as in its file. It may be called at every step: pages are told with their
        frames, and of what was put on last. On the page a user may dress bodies otherwise until then.

        Raises `UnknownNameError` for a body that is not there, `ViewerError` where the page is closed, and what
        `Skin` raises; nothing is changed then.

        >>> import kinetarium as kn
        >>> sim = kn.Simulation(kn.examples.n_pendula(2))
        >>> view = sim.view(browser=False)  # doctest: +ELLIPSIS
        http://127.0.0.1:...
        >>> view.dress(None, "speed")
        >>> for _ in range(10):
        ...     lost = sim.step()
        ...     swing = abs(sim.state.joint_position[0, "hinge0"]) / 3.2
        ...     view.dress("link0", (min(swing, 1), 0.3, 0.3))
        >>> view.close()
        """
        names = [bodies] if isinstance(bodies, str) else bodies
        self._viewer.dress(names, Skin.of(skin, fitted=fitted)._skin)

    def close(self) -> None:
        """Stops serving; in a process that was forked it does nothing."""
        self._viewer.close()

    def _check(self, address: str | None, token: str | None) -> None:
        """`ViewerError` where it is not open at this address, with this token; any will do, if none are given."""
        if address not in (None, self._address) or token not in (None, self._token):
            wanted = "another token" if address in (None, self._address) else f'"{address}"'
            raise ViewerError(f"the page is open at {self.url}: close it (View.close) to open it at {wanted}")

    def _show(self, browser: bool, height: int) -> None:
        """Below the cell of a notebook, or in a browser, if that is wanted; else its address is printed."""
        self._height = height
        shell = notebook()
        if shell is not None:
            self._cell = shell.execution_count
            shell.display_pub.publish({"text/html": self._frame(), "text/plain": repr(self)})
        elif not (browser and open_browser(self.url)):
            print(self.url, flush=True)

    def __repr__(self) -> str:
        return f"<View at {self.url}{'' if self.is_open else ', closed'}>"

    def _repr_html_(self) -> str | None:
        shell = notebook()
        # Below a cell that has shown it already, as its last expression, its name is enough.
        return None if shell is not None and shell.execution_count == self._cell else self._frame()

    def _frame(self) -> str:
        return f'<iframe src="{self.url}" width="100%" height="{self._height}" style="border: 0"></iframe>'


def notebook() -> Any:
    """The shell of the notebook that runs this, which shows what a cell gives; none elsewhere."""
    try:
        shell: Any = get_ipython()  # type: ignore[name-defined]
    except NameError:
        return None
    return shell if hasattr(shell, "kernel") else None


def open_browser(url: str) -> bool:
    """Opens a page where there is a browser with a window; tells whether there is one."""
    import webbrowser  # seldom needed, and slow to import

    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    # Those that run in the terminal would take it over. BackgroundBrowser (xdg-open) derives from one, and does not.
    in_terminal = webbrowser.GenericBrowser, getattr(webbrowser, "Elinks", None)
    return type(browser) not in in_terminal and browser.open(url)
