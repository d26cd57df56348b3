"""Sliders that redraw a figure, with a picture that stands for them where nothing can move."""

from collections.abc import Callable, Mapping
from typing import Any

from matplotlib.figure import Figure

from backhoe.view.plots.style import QUICK, bundle


def sliders(
    draw: Callable[..., Figure],
    ranges: Mapping[str, tuple[float, float, float]],
    alt: str,
    step: float = 1.0,
    unit: str = "deg",
) -> None:
    """Show `draw(**values)` with one slider for each argument; moving one redraws the figure.

    The first picture is stored in the notebook like that of `show`, so a page on paper or on the
    web still has it. Without ipywidgets only that picture appears.

    Args:
        draw: makes the figure from one number per name in `ranges`.
        ranges: argument of `draw` -> (lowest, highest, first value).
        alt: says what the first picture shows.
        step, unit: of every slider.

    Raises:
        ValueError: a first value lies outside its range, or `alt` is empty.
    """
    for name, (lowest, highest, first) in ranges.items():
        if not lowest <= first <= highest:
            raise ValueError(f"{name} starts at {first}, outside its range {lowest} to {highest}")
    data, metadata = bundle(draw(**{name: first for name, (_, _, first) in ranges.items()}), alt)

    from IPython import get_ipython
    from IPython.display import display

    if get_ipython() is None:
        print(data["text/plain"])
        return
    picture = display(data, metadata=metadata, raw=True, display_id=True)
    try:
        import ipywidgets
    except ImportError:
        return
    knobs = {
        name: ipywidgets.FloatSlider(
            value=first,
            min=lowest,
            max=highest,
            step=step,
            description=f"{name} [{unit}]",
            readout_format=".0f" if step >= 1 else ".2f",
            style={"description_width": "initial"},
            layout=ipywidgets.Layout(width="95%", max_width="32em"),
        )
        for name, (lowest, highest, first) in ranges.items()
    }

    def redraw(_: Any) -> None:
        values = {name: knob.value for name, knob in knobs.items()}
        text = "the figure at " + ", ".join(f"{n} = {v:g} {unit}" for n, v in values.items())
        moved, about = bundle(draw(**values), text, QUICK)
        picture.update(moved, metadata=about, raw=True)

    for knob in knobs.values():
        knob.observe(redraw, names="value")
    view = ipywidgets.VBox(list(knobs.values()))._repr_mimebundle_()
    view["text/plain"] = f"[run this cell in JupyterLab to move {', '.join(ranges)}]"
    display(view, raw=True)
