# SPDX-License-Identifier: GPL-3.0-or-later
"""The pipeline in this process: arrays in, arrays out, no files (docs/user/python.md).

    terrain = landfall.Terrain("preset:paper")
    scan = landfall.scan("preset:paper", terrain)
    dem = landfall.grid(scan, terrain)
    landfall.evaluate(dem).metrics["requirements"]

Each function runs the tool of that stage on files in memory, so that every result equals the dataset of the file that the tool would write.
"""
import contextlib
import itertools
import json
import os
import shlex
import sys
import tempfile
import typing

import numpy as np
import numpy.typing

from landfall import engine, tools
from landfall.errors import DataError, printable, UsageError

Path = str | os.PathLike[str]
Config = typing.Mapping[str, typing.Any] | Path
Configs = Config | typing.Sequence[Config] | None
Array = np.typing.NDArray[typing.Any]
Progress = typing.Callable[[str, float], None] | None
Pose = tuple[typing.Any, typing.Any] | None

_numbers = itertools.count(1)
MAX_ROWS = 2**31 - 1
_KINDS = {"terrain-gen": "terrain", "scan-sim": "scan", "regrid": "dem", "dem-eval": "evaluation", "hazard-map": "hazards"}
# Options of the stages of `landfall run` that write more files.
_SIDES = ("--metrics", "--report", "--sites", "--score")


class Result:
    """A result of a stage, in memory. Its arrays share the memory of the library, cannot be changed, and may outlive it."""

    def __init__(self, file: engine.File) -> None:
        self._file = file

    @property
    def attrs(self) -> dict[str, typing.Any]:
        """The attributes of the file that the tool would write."""
        return self._file.attributes("/")

    def to_file(self, path: Path, overwrite: bool = False) -> None:
        """Writes the tool's file. UsageError if it exists and is not to be replaced."""
        self._file.save(os.fspath(path), overwrite)

    def _json(self, name: str) -> typing.Any:
        return json.loads(self._file.values(name)) if name in dict(self._file.members("/")) else None

    def _table(self, group: str) -> "Table":
        return Table(self._file, group)


class Table:
    """Columns of equal length, arrays of shape (rows,)."""

    def __init__(self, file: engine.File, group: str) -> None:
        self._file, self._group = file, group
        self.columns = tuple(name for name, is_group in file.members(group) if not is_group)

    def __getitem__(self, name: str) -> Array:
        if not isinstance(name, str) or name not in self.columns:
            raise KeyError(f"no column {name!r}; columns: {', '.join(self.columns)}")
        return self._file.values(f"/{self._group}/{name}")

    def __iter__(self) -> typing.Iterator[str]:
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __len__(self) -> int:
        return len(self[self.columns[0]])

    @property
    def attrs(self) -> dict[str, typing.Any]:
        return self._file.attributes("/" + self._group)

    @property
    def units(self) -> dict[str, str]:
        """{column: its unit}."""
        return {name: self._file.attributes(f"/{self._group}/{name}").get("units", "") for name in self.columns}

    def to_pandas(self) -> typing.Any:
        """A pandas.DataFrame of the same rows and columns."""
        from landfall import files
        return files.package("pandas").DataFrame({name: self[name] for name in self})


class Scan(Result):
    """The returns of a scan: a table, `scan["z_est"]`; `pulses` is the table of its pulses."""

    def __init__(self, file: engine.File) -> None:
        super().__init__(file)
        self.points = self._table("points")
        self.columns = self.points.columns

    @property
    def pulses(self) -> Table:
        return self._table("pulses")

    def __getitem__(self, name: str) -> Array:
        return self.points[name]

    def __iter__(self) -> typing.Iterator[str]:
        return iter(self.points)

    def __contains__(self, name: object) -> bool:
        return name in self.points

    def __len__(self) -> int:
        return len(self.points)


