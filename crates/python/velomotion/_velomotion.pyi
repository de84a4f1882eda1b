"""The compiled module: its docstrings have shapes and units (help(velomotion))."""

from collections.abc import Iterator, Sequence
from os import PathLike
from typing import Any, Literal, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, PathLike[str]]
_Model = Literal["vlp16", "hi-res", "hdl32e", "vlp32c"]
_Lidar = Literal["vlp16", "hi-res", "hdl32e", "vlp32c", "hdl64e", "utm30lx", "lms151"]
_Rows = NDArray[np.void]

__all__ = [
    "Frames",
    "Log",
    "__version__",
    "calibrate",
    "density",
    "frames",
    "k",
    "plan",
    "read",
    "simulate",
]

__version__: str

def read(
    path: _Path,
    *,
    tilt: Union[_Path, ArrayLike, None] = None,
    mount: Union[_Path, float, None] = None,
    sensor: str | None = None,
    model: _Model | None = None,
    calibration: _Path | None = None,
    time: Literal["host", "utc"] = "host",
    equal_returns: Literal["once", "twice"] = "once",
    fields: Sequence[str] | None = None,
) -> _Rows: ...
def frames(
    path: _Path,
    *,
    tilt: Union[_Path, ArrayLike, None] = None,
    mount: Union[_Path, float, None] = None,
    sensor: str | None = None,
    model: _Model | None = None,
    calibration: _Path | None = None,
    time: Literal["host", "utc"] = "host",
    equal_returns: Literal["once", "twice"] = "once",
    fields: Sequence[str] | None = None,
    cut: float = 0.0,
) -> Frames: ...
def density(
    source: Union[str, ArrayLike], *, level: int = 4, origin: Sequence[float] | None = None
) -> dict[str, Any]: ...
def k(
    source: Union[str, ArrayLike],
    *,
    bins: int = 151,
    error: float = 1e-4,
    origin: Sequence[float] | None = None,
) -> dict[str, Any]: ...
def plan(
    *,
    at_m: float = 20.0,
    error_mm: float | None = None,
    gap_deg: float | None = None,
    time_s: float | None = None,
    lidar: _Lidar | None = None,
    rpm: Union[int, Sequence[int], None] = None,
    range_sd_m: float | None = None,
    mount_sd_deg: float | None = None,
    from_deg: float | None = None,
    to_deg: float | None = None,
    config: _Path | None = None,
    device: str | None = None,
) -> dict[str, Any]: ...
def calibrate(
    logs: Union[_Path, Sequence[_Path]],
    *,
    mount: Union[_Path, float, None] = None,
    fix: Sequence[str] = ...,
    level_floor: bool = False,
) -> dict[str, Any]: ...
def simulate(
    scene: _Path,
    output: _Path,
    *,
    truth: _Path | None = None,
    seed: int | None = None,
    without: Sequence[str] = ...,
    tolerance: str | None = None,
    threads: int | None = None,
    force: bool = False,
) -> dict[str, Any]: ...
@final
class Frames:
    def __iter__(self) -> Iterator[_Rows]: ...
    def __next__(self) -> _Rows: ...

@final
class Log:
    def __new__(cls, path: _Path, *, sensor: str | None = None) -> Log: ...
    def info(self) -> dict[str, Any]: ...
    def packets(self) -> _Rows: ...
    def polls(self) -> _Rows: ...
    def angles(self) -> _Rows: ...
    def sweeps(self) -> _Rows: ...
    def clocks(self) -> _Rows: ...
