"""The replay as an object to show: self-contained HTML around the player, and plain text.

The page sits in a sandboxed `<iframe srcdoc>` that may run scripts and nothing else; it holds the
player (`backhoe/view/player/player.js`) and the recording, both compressed, and asks no network.
"""

from __future__ import annotations

import gzip
from base64 import b64encode
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path

import numpy as np

from backhoe.basics.inputs import number
from backhoe.view.replay.recording import Recording
from backhoe.view.replay.recording_file import encode

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width,initial-scale=1">
<style>html,body{{margin:0;height:100%}}</style></head>
<body data-poster="{poster}" data-alt="{alt}"><noscript>{title}. {alt}</noscript>
<script type="text/plain" id="recording">{recording}</script>
<script type="text/plain" id="player">{player}</script>
<script>{start}</script></body></html>"""

_START = """(async()=>{try{
const read=id=>new Response(new Blob([Uint8Array.from(
atob(document.getElementById(id).textContent),c=>c.charCodeAt(0))]).stream()
.pipeThrough(new DecompressionStream("gzip")));
const script=document.createElement("script");
script.textContent=await read("player").text();
document.head.append(script);
backhoePlayer.start(document.body,await read("recording").arrayBuffer());
}catch(error){document.body.append("The 3D replay needs a browser with WebGL 2 and "+
"DecompressionStream (2023 or later). "+document.body.dataset.alt);console.error(error)}})()"""


class Replay:
    """A recording with its title and text alternative; a notebook shows it as the 3D player.

    Args:
        recording: what happened.
        title: a few words.
        alt: what happens, in a sentence or two, for those who do not see it.
        poster: time of the frame shown before playing [s]; the first one if None.

    Raises:
        ValueError: title or alt are empty, or the poster's time is not within the recording.
    """

    def __init__(
        self, recording: Recording, *, title: str, alt: str, poster: float | None = None
    ) -> None:
        if not title.strip() or not alt.strip():
            raise ValueError("a replay needs a title and an alt text that says what happens in it")
        times = np.asarray(recording.times, dtype=float)
        poster = times[0] if poster is None else poster
        poster = number(poster, "poster", "s", least=times[0], most=times[-1])
        self.recording, self.title, self.alt = recording, title.strip(), alt.strip()
        self._poster = int(np.argmin(np.abs(times - poster)))
        self._data = encode(recording)

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return self.recording.frames

    @property
    def duration(self) -> float:
        """Time from the first to the last frame [s]."""
        return self.recording.duration

    @property
    def size(self) -> int:
        """Bytes that the recording takes in the page, without the player [B]."""
        return len(b64encode(self._data))

    def to_bytes(self) -> bytes:
        """The encoded recording, as `recording_file.decode` reads it."""
        return self._data

    def page(self) -> str:
        """A whole HTML page with the player and this recording."""
        return _PAGE.format(
            title=escape(self.title),
            alt=escape(self.alt),
            poster=self._poster,
            recording=b64encode(self._data).decode(),
            player=_player(),
            start=_START,
        )

    def save_html(self, path: str | Path) -> Path:
        """Write `page()` to a file that any browser opens, and return its path."""
        path = Path(path)
        path.write_text(self.page(), encoding="utf-8")
        return path

    def __repr__(self) -> str:
        rate = round((self.frame_count - 1) / self.duration) if self.duration > 0 else 0
        return f"Replay: {self.title}, {self.duration:.1f} s at {rate} frames/s. {self.alt}"

    def _repr_html_(self) -> str:
        style = "display:block;width:100%;height:clamp(420px,58vw,560px);border:0;border-radius:8px"
        return (
            f'<figure class="backhoe-replay" style="margin:0">'
            f'<iframe title="{escape(self.title)}: 3D replay. {escape(self.alt)}" '
            f'sandbox="allow-scripts" allow="fullscreen" loading="lazy" style="{style}" '
            f'srcdoc="{escape(self.page())}"></iframe>'
            f"<figcaption>{escape(repr(self))}</figcaption></figure>"
        )


@cache
def _player() -> str:
    source = files("backhoe") / "view" / "player" / "player.js"
    return b64encode(gzip.compress(source.read_bytes(), compresslevel=9, mtime=0)).decode()
