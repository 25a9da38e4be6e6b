"""The page about a simulation: in a browser, in a notebook, or at an address that is printed."""

from __future__ import annotations

from typing import Any

from kinetarium._engine import Viewer


class View:
    """A page that shows a simulation and steers it, as long as it is open; made by `Simulation.view`.

    In a notebook it is shown as a frame below the cell.
    """

    def __init__(self, viewer: Viewer, height: int) -> None:
        self._viewer = viewer
        self._height = height

    @property
    def url(self) -> str:
        """Where the page is, with its token where there is one."""
        return self._viewer.url

    @property
    def is_open(self) -> bool:
        """Whether the page is still served."""
        return self._viewer.is_open

    def close(self) -> None:
        """Stops serving."""
        self._viewer.close()

    def __repr__(self) -> str:
        return f"<View at {self.url}{'' if self.is_open else ', closed'}>"

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" width="100%" height="{self._height}" style="border: 0"></iframe>'


def in_notebook() -> bool:
    """Whether a notebook shows what a cell gives."""
    try:
        shell: Any = get_ipython()  # type: ignore[name-defined]
    except NameError:
        return False
    return hasattr(shell, "kernel")


def open_browser(url: str) -> bool:
    """Opens a page where there is a browser with a window; tells whether there is one."""
    import webbrowser  # seldom needed, and slow to import

    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    # Those that run in the terminal would take it over.
    return not isinstance(browser, webbrowser.GenericBrowser) and browser.open(url)
