"""Figures of tolerance studies: a tornado of the fields for each outcome, and the outcomes of random samples."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fastpin.errors import InputError
from fastpin.figures.sheet import WIDE, Look, Plot, Sheet, plotter
from fastpin.figures.style import COLOURS, shown_label, shown_unit
from fastpin.figures.sweep import round_numbers
from fastpin.model.checks import instances
from fastpin.report.tolerances import MOST_OUTCOMES, ToleranceChart

LOW: Any = {"facecolor": COLOURS[4], "edgecolor": "black", "linewidth": 0.5}
HIGH: Any = {"facecolor": COLOURS[1], "edgecolor": "black", "linewidth": 0.5, "hatch": "////"}
"""Bars of the lower and of the upper limit. The hatch tells them apart in grey."""

INNER: Any = {"color": "black", "linestyle": "none", "marker": "o", "markersize": 2.5}

ACROSS = 4
"""Most panels of samples side by side."""

MOST_PANELS = 24
"""Most panels of samples. Of more fields the strongest ones are drawn."""


def _charts_of(charts: ToleranceChart | Sequence[ToleranceChart]) -> Sequence[ToleranceChart]:
    """One chart or several as a sequence."""
    given = [charts] if isinstance(charts, ToleranceChart) else charts
    each = instances("charts", given, ToleranceChart, "a ToleranceChart, or a list of them")
    if not 1 <= len(each) <= MOST_OUTCOMES:
        raise InputError("charts", f"must be 1 to {MOST_OUTCOMES} charts, not {len(each)}")
    return each


def tornado_of(charts: Sequence[ToleranceChart]) -> Plot:
    """Draw a tornado for each outcome: a bar for each field, from the outcome at one limit to that at the other.

    The fields stand in the order of their swings. Dots are values between the limits. Lines below the bars are the
    range of all corners, and that of the samples from the lowest to the highest percentile. A limit without a
    value says so.

    Parameters
    ----------
    charts : ToleranceChart, or sequence of them
        From :func:`fastpin.report.tolerances.tolerance_chart`.
    """
    names = ", ".join(chart.label for chart in charts)
    largest = charts[0].bars[0]
    lost = "".join(f" {chart.label}: {chart.missing:,} runs have no value." for chart in charts if chart.missing)
    return Plot(
        lambda look: _draw_tornado(look, charts),
        instead=f"Bars of {names} at the limits of each field.",
        caption=f"{names[0].upper()}{names[1:]} at the limits of each field alone. The largest swing of "
        f"{charts[0].label} comes from: {largest.words}.{lost}",
        title=charts[0].title,
    )


plot_tornado = plotter("plot_tornado", tornado_of, _charts_of)


def samples_of(charts: Sequence[ToleranceChart]) -> Plot:
    """Draw the outcomes of all samples over each field, with the rank correlations.

    The fields stand in the order of their correlations. See :func:`plot_tornado` for the `charts`.

    Raises
    ------
    InputError
        If the study has no samples.
    """
    if not len(charts[0].samples):
        raise InputError("charts", "the study has no samples: give samples = 200 in the plan")
    names = ", ".join(chart.label for chart in charts)
    return Plot(
        lambda look: _draw_samples(look, charts),
        instead=f"Dots of {names} at {len(charts[0].samples):,} samples over each field.",
        caption=f"{names[0].upper()}{names[1:]} at {len(charts[0].samples):,} random samples between the limits.",
        title=charts[0].title,
        width=WIDE,
    )


plot_samples = plotter("plot_samples", samples_of, _charts_of)


def _draw_tornado(look: Look, charts: Sequence[ToleranceChart]) -> Sheet:
    rows = [len(chart.bars) + (chart.corners is not None) + bool(chart.percentiles) for chart in charts]
    # A row of a tornado holds a line of letters.
    sheet = look.sheet([0.27 * count + 0.35 for count in rows], extra=0.75 + 0.25 * len(charts))
    sheet.grid("x")
    for panel, chart in zip(sheet.axes[:, 0], charts, strict=True):
        _draw_bars(panel, chart)
    sheet.head(look.title)
    handles: list[Any] = [Patch(label="at the lower limit", **LOW), Patch(label="at the upper limit", **HIGH)]
    if any(_inner(chart, bar.values).size for chart in charts for bar in chart.bars):
        handles.append(Line2D([], [], label="between the limits", **INNER))
    sheet.legend(handles, 3)
    return sheet


def _inner(chart: ToleranceChart, values: np.ndarray) -> np.ndarray:
    """Return the values between the limits, without the nominal one."""
    between = values[1:-1]
    return between[np.isfinite(between) & (between != chart.nominal)]


def _draw_bars(panel: Axes, chart: ToleranceChart) -> None:
    """Draw the bars of one outcome, and below them the ranges of the corners and of the samples."""
    names = [bar.words for bar in chart.bars]
    for row, bar in enumerate(chart.bars):
        low, high = (float(bar.values[k]) for k in (0, -1))
        covering = (low - chart.nominal) * (high - chart.nominal) > 0.0  # both limits lie on one side of the nominal
        for place, (end, style) in enumerate(((low, LOW), (high, HIGH))):
            height, shift = (0.36, 0.18 - 0.36 * (place == 0)) if covering else (0.72, 0.0)
            if math.isfinite(end) and math.isfinite(chart.nominal):
                panel.barh(row + shift, end - chart.nominal, height, chart.nominal, zorder=2, **style)
        inner = _inner(chart, bar.values)
        panel.plot(inner, np.full(len(inner), row), zorder=4, **INNER)
        _write_limits(panel, chart.nominal, row, bar.limits, (low, high))
    if chart.corners is not None:
        panel.plot(chart.corners, [len(names)] * 2, color="0.35", linewidth=1.2, marker="|", markersize=7.0)
        names.append("all corners")
    if chart.percentiles:
        ends = min(chart.percentiles), max(chart.percentiles)
        span = [chart.percentiles[each] for each in ends]
        panel.plot(span, [len(names)] * 2, color="0.35", linewidth=3.0, solid_capstyle="butt")
        names.append(f"samples, {ends[0]} % to {ends[1]} %")
    panel.set_yticks(range(len(names)), names, parse_math=False)
    panel.tick_params(axis="y", length=0)
    panel.set_ylim(len(names) - 0.4, -0.6)
    if math.isfinite(chart.nominal):
        panel.axvline(chart.nominal, color="black", linewidth=0.9, zorder=3)
    panel.margins(x=0.16)
    if _is_wide(chart):
        panel.set_xscale("log")
    else:
        panel.xaxis.set_major_locator(MaxNLocator(7))
    panel.set_xlabel(shown_label(chart.label), parse_math=False)


def _is_wide(chart: ToleranceChart) -> bool:
    """Whether the outcome is positive everywhere and spans more than a decade, as lives do."""
    drawn = [value for bar in chart.bars for value in bar.values] + [chart.nominal]
    drawn += [*(chart.corners or ()), *chart.percentiles.values()]
    known = np.array([value for value in drawn if math.isfinite(value)])
    return bool(known.size and known.min() > 0.0 and known.max() > 10.0 * known.min())


def _write_limits(panel: Axes, nominal: float, row: int, limits: tuple[str, str], ends: tuple[float, float]) -> None:
    """Write the limits beside the ends of a bar: the one with the smaller outcome on the left."""
    texts = [limits[place] for place in (0, 1)]
    known = [end if math.isfinite(end) else nominal for end in ends]
    if not all(map(math.isfinite, known)):
        return
    left, right = (0, 1) if known[0] <= known[1] else (1, 0)
    low, high = min(known[left], nominal), max(known[right], nominal)
    for place, x, side, shift in ((left, low, "right", -3.0), (right, high, "left", 3.0)):
        number, _, label = texts[place].partition(" ")
        words = f"{number} {shown_unit(label)}".strip().replace("-", "−")
        words += "" if math.isfinite(ends[place]) else ": no value"
        panel.annotate(
            words, (x, row), (shift, 0.0), textcoords="offset points", ha=side, va="center", fontsize=7.0,
            parse_math=False,
        )  # fmt: skip


def _draw_samples(look: Look, charts: Sequence[ToleranceChart]) -> Sheet:
    columns = min(len(charts[0].clouds), ACROSS)
    fields = min(len(charts[0].clouds), MOST_PANELS // (len(charts) * columns) * columns)
    rows = -(-fields // columns)
    sheet = look.sheet([1.75] * (rows * len(charts)), columns, 0.5)
    sheet.grid()
    for block, chart in enumerate(charts):
        panels = sheet.axes[block * rows : (block + 1) * rows].ravel()
        for place, panel in enumerate(panels):
            panel.set_visible(place < fields)
        for place, (panel, cloud) in enumerate(zip(panels, chart.clouds[:fields], strict=False)):
            is_strong = abs(cloud.correlation) * math.sqrt(len(chart.samples)) > 2.0  # more than chance
            panel.plot(cloud.values, chart.samples, ".", markersize=2.8, color=COLOURS[0] if is_strong else "0.55")
            panel.axhline(chart.nominal, color="black", linewidth=0.7)
            if cloud.is_log:
                panel.set_xscale("log")
                round_numbers(panel.xaxis, cloud.values)
            else:
                panel.xaxis.set_major_locator(MaxNLocator(4))
            panel.set_xlabel(shown_label(cloud.label), fontsize=7.5, parse_math=False)
            if place % columns == 0:
                panel.set_ylabel(shown_label(chart.label), fontsize=7.5, parse_math=False)
            else:
                panel.tick_params(labelleft=False)
            panel.tick_params(labelsize=7.0)
            if math.isfinite(cloud.correlation):
                words = f"rank correlation {cloud.correlation:+.2f}".replace("-", "−")
                panel.set_title(words, fontsize=7.5)
    count = len(charts[0].clouds)
    sheet.head(look.title, f"the {fields} of {count} fields with the largest correlations" if fields < count else "")
    return sheet