class Grid(Result):
    """Layers of shape (y, x): `grid["z_est"]` is an xarray.DataArray, `grid.layers` all of them as an xarray.Dataset."""

    def __init__(self, file: engine.File) -> None:
        super().__init__(file)
        self._dataset: typing.Any = None
        self._names = tuple(name for name, is_group in file.members("/")
                            if not is_group and name not in ("x", "y", "crs") and not name.endswith("_json"))

    @property
    def layers(self) -> typing.Any:
        if self._dataset is None:
            from landfall import files
            xarray = files.package("xarray")
            self._dataset = xarray.Dataset({name: self._variable(xarray, name) for name in self._names},
                                           {name: self._variable(xarray, name) for name in ("x", "y", "crs")}, self.attrs)
        return self._dataset

    def _variable(self, xarray: typing.Any, name: str) -> typing.Any:
        values, attributes = self._file.values("/" + name), self._file.attributes("/" + name)
        attributes = {key: value for key, value in attributes.items() if key not in ("CLASS", "NAME")}
        encoding = {key: attributes.pop(key)[0] for key in ("_FillValue",) if key in attributes}
        dimensions = ("y", "x") if values.ndim == 2 else (name,) * values.ndim
        return xarray.Variable(dimensions, values, attributes, encoding)

    def __getitem__(self, name: str) -> typing.Any:
        if not isinstance(name, str) or name not in (*self._names, "x", "y", "crs"):
            raise KeyError(f"no layer {name!r}; layers: {', '.join(self._names)}")
        return self.layers[name]

    def __iter__(self) -> typing.Iterator[str]:
        return iter(self._names)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def values(self, name: str) -> Array:
        """A layer as a numpy array, without xarray."""
        return self._file.values("/" + name)


class Evaluation(Grid):
    """`metrics` is the dict of metrics.json, `verdict` the sentences of the requirements; the layers are those of eval.h5."""

    def __init__(self, file: engine.File) -> None:
        super().__init__(file)
        self.metrics, self.verdict = self._json("metrics_json"), self._json("verdict_json")


class Hazards(Grid):
    """`sites` is the table of landing sites, `score` the dict of score.json or None without a truth; the layers are those of hazards.h5."""

    def __init__(self, file: engine.File) -> None:
        super().__init__(file)
        self.score = self._json("score_json")

    @property
    def sites(self) -> Table:
        return self._table("sites")


