# SPDX-License-Identifier: GPL-3.0-or-later
"""Common parts of the plot commands: options, numbers as text, and writing figures."""
import argparse
import contextlib
import math
import os

from landfall import command, tools
from landfall.errors import DataError, UsageError, printable


def add_output_options(parser):
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace existing files")
    parser.add_argument("--dpi", type=dots_per_inch, default=150, help="50..600, default 150")


def add_data_only_option(parser):
    parser.add_argument("--data-only", action="store_true",
                        help="scales of errors end where the data does, even if their limits lie outside")


def parse_figure_of_tools(arguments, prog, description):
    """The options of a figure that is drawn from runs of the tools: -o, --bin, --dpi, -O."""
    parser = command.Parser(prog=prog, description=description)
    parser.add_argument("-o", "--output", metavar="PNG", required=True)
    parser.add_argument("--bin", metavar="DIR", help="where the tools are (default: beside this package, or on PATH)")
    add_output_options(parser)
    options = parser.parse_args(arguments)
    require_png(options.output)
    if options.bin:
        tools.BIN = options.bin
    return options


def require_png(path):
    if not path.endswith(".png"):
        raise UsageError(f"--output {path}: the name must end in .png")


def name_output(options, source, ending="-figure.png"):
    """The PNG of --output; without it one beside the input that is called after it."""
    options.output = options.output or os.path.splitext(source)[0] + ending
    require_png(options.output)


def dots_per_inch(text):
    value = int(text)
    if not 50 <= value <= 600:
        raise argparse.ArgumentTypeError(f"{value} is not in [50, 600]")
    return value


def positive_metres(text):
    value = float(text)
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{text} is not a positive length")
    return value


def place(text):
    """(x, y) of X,Y in metres."""
    with contextlib.suppress(ValueError):
        x, y = (float(part) for part in text.split(","))
        if math.isfinite(x) and math.isfinite(y):
            return x, y
    raise argparse.ArgumentTypeError(f"'{text}' is not X,Y in metres")


# Text


def metres(value):
    """A length with a unit that suits it: 1.2 mm, 8.3 cm, 1.38 m; a dash where it is not known."""
    if value is None:
        return "–"
    if 0 < abs(value) < 1e-6:
        return "< 1 µm"
    unit, factor = length_unit(value)
    return f"{value * factor:.3g} {unit}"


def length_unit(value_m):
    """(name, factor) of the unit in which a length is neither very small nor very large."""
    return ("m", 1.0) if abs(value_m) >= 0.5 else ("cm", 100.0) if abs(value_m) >= 0.01 else ("mm", 1000.0)


def metre_range(low_m, high_m):
    """Two lengths in one unit: -14.5 to 13.4 cm."""
    unit, factor = length_unit(max(abs(low_m), abs(high_m)))
    low, high = (0.0 if abs(value) < 1e-6 else value * factor for value in (low_m, high_m))
    return f"{low:.3g} to {high:.3g} {unit}"


def number(value):
    """A count or a fractional number; a dash where it is not known."""
    return "–" if value is None else f"{value:,.4g}" if isinstance(value, float) else f"{value:,}"


def counted(value, noun):
    return f"{number(value)} {noun}" + ("" if value == 1 else "s")


def bins(value):
    return counted(value, "bin")


def percent(fraction):
    return "–" if fraction is None else f"{100 * fraction:.3g} %"


# Output


def save(figures, dpi):
    """Writes {path: figure} and prints the paths.

    All are written under temporary names first, so that a failure leaves no incomplete figure.
    """
    temporary = {path: f"{path}.{os.getpid()}.tmp" for path in figures}
    try:
        for path, figure in figures.items():
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
            figure.savefig(temporary[path], format="png", dpi=dpi, metadata={"Software": None})
            command.sync(temporary[path])
        for path in figures:
            os.replace(temporary[path], path)
            print(printable(path))
    except OSError as error:
        raise DataError(f"cannot write {error.filename or ''}: {error.strerror or error}") from error
    finally:
        for name in temporary.values():
            with contextlib.suppress(FileNotFoundError):
                os.remove(name)
