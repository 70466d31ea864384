# SPDX-License-Identifier: GPL-3.0-or-later
"""Common parts of the plot commands: options and writing figures."""
import argparse
import contextlib
import json
import math
import os
import tempfile

import matplotlib.pyplot as plt
from matplotlib.backends.backend_agg import FigureCanvasAgg

from landfall import command, files, tools
from landfall.errors import DataError, UsageError, printable


def add_output_options(parser):
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace existing files")
    parser.add_argument("--dpi", type=dots_per_inch, default=150, help="50..600, default 150")


def add_data_only_option(parser):
    parser.add_argument("--data-only", action="store_true",
                        help="scales of errors end where the data does, even if their limits are near")


def require_png(path, ending=".png"):
    if not path.endswith(ending):
        raise UsageError(f"--output {path}: the name must end in {ending}")


def parser_of(description, sources, add_options=None, ending="-figure.png"):
    """The function parse(arguments) of a command that draws files: `sources` are its arguments, {name: the file in the help text};
    add_options(parser) adds its other options. Without --output the PNG is next to the last of the files and named after it."""
    def parse(arguments):
        parser = command.Parser(description=description)
        for name, file in sources.items():
            parser.add_argument(name, metavar=f"{file}.h5")
        parser.add_argument("-o", "--output", metavar="PNG", help=f"output file (default: {file}{ending} next to it)")
        if add_options:
            add_options(parser)
        add_output_options(parser)
        options = parser.parse_args(arguments)
        options.sources = [getattr(options, name) for name in sources]
        options.output = options.output or os.path.splitext(getattr(options, name))[0] + ending
        require_png(options.output)
        return options

    return parse


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


# Commands


def use_dpi(dpi):
    """The resolution of the figures to come: a map has no more blocks than pixels, because blocks that are skipped would hide defects."""
    plt.rcParams["figure.dpi"] = dpi


def main_of(parse, figure_of):
    """The function main(arguments) of a command that writes one figure, figure_of(options)."""
    def main(arguments):
        options = parse(arguments)
        use_dpi(options.dpi)
        command.check_outputs([options.output], options.overwrite)
        with files.drawing(getattr(options, "sources", [])):
            save({options.output: figure_of(options)}, options.dpi)

    return main


def main_of_tools(description, figure_of, animation_of=None):
    """The function main(arguments) of a command that writes one figure of runs of the tools, figure_of(an empty folder, options), or with --animate
    the text of an SVG, animation_of(folder, options)."""
    def parse(arguments):
        parser = command.Parser(description=description)
        parser.add_argument("-o", "--output", metavar="PNG|SVG" if animation_of else "PNG", required=True)
        if animation_of:
            parser.add_argument("--animate", action="store_true", help="an SVG that shows them at work")
        parser.add_argument("--bin", metavar="DIR", help="where the tools are (default: next to this package, or on PATH)")
        add_output_options(parser)
        options = parser.parse_args(arguments)
        require_png(options.output, ".svg" if animation_of and options.animate else ".png")
        tools.BIN = options.bin or tools.BIN
        return options

    def in_folder(options):
        with tempfile.TemporaryDirectory(prefix="landfall-figure-") as folder:
            return (animation_of if animation_of and options.animate else figure_of)(folder, options)

    return main_of(parse, in_folder)


def run_tool(tool, folder, name, config, options, *arguments):
    """Runs a tool of options.bin. Returns the path of its output, NAME.h5 in the folder, which it replaces."""
    path, config_path = (os.path.join(folder, name + ending) for ending in (".h5", ".json"))
    with open(config_path, "w", encoding="utf-8") as file:
        json.dump(config, file)
    tools.run_tool(tools.find(tool, options.bin), "-c", config_path, *arguments, "-o", path, "-O")
    return path


# Output


def save(figures, dpi):
    """Writes {path: figure, or the text of an SVG} and prints the paths.

    All are written under temporary names first, so that a failure leaves no incomplete figure.
    """
    temporary = {path: f"{path}.{os.getpid()}.tmp" for path in figures}
    try:
        for path, figure in figures.items():
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
            if isinstance(figure, str):
                with open(temporary[path], "w", encoding="utf-8") as file:
                    file.write(figure)
            else:
                # Figure.savefig would draw twice: once for the layout alone, which the drawing does as well.
                figure.set_dpi(dpi)
                FigureCanvasAgg(figure).print_png(temporary[path], metadata={"Software": None})
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