class Terrain:
    """A true terrain. `source`: a configuration of terrain-gen (a dict, a preset, a JSON file, or a list that is merged in order), or a terrain.h5.

    `z`: its elevations, (y, x), of a gridded one, metres; None of a mesh or a file.
    """

    def __init__(self, source: Configs | engine.File, *, threads: int = 0, progress: Progress = None, **options: typing.Any) -> None:
        self._threads = _threads(threads)
        self._surface: engine.Surface | None = None
        path = os.fspath(source) if isinstance(source, (str, os.PathLike)) else ""
        if isinstance(source, engine.File):
            self._file: engine.File | str = source
        elif path.endswith(".h5"):
            self._file = path
        else:
            self._file = _run("terrain-gen", source, (), options, threads, progress)

    @classmethod
    def from_array(cls, z: typing.Any, resolution_m: float, *, crs: str | None = None, center: typing.Sequence[float] | None = None,
                   threads: int = 0) -> "Terrain":
        """The terrain of an array of elevations, metres, NaN for holes: rows from south to north, columns from west to east, `resolution_m` apart, the
        origin of frame D at z[rows // 2, columns // 2]. `center`: that node's place in `crs`, a map or geographic CRS such as "EPSG:32632": x and y or
        longitude and latitude."""
        resolution_m = _resolution(resolution_m)
        _check_order(z, resolution_m)
        z = _array(z, "z", 2)
        if crs is not None and not (isinstance(crs, str) and crs):
            raise UsageError(f'crs: a text such as "EPSG:32632" is expected, not {crs!r}')
        if (crs is None) != (center is None):
            raise UsageError("crs and center belong together: the place of the origin in a CRS")
        place = [0.0, 0.0] if center is None else _array(center, "center", 1).tolist()
        if len(place) != 2 or not np.isfinite(place).all():
            raise UsageError(f"center: two finite numbers are expected, not {place}")
        file = _new_file("terrain")
        engine.write_terrain(file.name, z, resolution_m, crs or "", place)
        return cls(file, threads=threads)

    @property
    def surface(self) -> engine.Surface:
        if self._surface is None:
            self._surface = engine.Surface(_name(self._file))
        return self._surface

    @property
    def z(self) -> Array | None:
        file = self._file
        return file.values("/z") if isinstance(file, engine.File) and ("z", False) in file.members("/") else None

    def elevation(self, x: typing.Any, y: typing.Any) -> typing.Any:
        """The highest elevation at each x, y, metres, frame D; NaN off the terrain. The arrays are broadcast."""
        x, y = np.broadcast_arrays(_array(x, "x"), _array(y, "y"))
        if x.size > MAX_ROWS:
            raise UsageError(f"x and y: {x.size} values are more than 2^31 - 1")
        return self.surface.elevation(_flat(x), _flat(y), self._threads).reshape(x.shape)[()]

    def first_hit(self, origins: typing.Any, directions: typing.Any) -> Array:
        """Distance from each origin along its unit direction to the terrain, metres, NaN for a miss. Arrays of shape (N, 3), frame D."""
        origins, directions = _vectors(origins, "origins"), _vectors(directions, "directions")
        if origins.shape != directions.shape:
            raise UsageError(f"directions: shape {directions.shape}; origins have {origins.shape}")
        length = np.linalg.norm(directions, axis=1)
        if not np.all(np.abs(length - 1) <= 1e-6):
            raise UsageError("directions: not all are unit vectors, within 1e-6")
        if not np.isfinite(origins).all():
            raise UsageError("origins: not all numbers are finite")
        return self.surface.first_hit(origins, directions, self._threads)

    def to_file(self, path: Path, overwrite: bool = False) -> None:
        """Writes terrain.h5."""
        if not isinstance(self._file, engine.File):
            raise UsageError(f"{self._file}: is a file already")
        self._file.save(os.fspath(path), overwrite)


class Lidar:
    """A lidar within a simulation: for each pulse it gets the lander's poses, and gives its pixels.

    `config`: a configuration of scan-sim (dict, preset, JSON file or list). `terrain`: a Terrain, or a function that gets origins and unit directions,
    (N, 3), metres, frame D, and returns N ranges; NaN, masked, infinite or negative for a miss.
    """

    def __init__(self, config: Configs, terrain: Terrain | typing.Callable[[Array, Array], typing.Any], *, threads: int = 0) -> None:
        self._threads = _threads(threads)
        if not isinstance(terrain, Terrain) and not callable(terrain):
            raise UsageError(f"terrain is a Terrain or a function, not of type {type(terrain).__name__}")
        self._terrain = terrain
        resolved = _print_config("scan-sim", config)
        self._lidar = engine.Lidar(resolved, terrain.surface if isinstance(terrain, Terrain) else _ranges_of(terrain))
        self.pulse_rate_hz, self.pixel_count, self.pulse_limit = (
            self._lidar.pulse_rate_hz, self._lidar.pixel_count, self._lidar.pulse_limit)

    def pulse(self, k: int, position_m: typing.Any, attitude: typing.Any, estimate: Pose = None, nominal: Pose = None,
              t_s: float | None = None) -> Array:
        """The pixels of pulse `k`, a structured array: pixel, status, range_true_m, range_measured_m, true_m, estimated_m. `attitude`: the quaternion
        D <- B (w, x, y, z). `estimate` and `nominal`: (position_m, attitude) that the lander estimates, and from which an uncompensated pattern aims;
        without them the configuration's navigation error applies, and the pattern aims from the truth. `t_s`: time since pulse 0."""
        def one(pose: Pose, name: str) -> Pose:
            if pose is None:
                return None
            position, turn = _pair(pose, name)
            return _array(position, name, 1)[None], _array(turn, name, 1)[None]

        position_m, attitude = _array(position_m, "position_m", 1)[None], _array(attitude, "attitude", 1)[None]
        return self.pulses([k], position_m, attitude, one(estimate, "estimate"), one(nominal, "nominal"), None if t_s is None else [t_s])[0]

    def pulses(self, k: typing.Any, position_m: typing.Any, attitude: typing.Any, estimate: Pose = None, nominal: Pose = None,
               t_s: typing.Any = None) -> Array:
        """As pulse(), of arrays of pulses: numbers (N,), positions (N, 3), attitudes (N, 4), times (N,). An array of shape (N, pixels)."""
        numbers = _array(k, "k", 1)
        if not np.array_equal(numbers, np.round(numbers)):
            raise UsageError("k: pulses have whole numbers")
        count = numbers.size
        times = None if t_s is None else _array(t_s, "t_s", 1)
        if times is not None and times.size != count:
            raise UsageError(f"t_s: {times.size} times of {count} pulses")
        truth = _poses((position_m, attitude), "position_m and attitude", count)
        estimates = None if estimate is None else _poses(estimate, "estimate", count)
        nominals = None if nominal is None else _poses(nominal, "nominal", count)
        return self._lidar.pulses(numbers.astype(np.int64), truth, estimates, nominals, times, self._threads)


