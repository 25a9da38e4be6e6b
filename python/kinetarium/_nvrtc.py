"""NVRTC, which compiles kernels for CUDA, where pip has installed it."""

from __future__ import annotations

import ctypes
import importlib.util
from pathlib import Path

# In packages of NVIDIA's, such as nvidia-cuda-nvrtc-cu12, which torch brings along.
_PATTERNS = ("*/lib/libnvrtc.so.*", "*/bin/nvrtc64_*.dll", "*/bin/*/nvrtc64_*.dll")


def load() -> Path | None:
    """Loads it, so that the engine finds it by its name, as the system's linker does not look in Python's folders;
    its path, or none where there is none."""
    spec = importlib.util.find_spec("nvidia")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        for pattern in _PATTERNS:
            for file in sorted(Path(folder).glob(pattern), reverse=True):
                if ".alt." not in file.name:
                    ctypes.CDLL(str(file))
                    return file
    return None


def has_driver() -> bool:
    """Whether there is a driver of NVIDIA's."""
    for name in ("libcuda.so.1", "libcuda.so", "nvcuda.dll"):
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        return True
    return False
