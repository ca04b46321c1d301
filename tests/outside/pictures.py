"""Judges pictures: an SVG looks the same in cairosvg, and in Chromium where that is installed, as in envgen's
own PNG."""

import io
import shutil
import subprocess
import tempfile
from xml.etree import ElementTree

import cairosvg
import numpy as np
from PIL import Image, ImageChops

# Pixels of the squares over which both are averaged: renderers draw edges and hair
# lines within a pixel in their own ways.
SQUARE = 4
# Greys, of 255, by which squares may differ in the mean.
MEAN = 2
# Share of the squares that may differ clearly, by more than CLEAR greys, wherever a renderer rounds the
# edges of cells to: up to a pixel away.
SHARE, CLEAR = 0.005, 24


CHROMIUM = shutil.which("chromium")

# Chromium takes some of a low window for itself.
BELOW = 200


def judge(world, report):
    """Compares the pictures of a world."""
    size = ElementTree.parse(world.path("svg")).getroot().attrib
    size = round(float(size["width"])), round(float(size["height"]))
    ours = picture(world.path("png").read_bytes())
    compare("cairosvg", ours, cairosvg.svg2png(url=str(world.path("svg"))), size, report)
    if CHROMIUM:
        compare("Chromium", ours, in_chromium(world.path("svg"), size), size, report)


def compare(renderer, ours, theirs, size, report):
    """Compares a renderer's picture with envgen's own."""
    theirs = picture(theirs)
    if not ours.size == theirs.size == size:
        report.complain(f"pictures of {ours.size} and {theirs.size} px, not {size}")
        return
    moves = [(x, y) for x in (0, -1, 1) for y in (0, -1, 1)]
    moved = (ImageChops.offset(theirs, *move) for move in moves)
    differences = [np.abs(squares(ours) - squares(other)).max(axis=2) for other in moved]
    mean, share = differences[0].mean(), (np.minimum.reduce(differences) > CLEAR).mean()
    if mean > MEAN or share > SHARE:
        report.complain(
            f"pictures differ in {renderer} by {mean:.2f} greys, {100 * share:.2f} % clearly"
        )
    report.count(f"pictures in {renderer} and resvg")


def in_chromium(svg, size):
    """A picture of a window of that size."""
    width, height = size
    with tempfile.TemporaryDirectory() as folder:
        drawn = f"{folder}/drawn.png"
        command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
        command += [f"--user-data-dir={folder}/profile", f"--screenshot={drawn}"]
        command += [f"--window-size={width},{height + BELOW}", svg.resolve().as_uri()]
        subprocess.run(command, check=True, capture_output=True, timeout=120)
        cut = io.BytesIO()
        Image.open(drawn).crop((0, 0, width, height)).save(cut, "png")
        return cut.getvalue()


def picture(png):
    """A picture on a white page."""
    drawn = Image.open(io.BytesIO(png)).convert("RGBA")
    page = Image.new("RGBA", drawn.size, "white")
    return Image.alpha_composite(page, drawn).convert("RGB")


def squares(drawn):
    """Mean colours of squares, as numbers whose differences can be negative."""
    return np.asarray(drawn.reduce(SQUARE), int)