def scan(config: Configs, terrain: Terrain | Path | None, *, threads: int = 0, progress: Progress = None, **options: typing.Any) -> Scan:
    """Scans a Terrain, or a terrain.h5, with the lidar of a configuration of scan-sim: a Scan. `options` are those of the tool."""
    return Scan(_run("scan-sim", config, (), {"terrain": _terrain(terrain), **options}, threads, progress))


def grid(points: typing.Any, *others: typing.Any, weight: None = None, terrain: Terrain | Path | None = None, config: Configs = None,
         threads: int = 0, progress: Progress = None, **options: typing.Any) -> Grid:
    """The DEM of a scan, of scan.h5, or of a list of them: grid(scan, terrain, config); or of arrays x, y, z of points, metres, frame D:
    grid(x, y, z, config=...). `config` and `options` are those of regrid, as uncertainty=True. With a Terrain the DEM has its truth."""
    if weight is not None:
        raise UsageError("weight: no gridding method has weights of points besides those of their places in the bins")
    several = isinstance(points, (list, tuple)) and all(isinstance(one, (Scan, str, os.PathLike)) for one in points)
    if several or isinstance(points, (Scan, str, os.PathLike)):
        if len(others) > 2:
            raise UsageError("grid(scan, terrain, config) has too many arguments")
        terrain = others[0] if others else terrain
        config = others[1] if len(others) > 1 else config
        scans = points if several else [points]
    else:
        if len(others) != 2:
            raise UsageError("grid(x, y, z) needs three arrays, and grid(scan) a Scan or the path of a scan.h5")
        scans = [_points(points, *others)]
    inputs = [_map(one) for one in scans]
    return Grid(_run("regrid", config, inputs, {"terrain": _terrain(terrain), **options}, threads, progress))


def _points(*xyz: typing.Any) -> Scan:
    """A Scan of points without a lidar."""
    x, y, z = (_array(values, name, 1) for values, name in zip(xyz, "xyz"))
    if not x.size == y.size == z.size > 0:
        raise UsageError(f"x, y and z have {x.size}, {y.size} and {z.size} values")
    file = _new_file("points")
    engine.write_points(file.name, x, y, z)
    return Scan(file)


def evaluate(dem: Grid | Path, config: Configs = None, *, threads: int = 0, progress: Progress = None, **options: typing.Any) -> Evaluation:
    """Judges a DEM, of grid() or a dem.h5, against the requirements: an Evaluation."""
    return Evaluation(_run("dem-eval", config, [_map(dem)], options, threads, progress))


