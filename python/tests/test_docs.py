"""What documentation and notebooks show in Python runs."""

import doctest
import re
import runpy
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import kinetarium._engine

PAGES = sorted((Path(__file__).parents[2] / "docs/guide").glob("*.md"))
SNIPPET = re.compile(r"^```python\n(.*?)^```", re.M | re.S)
PYTHON = [page for page in PAGES if "import kinetarium" in page.read_text(encoding="utf-8")]
# Installed by those who want them.
OPTIONAL = ("stable_baselines3", "torch")

NOTEBOOKS = sorted((Path(__file__).parents[1] / "examples").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path, tmp_path):
    notebook = nbformat.read(path, as_version=4)
    there = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources=there).execute()


@pytest.mark.parametrize("page", PYTHON, ids=lambda page: page.stem)
def test_snippets(page, tmp_path, monkeypatch):
    """Those of a page, one after the other, as a reader enters them."""
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "snippet"}
    for text in SNIPPET.findall(page.read_text(encoding="utf-8")):
        if not any(f"import {name}" in text or f"from {name}" in text for name in OPTIONAL):
            exec(compile(text, page.name, "exec"), names)


EXAMPLES = [test for test in doctest.DocTestFinder().find(kinetarium._engine) if test.examples]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_docstrings_of_the_engine(example):
    """Those of the other modules are found by `pytest --doctest-modules`."""
    told = []
    assert doctest.DocTestRunner().run(example, out=told.append).failed == 0, "".join(told)


def test_the_engine_has_examples():
    assert "kinetarium._engine.Builder" in [example.name for example in EXAMPLES]


def test_stubs_have_the_docstrings_of_the_engine():
    script = Path(__file__).parents[1] / "tools/document_stubs.py"
    tool = runpy.run_path(str(script))
    stubs = tool["STUBS"].read_text(encoding="utf-8")
    assert tool["documented"](stubs) == stubs, "run python/tools/document_stubs.py"
