# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of the tools within this process: the functions of lib/app/python/engine.h, with arrays of numpy."""
import builtins
import concurrent.futures
import ctypes
import glob
import json
import os
import threading
import typing

import numpy as np
import numpy.typing

from landfall import errors, tools

Path = str | os.PathLike[str]
Numbers = np.typing.NDArray[np.float64]
Trace = typing.Callable[[Numbers, Numbers], Numbers]

FOLDER = os.path.dirname(os.path.realpath(tools.find("scan-sim")))  # of the tools that the library belongs to


def _loaded() -> ctypes.CDLL:
    beside = os.path.join(os.path.dirname(FOLDER), "lib")
    places = [os.path.join(beside, "landfall/liblandfall.so"), *glob.glob(os.path.join(beside, "*/landfall/liblandfall.so"))]
    path = next(filter(os.path.exists, places), places[0])
    try:
        return ctypes.CDLL(path)
    except OSError as error:
        raise errors.Error(f"{path}: cannot be loaded: {error}") from error


_library = _loaded()


def _call(name: str, *arguments: typing.Any, returns: typing.Any = ctypes.c_bool) -> typing.Any:
    """Calls a function. Arrays become pointers, texts UTF-8; returned texts remain bytes."""
    function = getattr(_library, "landfall_" + name)
    function.restype = returns
    result = function(*map(_argument, arguments))
    if result is None or result is False:
        raise _failure()
    return result


def _argument(value: typing.Any) -> typing.Any:
    if isinstance(value, np.ndarray):
        if not (value.flags.c_contiguous and value.dtype.isnative):
            raise TypeError("an array is not in C order")
        return ctypes.c_void_p(value.ctypes.data)
    if isinstance(value, _Object):
        return value.address
    if isinstance(value, bool):
        return ctypes.c_bool(value)
    if isinstance(value, int):
        return ctypes.c_int64(value)
    if isinstance(value, float):
        return ctypes.c_double(value)
    return _bytes(value) if isinstance(value, (str, os.PathLike)) else value


def _bytes(text: Path) -> bytes:
    found = os.fspath(text).encode(errors="surrogateescape")
    if b"\0" in found:
        raise errors.UsageError(f"{os.fspath(text)}: a text holds a null character")
    return found


def _failure() -> BaseException:
    kind, function = ctypes.c_char_p(), _library.landfall_failure
    function.restype = ctypes.c_char_p
    message, name = function(ctypes.byref(kind)).decode(errors="surrogateescape"), (kind.value or b"").decode()
    return (getattr(errors, name, None) or getattr(builtins, name))(message)


def _json(name: str, *arguments: typing.Any) -> typing.Any:
    return json.loads(_call(name, *arguments, returns=ctypes.c_char_p))


class _Object:
    """An object of the library, which lives as long as this."""

    def __init__(self, kind: str, *arguments: typing.Any) -> None:
        self.address = ctypes.c_void_p()
        self.address = ctypes.c_void_p(_call("new_" + kind, *arguments, returns=ctypes.c_void_p))

    def __del__(self, delete: typing.Any = _library.landfall_delete) -> None:
        delete(self.address)


_call("start")


class File(_Object):
    """A file in memory."""

    def __init__(self, name: str) -> None:
        super().__init__("file", name)
        self.name = name

    def members(self, group: str) -> list[tuple[str, bool]]:
        """The names of a group's members, in their order, and whether each is a group."""
        return [(name, is_group) for name, is_group in _json("file_members", self, group)]

    def attributes(self, path: str) -> dict[str, typing.Any]:
        """Attributes as str, numpy's numbers or arrays."""
        return {name: value if isinstance(value, str) else
                np.frombuffer(bytes(value["bytes"]), value["type"]).reshape(value["shape"])[()]
                for name, value in _json("file_attributes", self, path).items()}

    def values(self, path: str) -> typing.Any:
        """The values of a dataset: an array, or the text."""
        values = _Memory("values", self, path)
        return values.text if values.text is not None else np.asarray(values)

    def load(self, path: Path) -> None:
        _call("file_load", self, path)

    def save(self, path: Path, overwrite: bool) -> None:
        _call("file_save", self, path, overwrite)


class _Memory(_Object):
    """A text, or the memory of the library beneath an array, which keeps this."""

    def __init__(self, kind: str, *arguments: typing.Any) -> None:
        super().__init__(kind, *arguments)
        content = _json(kind, self)
        self.text = content if isinstance(content, str) else None
        if self.text is None:
            self.__array_interface__ = {"version": 3, "typestr": np.dtype(content["type"]).str, "shape": tuple(content["shape"]),
                                        "data": (content["address"], True)}