def hazards(dem: typing.Any, config: Configs = None, *, resolution_m: float | None = None, threads: int = 0, progress: Progress = None,
            **options: typing.Any) -> Hazards:
    """The hazards and landing sites of a DEM, of a Terrain, of their files, or of an array of elevations (y, x) with `resolution_m`: Hazards."""
    if not isinstance(dem, (Result, Terrain, str, os.PathLike)):
        if resolution_m is None:
            raise UsageError("resolution_m is missing: an array has no places")
        dem = Terrain.from_array(dem, resolution_m)
    elif resolution_m is not None:
        raise UsageError("resolution_m is for an array; a DEM has its own")
    options = {name: _terrain(value) if name == "terrain" else value for name, value in options.items()}
    return Hazards(_run("hazard-map", config, [_map(dem)], options, threads, progress))


class Chain:
    """The results of a chain: terrain, scan, dem, evaluation and, if the chain judges hazards, hazards."""

    def __init__(self, files: dict[str, engine.File]) -> None:
        self.terrain, self.scan, self.dem = Terrain(files["terrain"]), Scan(files["scan"]), Grid(files["dem"])
        self.evaluation = Evaluation(files["eval"])
        self.hazards = Hazards(files["hazards"]) if "hazards" in files else None


def chain(config: Configs, *, threads: int = 0, progress: Progress = None, **options: typing.Any) -> Chain:
    """Runs all stages of a configuration of `landfall run` in memory."""
    folder = "chain in memory/"
    files: dict[str, engine.File] = {}
    commands = _call("landfall run", config, (), {"print_commands": True, **options}, ["-o", folder], threads, None).splitlines()
    for words in map(shlex.split, commands):
        path = words[words.index("-o") + 1]
        files[path] = _new_file(_KINDS[words[0]])
        kept = [files[word].name if word in files else word for place, word in enumerate(words)
                if word not in (*_SIDES, "--table") and words[place - 1] not in _SIDES]
        _finish(engine.run([*kept, "-q", "-t", str(_threads(threads))], "", progress), words[0], {})
    return Chain({os.path.basename(path).removesuffix(".h5"): file for path, file in files.items()})


# Conversions


def _new_file(kind: str) -> engine.File:
    return engine.File(f"{kind} in memory {next(_numbers)}.h5")


def _name(file: engine.File | Path) -> str:
    return file.name if isinstance(file, engine.File) else os.fspath(file)


def _terrain(terrain: Terrain | Path | None) -> Path | None:
    """The file of a terrain that may be None."""
    if terrain is None or isinstance(terrain, (str, os.PathLike)):
        return terrain
    if not isinstance(terrain, Terrain):
        raise UsageError(f"terrain is a Terrain or a terrain.h5, not of type {type(terrain).__name__}")
    return _name(terrain._file)  # pylint: disable=protected-access


def _map(dem: typing.Any) -> typing.Any:
    if not isinstance(dem, (Result, Terrain, str, os.PathLike)):
        raise UsageError(f"a result of landfall or the path of a file is expected, not of type {type(dem).__name__}")
    return dem._file if isinstance(dem, (Result, Terrain)) else dem  # pylint: disable=protected-access


def _threads(threads: int) -> int:
    if not isinstance(threads, (int, np.integer)) or not 0 <= threads <= 4096:
        raise UsageError(f"threads: {threads!r} is not in [0, 4096]")
    return int(threads)


def _array(values: typing.Any, name: str, dimensions: int | None = None) -> Array:
    """Numbers as float64 in C order, copied only where they are not so; masked ones are NaN. Refused before anything is copied: too many, not real."""
    values = values if isinstance(values, np.ndarray) else np.asarray(values)
    if values.dtype.kind not in "fiu":
        raise UsageError(f"{name}: real numbers are expected, not {values.dtype}")
    if dimensions is not None and values.ndim != dimensions:
        raise UsageError(f"{name}: {dimensions} dimensions are expected, not {values.ndim}")
    if values.size > MAX_ROWS:
        raise UsageError(f"{name}: {values.size} values are more than 2^31 - 1")
    if np.ma.is_masked(values):
        values = values.astype(np.float64).filled(np.nan)
    return np.ascontiguousarray(values, np.float64).reshape(values.shape)


def _ranges_of(terrain: typing.Callable[[Array, Array], typing.Any]) -> typing.Callable[[Array, Array], Array]:
    return lambda origins, directions: _array(terrain(origins, directions), "terrain's ranges", 1)


def _resolution(value: typing.Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise UsageError(f"resolution_m: a number is expected, not {value!r}") from error


def _check_order(z: typing.Any, resolution_m: float) -> None:
    """Refuses an xarray.DataArray whose own coordinates contradict the order of rows and columns, or in metres their spacing."""
    for name, axis in zip(getattr(z, "dims", ()), "yx"):
        if name in ("x", "y") and name != axis:
            raise UsageError("z: its dimensions are (x, y); transpose it")
        if name not in getattr(z, "coords", ()) or z.coords[name].dtype.kind not in "fiu":
            continue
        steps = np.diff(np.asarray(z.coords[name].values, np.float64))
        if not np.all(steps > 0):
            raise UsageError(f"z: its coordinate {name} does not increase, and row 0 is the southernmost, column 0 the westernmost: z.sortby({name!r})")
        if z.coords[name].attrs.get("units") in ("m", "metre") and not np.allclose(steps, resolution_m, 1e-6, 0):
            raise UsageError(f"z: its coordinate {name} has steps of {steps[0]:g} m; resolution_m is {resolution_m:g}")


def _flat(values: Array) -> Array:
    return np.ascontiguousarray(values, np.float64).reshape(-1)


def _vectors(values: typing.Any, name: str, width: int = 3) -> Array:
    values = _array(values, name, 2)
    if values.shape[1] != width:
        raise UsageError(f"{name}: shape (N, {width}) is expected, not {values.shape}")
    return values


def _pair(pose: typing.Any, name: str) -> tuple[typing.Any, typing.Any]:
    try:
        position_m, attitude = pose
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name}: a pair of position and attitude is expected") from error
    return position_m, attitude


def _poses(pose: typing.Any, name: str, count: int) -> Array:
    position_m, attitude = _pair(pose, name)
    position_m, attitude = _vectors(position_m, name), _vectors(attitude, name, 4)
    if not len(position_m) == len(attitude) == count:
        raise UsageError(f"{name}: {len(position_m)} positions and {len(attitude)} attitudes of {count} pulses")
    return np.concatenate((position_m, attitude), axis=1)


# Runs


def _run(tool: str, config: Configs, inputs: typing.Sequence[typing.Any], options: dict[str, typing.Any], threads: int,
         progress: Progress) -> engine.File:
    """Runs a tool, and returns its output in memory."""
    file = _new_file(_KINDS[tool])
    _call(tool, config, inputs, options, ["-o", file.name], threads, progress)
    return file


def _print_config(tool: str, config: Configs) -> str:
    return _call(tool, config, (), {"print_config": True}, [], 0, None)


def _call(tool: str, config: Configs, inputs: typing.Sequence[typing.Any], options: dict[str, typing.Any], outputs: list[str], threads: int,
          progress: Progress) -> str:
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="landfall-configs-")) if _is_several(config) else ""
        arguments, standard_input, names = tools.config_words(config, folder)
        words = [tool, *map(_name, inputs), *arguments]
        for name, value in options.items():
            words += tools.option_words("--" + name.replace("_", "-"), value)
        done = engine.run([*words, *outputs, "-q", "-t", str(_threads(threads))], standard_input, progress)
    return _finish(done, tool, names)


def _finish(done: tuple[int, str, list[str], str], tool: str, names: dict[str, str]) -> str:
    code, message, warnings, printed = done
    for warning in warnings:
        print(printable(f"{tool}: warning: {warning}"), file=sys.stderr)
    if code in (0, 3):
        return printed
    for name, where in names.items():
        message = message.replace(name, where)
    raise (UsageError if code == 2 else DataError)(message)


def _is_several(config: Configs) -> bool:
    return isinstance(config, (list, tuple)) and sum(isinstance(one, dict) for one in config) > 1