class Surface(_Object):
    """A terrain that answers questions; from any thread."""

    def __init__(self, file: str) -> None:
        super().__init__("surface", file)

    def elevation(self, x_m: Numbers, y_m: Numbers, threads: int) -> Numbers:
        z_m = np.empty(x_m.size)
        _call("surface_elevation", self, x_m.size, x_m, y_m, z_m, threads)
        return z_m

    def first_hit(self, origins: Numbers, directions: Numbers, threads: int) -> Numbers:
        ranges_m = np.empty(len(origins))
        _call("surface_first_hit", self, len(origins), origins, directions, ranges_m, threads)
        return ranges_m


class _Pulses(ctypes.Structure):
    """PulseArrays, of arrays of N pulses; poses are rows of x, y, z, then w, x, y, z."""
    _fields_ = [("count", ctypes.c_size_t)] + [(name, ctypes.c_void_p) for name in ("numbers", "truth", "estimates", "nominals", "t_s")]

    def __init__(self, numbers: np.typing.NDArray[np.int64], *others: Numbers | None) -> None:
        super().__init__(len(numbers), *map(_argument, (numbers, *others)))
        self.arrays: tuple[typing.Any, ...] = (numbers, *others)  # live as long as this

    def __getitem__(self, place: int) -> "_Pulses":
        one = slice(place, place + 1)
        numbers, *others = self.arrays
        return _Pulses(numbers[one], *(None if array is None else array[one] for array in others))


class Lidar(_Object):
    """`terrain`: a Surface, or a function that gets origins and directions, (N, 3), of a pulse and returns N ranges."""

    def __init__(self, config: str, terrain: Surface | Trace) -> None:
        super().__init__("lidar", config, terrain if isinstance(terrain, Surface) else None)
        self._trace = None if isinstance(terrain, Surface) else terrain
        about = _json("lidar", self)
        self.pulse_rate_hz: float = about["pulse_rate_hz"]
        self.pixel_count: int = about["pixel_count"]
        self.pulse_limit: int | None = about["pulse_limit"]
        self._record = np.dtype(about["record"])

    def pulses(self, numbers: np.typing.NDArray[np.int64], truth: Numbers, estimates: Numbers | None, nominals: Numbers | None,
               t_s: Numbers | None, threads: int) -> np.typing.NDArray[typing.Any]:
        """Records of shape (pulses, pixels); poses are rows of x, y, z, then w, x, y, z."""
        pulses = _Pulses(numbers, truth, estimates, nominals, t_s)
        records = np.empty((len(numbers), self.pixel_count), self._record)
        if self._trace is None:
            _call("lidar_pulses", self, ctypes.byref(pulses), None, records, threads)
            return records
        for place, record in enumerate(records):
            pulse = pulses[place]
            ranges_m = _traced(np.asarray(_Memory("rays", self, ctypes.byref(pulse))), self._trace)
            _call("lidar_pulses", self, ctypes.byref(pulse), ranges_m, record, threads)
        return records


def _traced(rays: Numbers, trace: Trace) -> Numbers:
    if len(rays) == 0:
        return np.empty(0)
    ranges_m = trace(rays[:, 0].copy(), rays[:, 1].copy())
    if ranges_m.size != len(rays):
        raise errors.UsageError(f"terrain: the function returned {ranges_m.size} ranges of {len(rays)} rays")
    return ranges_m


def run(words: typing.Sequence[str], standard_input: str,
        progress: typing.Callable[[str, float], None] | None) -> tuple[int, str, list[str], str]:
    """Runs a tool: (exit code, message, warnings, printed text)."""
    text = standard_input.encode()
    task = _Object("run", (ctypes.c_char_p * len(words))(*map(_bytes, words)), len(words), text, len(text))
    if progress is None and threading.current_thread() is not threading.main_thread():
        _call("run_start", task)  # Python delivers Ctrl-C to its main thread only
    else:
        _run_beside(task, progress)
    code, message, warnings, printed = _json("run_result", task)
    return code, message, warnings, printed


def _run_beside(task: _Object, progress: typing.Callable[[str, float], None] | None) -> None:
    """On another thread, so that this one can pass on the progress, and end the run by an exception."""
    with concurrent.futures.ThreadPoolExecutor(1) as other:
        run_there = other.submit(_call, "run_start", task)
        try:
            while not concurrent.futures.wait([run_there], 0.02).done:
                if progress is not None:
                    _pass_on(task, progress)
        except BaseException:
            _call("run_cancel", task)
            raise
    run_there.result()


def _pass_on(task: _Object, progress: typing.Callable[[str, float], None]) -> None:
    fraction = ctypes.c_double()
    phase = _call("run_phase", task, ctypes.byref(fraction), returns=ctypes.c_char_p).decode(errors="replace")
    if phase:
        progress(phase, fraction.value)


def write_terrain(name: str, z: Numbers, resolution_m: float, crs: str, center: typing.Sequence[float]) -> None:
    _call("write_terrain", name, z, *z.shape, resolution_m, crs, np.array(center, np.float64))


def write_points(name: str, x: Numbers, y: Numbers, z: Numbers) -> None:
    _call("write_points", name, x.size, x, y, z)
